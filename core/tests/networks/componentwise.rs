//! The layer loops of a controller, which take one component after another, run on this machine in f32. They equal
//! the side-by-side loops bit for bit.

use crate::common::Random;
use crate::common::shapes::{self, Model};
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::network::{Activation, Dense, Jet, Mlp, Tape};
use leastaction_core::scalar::{Scalar, WeightFormat, f16};
use proptest::prelude::*;

/// f32 as a controller evaluates it: the same operations, with layers evaluated component by component.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Controller(f32);

macro_rules! forward {
    ($trait:ident, $method:ident, $assign:ident, $by:ident) => {
        forward!($trait, $method);
        impl $assign for Controller {
            fn $by(&mut self, other: Self) {
                *self = $trait::$method(*self, other);
            }
        }
    };
    ($trait:ident, $method:ident) => {
        impl $trait for Controller {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                Self($trait::$method(self.0, other.0))
            }
        }
    };
}
forward!(Add, add, AddAssign, add_assign);
forward!(Sub, sub, SubAssign, sub_assign);
forward!(Mul, mul);
forward!(Div, div);

impl Neg for Controller {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

fn plain(x: &[Controller]) -> Vec<f32> {
    x.iter().map(|x| x.0).collect()
}

impl Scalar for Controller {
    type Weight = f32;
    const COMPONENTWISE: bool = true;

    fn accumulate<W: WeightFormat<Wide = f32>, const P: usize>(
        rows: &[[W; P]],
        x: &[Self],
        sum: &mut [Self; P],
    ) {
        let mut sums = sum.map(|x| x.0);
        f32::accumulate(rows, &plain(x), &mut sums);
        *sum = sums.map(Self);
    }
    fn transposed<W: WeightFormat<Wide = f32>, const P: usize>(
        rows: &[[W; P]],
        y_bar: &[Self; P],
        x_bar: &mut [Self],
    ) {
        let mut sums = plain(x_bar);
        f32::transposed(rows, &y_bar.map(|y| y.0), &mut sums);
        x_bar.iter_mut().zip(sums).for_each(|(x, sum)| *x = Self(sum));
    }
    fn weight(w: f32) -> Self {
        Self(w)
    }
    fn constant(x: f64) -> Self {
        Self(Scalar::constant(x))
    }
    fn sqrt(self) -> Self {
        Self(Scalar::sqrt(self.0))
    }
    fn exp(self) -> Self {
        Self(Scalar::exp(self.0))
    }
    fn ln_1p(self) -> Self {
        Self(Scalar::ln_1p(self.0))
    }
    fn tanh(self) -> Self {
        Self(Scalar::tanh(self.0))
    }
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = Scalar::sin_cos(self.0);
        (Self(sin), Self(cos))
    }
    fn wrapped(self) -> Self {
        Self(Scalar::wrapped(self.0))
    }
    fn max(self, other: Self) -> Self {
        Self(Scalar::max(self.0, other.0))
    }
    fn neg_abs(self) -> Self {
        Self(Scalar::neg_abs(self.0))
    }
}

fn on_controller<const T: usize>(jets: &[Jet<f32, T>]) -> Vec<Jet<Controller, T>> {
    jets.iter().map(|x| Jet { value: Controller(x.value), tangent: x.tangent.map(Controller) }).collect()
}

/// The bits of a number, with all NaN mapped to the same bits.
trait Bits {
    fn bits(&self) -> u32;
}

impl Bits for f32 {
    fn bits(&self) -> u32 {
        if self.is_nan() { u32::MAX } else { self.to_bits() }
    }
}

impl Bits for Controller {
    fn bits(&self) -> u32 {
        self.0.bits()
    }
}

fn bits<S: Bits, const T: usize>(jets: &[Jet<S, T>]) -> Vec<Vec<u32>> {
    jets.iter().map(|x| [&x.value].into_iter().chain(&x.tangent).map(Bits::bits).collect()).collect()
}

fn jets<const T: usize>(random: &mut Random, count: usize) -> Vec<Jet<f32, T>> {
    let mut draw = || random.symmetric(2.0) as f32;
    (0..count).map(|_| Jet { value: draw(), tangent: core::array::from_fn(|_| draw()) }).collect()
}

fn weights<W>(random: &mut Random, count: usize, stored: fn(f32) -> W) -> Vec<W> {
    (0..count).map(|_| stored(random.symmetric(1.5) as f32)).collect()
}

/// Passes a layer with T tangents, forward and back, in both ways.
fn layer<W: WeightFormat<Wide = f32>, const T: usize>(inputs: usize, outputs: usize, stored: fn(f32) -> W) {
    let random = &mut Random((inputs * 1_000 + outputs) as u64);
    let weights = weights(random, Dense::<W>::parameters(inputs, outputs).unwrap(), stored);
    let dense = Dense::take(&mut &weights[..], inputs, outputs).unwrap();
    let (x, y_bar) = (jets::<T>(random, inputs), jets::<T>(random, outputs));
    let (mut y, mut x_bar) = (vec![Jet::zero(); outputs], vec![Jet::zero(); inputs]);
    dense.forward(&x, &mut y);
    dense.adjoint(&y_bar, &mut x_bar);
    // Earlier contents must not matter to the loops.
    let (mut found_y, mut found_x_bar) =
        (on_controller(&jets::<T>(random, outputs)), on_controller(&jets::<T>(random, inputs)));
    dense.forward(&on_controller(&x), &mut found_y);
    dense.adjoint(&on_controller(&y_bar), &mut found_x_bar);
    assert_eq!(bits(&found_y), bits(&y), "{inputs} → {outputs}, {T} tangents, forward");
    assert_eq!(bits(&found_x_bar), bits(&x_bar), "{inputs} → {outputs}, {T} tangents, adjoint");
}

fn layer_of_any_tangents<W: WeightFormat<Wide = f32>>(inputs: usize, outputs: usize, stored: fn(f32) -> W) {
    layer::<W, 0>(inputs, outputs, stored);
    layer::<W, 1>(inputs, outputs, stored);
    layer::<W, 2>(inputs, outputs, stored);
    layer::<W, 3>(inputs, outputs, stored);
    layer::<W, 4>(inputs, outputs, stored);
}

/// Every width up to beyond a panel of eight, one of four and single outputs, and widths around the number gathered
/// at a time (32).
#[test]
fn layers_of_every_small_shape() {
    for inputs in (1..=17).chain([31, 32, 33]) {
        for outputs in (1..=17).chain([31, 32, 33]) {
            layer_of_any_tangents(inputs, outputs, |w| w);
        }
    }
}

/// Maximum number of units of a hidden layer.
const WIDTH: usize = 47;

/// A network of two hidden layers with T tangents: values, and the adjoint of its inputs.
fn network<const T: usize>(sizes: [usize; 4], activation: Activation) {
    let [inputs, first, second, outputs] = sizes;
    let random = &mut Random(sizes.iter().sum::<usize>() as u64);
    let weights =
        weights(random, Mlp::<f32, WIDTH, 2>::parameters(inputs, &[first, second], outputs).unwrap(), |w| w);
    let mlp =
        Mlp::<_, WIDTH, 2>::take(&mut &weights[..], inputs, &[first, second], outputs, activation).unwrap();
    let (x, y_bar) = (jets::<T>(random, inputs), jets::<T>(random, outputs));
    fn run<S: Scalar<Weight = f32> + Bits, const T: usize>(
        mlp: &Mlp<'_, f32, WIDTH, 2>,
        x: &[Jet<S, T>],
        y_bar: &[Jet<S, T>],
    ) -> [Vec<Vec<u32>>; 2] {
        let mut tape = Tape::<S, T, WIDTH, 2>::default();
        let (mut y, mut x_bar) = (vec![Jet::zero(); y_bar.len()], vec![Jet::zero(); x.len()]);
        mlp.forward(x, &mut tape, &mut y);
        mlp.adjoint(&tape, y_bar, &mut x_bar);
        [bits(&y), bits(&x_bar)]
    }
    let expected = run(&mlp, &x, &y_bar);
    assert_eq!(run(&mlp, &on_controller(&x), &on_controller(&y_bar)), expected, "{sizes:?}, {activation:?}");
}

fn activations() -> impl Strategy<Value = Activation> {
    prop::sample::select(vec![
        Activation::Tanh,
        Activation::Softplus,
        Activation::Squareplus,
        Activation::Isru,
        Activation::Identity,
    ])
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn layers_of_any_shape(inputs in 1_usize..150, outputs in 1_usize..150) {
        layer_of_any_tangents(inputs, outputs, |w| w);
        layer_of_any_tangents(inputs, outputs, f16::from_f32);
    }

    #[test]
    fn networks_of_any_shape(
        (inputs, first, second, outputs) in (1_usize..9, 1_usize..=47, 1_usize..=47, 1_usize..12),
        activation in activations(),
    ) {
        let sizes = [inputs, first, second, outputs];
        network::<0>(sizes, activation);
        network::<1>(sizes, activation);
        network::<2>(sizes, activation);
        network::<3>(sizes, activation);
        network::<4>(sizes, activation);
    }
}

/// All numbers that a model returns at (q, v), one after another.
fn evaluated<S: Scalar<Weight = f32> + Bits, const N: usize>(
    model: &Model<N>,
    q: [S; N],
    v: [S; N],
) -> Vec<u32> {
    let weights: Vec<f32> = model.weights.iter().map(|w| *w as f32).collect();
    let inertia_network = model.over(&weights);
    let (e, g, d, h) = (
        inertia_network.energies(&q, &v),
        inertia_network.gradient(&q, &v),
        inertia_network.dynamics(&q, &v),
        inertia_network.hessian(&q, &v),
    );
    let vectors = [g.l_q, g.l_v, d.l_q, d.l_v, d.l_vq_v, h.l_q, h.l_v].concat();
    let matrices = [d.mass.concat(), h.l_qq.concat(), h.l_vq.concat(), h.l_vv.concat()].concat();
    [vec![e.kinetic, e.potential], vectors, matrices].concat().iter().map(Bits::bits).collect()
}

#[test]
fn whole_models() {
    fn check<const N: usize>(model: &Model<N>) {
        let mut random = Random(5);
        for _ in 0..20 {
            let (q, v): ([f64; N], [f64; N]) = (random.array(4.0), random.array(3.0));
            let (q, v) = (q.map(|x| x as f32), v.map(|x| x as f32));
            assert_eq!(evaluated(model, q.map(Controller), v.map(Controller)), evaluated(model, q, v));
        }
    }
    shapes::for_each_shape!(check);
}
