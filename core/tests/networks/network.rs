//! Activations, layers and perceptrons against exact derivatives, finite differences, and a row-major implementation.

use crate::common::dual::Dual;
use crate::common::shapes::{naive_activation, naive_layer, naive_network};
use crate::common::{Random, assert_close};
use leastaction_core::network::{Activation, Dense, Jet, Mlp, Tape};
use leastaction_core::scalar::WeightFormat;
use proptest::prelude::*;

#[test]
fn slopes_and_curvatures_are_the_derivatives() {
    const STEP: f64 = 1e-4;
    for activation in Activation::ALL {
        for k in -60..=60 {
            // Avoids 0, where the two branches of |z| meet and the oracle has no side.
            let z = f64::from(k) * 0.25 + 0.01;
            let found = activation.curve(z);
            let exact = activation.curve(Dual::moving(z, [1.0; 2]));
            let naive = |z: f64| naive_activation(activation, z);
            assert_close("value", found.value, naive(z), 1e-15);
            assert_close("slope", found.slope, exact.value.0.eps1, 1e-14);
            assert_close("curvature", found.curvature, exact.value.0.eps1eps2, 1e-14);
            assert_close("third", activation.third(z, &found), exact.slope.0.eps1eps2, 1e-14);
            assert_close("slope's own derivative", exact.slope.0.eps1, found.curvature, 1e-14);
            assert_close("slope", found.slope, (naive(z + STEP) - naive(z - STEP)) / (2.0 * STEP), 1e-8);
            let second = (naive(z + STEP) - 2.0 * naive(z) + naive(z - STEP)) / (STEP * STEP);
            assert_close("curvature", found.curvature, second, 1e-6);
        }
    }
}

#[test]
fn activations_keep_their_accuracy_far_out() {
    for activation in Activation::ALL {
        for z in [-80.0_f32, -20.0, -1e-3, 0.0, 1e-3, 20.0, 80.0] {
            let (single, double) = (activation.curve(z), activation.curve(f64::from(z)));
            for (a, b) in [(single.value, double.value), (single.slope, double.slope)] {
                let error = (f64::from(a) - b).abs();
                assert!(error <= 3e-6 * b.abs() + 1e-37, "{activation:?} at {z}: {a:e} instead of {b:e}");
            }
        }
        for z in [-1e30_f32, -1e10, 1e10, 1e30] {
            let c = activation.curve(z);
            assert!(
                c.value.is_finite() && c.slope.is_finite() && c.curvature.is_finite(),
                "{activation:?} at {z}"
            );
        }
    }
}

/// A network of one unit, all of whose weights are 1.
#[test]
fn a_unit_carries_tangents_through_value_and_slope() {
    for activation in Activation::ALL {
        let weights = [1.0, 0.0, 1.0, 0.0];
        let unit = Mlp::<f64, 1, 1>::take(&mut &weights[..], 1, &[1], 1, activation).unwrap();
        let z = Jet { value: 0.7, tangent: [1.5, -0.3] };
        let mut tape = Tape::<f64, 2, 1, 1>::default();
        let (mut y, mut slope) = ([Jet::zero()], [Jet::zero()]);
        unit.forward(&[z], &mut tape, &mut y);
        unit.adjoint(&tape, &[Jet::<f64, 2>::constant(1.0)], &mut slope);
        let c = activation.curve(0.7);
        assert_eq!(y, [Jet { value: c.value, tangent: [c.slope * 1.5, c.slope * -0.3] }]);
        assert_eq!(slope, [Jet { value: c.slope, tangent: [c.curvature * 1.5, c.curvature * -0.3] }]);
    }
}

#[test]
fn positions_are_a_permutation_in_panels_of_8_4_and_1() {
    for (inputs, outputs) in [(3, 7), (7, 13), (13, 5), (2, 21), (5, 1), (1, 8), (4, 4)] {
        let mut seen = vec![false; inputs * outputs];
        for i in 0..outputs {
            for j in 0..inputs {
                let position = Dense::<f64>::position(inputs, outputs, i, j);
                assert!(!core::mem::replace(&mut seen[position], true), "({i}, {j}) of {inputs} → {outputs}");
            }
        }
    }
    // Output 9 of 7 does not exist: the result is still a number, never a loop or a panic.
    let _ = Dense::<f64>::position(3, 7, 9, 0);
    // 13 outputs of 2 inputs: a panel of 8, one of 4, one of 1.
    let at = |i, j| Dense::<f64>::position(2, 13, i, j);
    assert_eq!([at(0, 0), at(7, 0), at(0, 1), at(7, 1)], [0, 7, 8, 15]);
    assert_eq!([at(8, 0), at(11, 0), at(8, 1), at(11, 1)], [16, 19, 20, 23]);
    assert_eq!([at(12, 0), at(12, 1)], [24, 25]);
}

/// A network of the given layer sizes with random weights, and a naive twin.
struct Net {
    sizes: Vec<usize>,
    activation: Activation,
    weights: Vec<f64>,
}

const WIDTH: usize = 24;
const DEPTH: usize = 3;

impl Net {
    fn new(sizes: &[usize], activation: Activation, seed: u64) -> Self {
        let (inputs, outputs) = (sizes[0], sizes[sizes.len() - 1]);
        let length =
            Mlp::<f64, WIDTH, DEPTH>::parameters(inputs, &sizes[1..sizes.len() - 1], outputs).unwrap();
        Self { sizes: sizes.to_vec(), activation, weights: Random(seed).vector(length, 0.7) }
    }

    fn inputs(&self) -> usize {
        self.sizes[0]
    }

    fn outputs(&self) -> usize {
        self.sizes[self.sizes.len() - 1]
    }

    fn over<'a, W: WeightFormat>(&self, mut weights: &'a [W]) -> Mlp<'a, W, WIDTH, DEPTH> {
        let hidden = &self.sizes[1..self.sizes.len() - 1];
        let mlp = Mlp::take(&mut weights, self.inputs(), hidden, self.outputs(), self.activation).unwrap();
        assert!(weights.is_empty());
        mlp
    }

    fn naive(&self, x: &[f64]) -> Vec<f64> {
        let [_, hidden @ .., outputs] = &self.sizes[..] else { panic!("{:?}", self.sizes) };
        naive_network(&self.weights, x.to_vec(), hidden.iter().copied(), self.activation, *outputs)
    }

    /// y at x moving along two directions, by dual numbers.
    fn exact(&self, x: &[f64], along: [&[f64]; 2]) -> Vec<Dual> {
        let weights: Vec<Dual> = self.weights.iter().map(|w| Dual::constant(*w)).collect();
        let x: Vec<Jet<Dual, 0>> =
            (0..x.len()).map(|j| Jet::constant(Dual::moving(x[j], along.map(|a| a[j])))).collect();
        let mut y = vec![Jet::zero(); self.outputs()];
        self.over(&weights).forward(&x, &mut Tape::<Dual, 0, WIDTH, DEPTH>::default(), &mut y);
        y.into_iter().map(|y| y.value).collect()
    }

    /// Checks everything at once: values and tangents forward; adjoints and their tangents backward.
    fn check(&self) {
        let mut random = Random(3);
        let (x, d) = (random.vector(self.inputs(), 1.0), random.vector(self.inputs(), 1.0));
        let (y_bar, dy_bar) = (random.vector(self.outputs(), 1.0), random.vector(self.outputs(), 1.0));
        let still = vec![0.0; self.inputs()];
        let mlp = self.over(&self.weights);
        let jets = |value: &[f64], tangent: &[f64]| -> Vec<Jet<f64, 1>> {
            value.iter().zip(tangent).map(|(v, t)| Jet { value: *v, tangent: [*t] }).collect()
        };
        let input = jets(&x, &d);
        let mut tape = Tape::<f64, 1, WIDTH, DEPTH>::default();
        let mut y = vec![Jet::zero(); self.outputs()];
        mlp.forward(&input, &mut tape, &mut y);
        let (naive, exact) = (self.naive(&x), self.exact(&x, [&d, &still]));
        for i in 0..self.outputs() {
            assert_close("y", y[i].value, naive[i], 1e-13);
            assert_close("ẏ", y[i].tangent[0], exact[i].0.eps1, 1e-13);
        }
        let mut x_bar = vec![Jet::zero(); self.inputs()];
        mlp.adjoint(&tape, &jets(&y_bar, &dy_bar), &mut x_bar);
        for (j, x_bar) in x_bar.iter().enumerate() {
            let unit: Vec<f64> = (0..self.inputs()).map(|k| f64::from(k == j)).collect();
            let y = self.exact(&x, [&unit, &d]);
            let sum = |f: &dyn Fn(usize) -> f64| (0..self.outputs()).map(f).sum::<f64>();
            assert_close("x̄", x_bar.value, sum(&|i| y_bar[i] * y[i].0.eps1), 1e-12);
            let tangent = sum(&|i| dy_bar[i] * y[i].0.eps1 + y_bar[i] * y[i].0.eps1eps2);
            assert_close("x̄'s tangent", x_bar.tangent[0], tangent, 1e-12);
        }
    }
}

#[test]
fn networks_with_panels_of_8_4_and_1() {
    for (k, activation) in Activation::ALL.into_iter().enumerate() {
        Net::new(&[3, 7, 13, 5], activation, k as u64).check();
        Net::new(&[5, 22, 9, 17, 2], activation, 10 + k as u64).check();
        Net::new(&[4, 13], activation, 20 + k as u64).check();
    }
}

/// A plain gradient does not depend on whether the tape carries tangents.
#[test]
fn adjoints_of_fewer_tangents_than_the_tape() {
    let net = Net::new(&[3, 7, 13, 5], Activation::Tanh, 42);
    let mlp = net.over(&net.weights);
    let x = [0.3, -0.8, 0.5];
    let (mut with, mut without) =
        (Tape::<f64, 2, WIDTH, DEPTH>::default(), Tape::<f64, 0, WIDTH, DEPTH>::default());
    let (mut y2, mut y0) = ([Jet::zero(); 5], [Jet::zero(); 5]);
    mlp.forward(&x.map(|x| Jet { value: x, tangent: [1.0, -2.0] }), &mut with, &mut y2);
    mlp.forward(&x.map(Jet::constant), &mut without, &mut y0);
    assert_eq!(y2.map(|y| y.value), y0.map(|y| y.value));
    let y_bar = [0.1, -0.2, 0.3, 0.4, -0.5].map(Jet::<f64, 0>::constant);
    let (mut a, mut b) = ([Jet::zero(); 3], [Jet::zero(); 3]);
    mlp.adjoint(&with, &y_bar, &mut a);
    mlp.adjoint(&without, &y_bar, &mut b);
    assert_eq!(a, b);
}

#[test]
fn networks_that_are_too_long_too_deep_or_too_wide_are_refused() {
    let weights = [0.0_f32; 100];
    let take = |n: usize, widths: &[usize]| {
        let mut block = &weights[..n];
        Mlp::<f32, 5, 2>::take(&mut block, 3, widths, 2, Activation::Tanh).map(|_| block.len())
    };
    assert_eq!(Mlp::<f32, 5, 2>::parameters(3, &[4, 5], 2), Some(4 * 4 + 5 * 5 + 6 * 2));
    assert_eq!(take(60, &[4, 5]), Some(60 - 53));
    assert_eq!(take(52, &[4, 5]), None);
    assert_eq!(take(100, &[4, 5, 1]), None);
    assert_eq!(take(100, &[4, 6]), None);
    assert_eq!(Mlp::<f32, 5, 2>::parameters(usize::MAX, &[4], 2), None);
    assert_eq!(Mlp::<f32, 5, 2>::parameters(3, &[usize::MAX / 2], 2), None);
    let mut block = &weights[..];
    assert!(Dense::take(&mut block, usize::MAX, 2).is_none());
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(48) })]

    #[test]
    fn networks_of_random_shape(
        sizes in prop::collection::vec(1..=WIDTH, 2..=5),
        activation in prop::sample::select(&Activation::ALL[..]),
        seed in any::<u64>(),
    ) {
        Net::new(&sizes, activation, seed).check();
    }

    #[test]
    fn layers_are_the_row_major_product(
        inputs in 0usize..20, outputs in 0usize..40, seed in any::<u64>(),
    ) {
        let mut random = Random(seed);
        let weights = random.vector(Dense::<f64>::parameters(inputs, outputs).unwrap(), 2.0);
        let x = random.vector(inputs, 2.0);
        let expected = naive_layer(&mut &weights[..], &x, outputs);
        let mut block = &weights[..];
        let layer = Dense::take(&mut block, inputs, outputs).unwrap();
        prop_assert!(block.is_empty());
        prop_assert_eq!((layer.inputs(), layer.outputs(), layer.len()), (inputs, outputs, weights.len()));
        let x: Vec<Jet<f64, 0>> = x.iter().map(|x| Jet::constant(*x)).collect();
        let mut y = vec![Jet::zero(); outputs];
        layer.forward(&x, &mut y);
        for (y, expected) in y.iter().zip(&expected) {
            // The stated order of the sum is the naive one, so results agree to the last bits.
            assert_close("y", y.value, *expected, 1e-13);
        }
    }

    /// One tangent at a time, with inputs gathered in parts: the same sums to the last bit.
    #[test]
    fn layers_of_a_controller_are_sums_in_the_stated_order(
        inputs in 0usize..80, outputs in 0usize..24, seed in any::<u64>(),
    ) {
        let mut random = Random(seed);
        let mut numbers = |n| random.vector(n, 2.0).iter().map(|x| *x as f32).collect::<Vec<_>>();
        let weights = numbers(Dense::<f32>::parameters(inputs, outputs).unwrap());
        let (values, rates) = (numbers(inputs.max(outputs)), numbers(inputs.max(outputs)));
        let jet = |k: usize| Jet { value: values[k], tangent: [rates[k], -2.0 * values[k]] };
        let layer = Dense::take(&mut &weights[..], inputs, outputs).unwrap();
        let (mut y, mut x_bar) = (vec![Jet::zero(); outputs], vec![Jet::zero(); inputs]);
        layer.forward(&(0..inputs).map(jet).collect::<Vec<_>>(), &mut y);
        let w = |i, j| weights[Dense::<f32>::position(inputs, outputs, i, j)];
        for (i, y) in y.iter().enumerate() {
            let sum = |start, x: &dyn Fn(usize) -> f32| (0..inputs).fold(start, |sum, j| sum + w(i, j) * x(j));
            prop_assert_eq!(y.value.to_bits(), sum(weights[inputs * outputs + i], &|j| jet(j).value).to_bits());
            for k in 0..2 {
                prop_assert_eq!(y.tangent[k].to_bits(), sum(0.0, &|j| jet(j).tangent[k]).to_bits());
            }
        }
        layer.adjoint(&(0..outputs).map(jet).collect::<Vec<_>>(), &mut x_bar);
        for (j, x) in x_bar.iter().enumerate() {
            let sum = |y: &dyn Fn(usize) -> f32| {
                (0..outputs).map(|i| f64::from(w(i, j)) * f64::from(y(i))).sum::<f64>()
            };
            assert_close("value", f64::from(x.value), sum(&|i| jet(i).value), 1e-5);
            assert_close("tangent", f64::from(x.tangent[1]), sum(&|i| jet(i).tangent[1]), 1e-5);
        }
    }
}
