//! Inertia matrix and potential of a mechanism from one network (SyMo; also L-NODE and DeLaN).
//!
//! L(q, v) = ½vᵀH(q)v − V(q), (H, V) = heads(trunk(s(q))), with features s(q) of the coordinates. Sources: SyMo,
//! section 3 and its published program; Lutter et al., "Deep Lagrangian Networks", ICLR 2019.

mod features;
mod inertia;

pub(crate) use features::Features;
pub use features::{Coordinate, count as feature_count};
pub use inertia::Inertia;

use crate::energy::network_shape::first_invalid;
use crate::energy::{NetworkShape, SizeError};
use crate::expected::{first, first_mut};
use crate::lagrangian::{Dynamics, Energies, Gradient, Hessian, Lagrangian, Linearization};
use crate::linear::{add_scaled, dot, multiply, transpose};
use crate::network::{Activation, Jet, Mlp, SecondOrderTape, Tape};
use crate::scalar::{Scalar, WeightFormat};
use inertia::{Jets, OutputJets, Outputs, without_tangents};

/// The shape of an inertia network, without its numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InertiaNetworkShape<const N: usize> {
    /// Kind of each coordinate.
    pub coordinates: [Coordinate; N],
    /// Network from the features of the coordinates to the outputs that `inertia` reads.
    pub network: NetworkShape,
    /// Form of the inertia matrix.
    pub inertia: Inertia,
}

impl<const N: usize> InertiaNetworkShape<N> {
    /// Creates a shape with hidden layers of the given widths; the first 0 or the end of the slice ends the list. `None` for more than
    /// [`MAX_HIDDEN`](crate::energy::MAX_HIDDEN) widths, or more than 255 inputs or outputs.
    pub fn new(
        coordinates: [Coordinate; N],
        widths: &[u16],
        activation: Activation,
        inertia: Inertia,
    ) -> Option<Self> {
        let network = network_shape(feature_count(&coordinates), widths, (inertia, N), activation)?;
        Some(Self { coordinates, network, inertia })
    }

    /// Length of the network's weight block, in numbers; `None` on overflow.
    pub fn parameters(&self) -> Option<usize> {
        self.network.parameters()
    }

    /// Name of the first invalid part; `None` if the shape is valid.
    pub fn invalid_part(&self) -> Option<&'static str> {
        let serves = self.network.serves(feature_count(&self.coordinates), self.inertia.outputs(N));
        first_invalid(&[
            (!self.network.is_valid(), "hidden width"),
            (!serves, "network of the inertia matrix"),
        ])
    }

    /// Checks that the network has at most `L` hidden layers of at most `H` units.
    ///
    /// # Errors
    /// [`SizeError`] with the first limit that is exceeded.
    pub fn check_size<const H: usize, const L: usize>(&self) -> Result<(), SizeError> {
        self.network.check_size::<H, L>()
    }
}

/// The network of a model with `n` coordinates and `features` features in all; `None` as for [`InertiaNetworkShape::new`].
pub fn network_shape(
    features: usize,
    widths: &[u16],
    (inertia, n): (Inertia, usize),
    activation: Activation,
) -> Option<NetworkShape> {
    let (inputs, outputs) = (features.try_into().ok()?, inertia.outputs(n).try_into().ok()?);
    NetworkShape::new(inputs, widths, outputs, activation)
}

/// An inertia network in N coordinates over borrowed weights: at most `L` hidden layers of at most `H` units.
#[derive(Clone, Copy, Debug)]
pub struct InertiaNetwork<'a, W, const N: usize, const H: usize, const L: usize> {
    coordinates: [Coordinate; N],
    inertia: Inertia,
    network: Mlp<'a, W, H, L>,
}

impl<'a, W: WeightFormat, const N: usize, const H: usize, const L: usize> InertiaNetwork<'a, W, N, H, L> {
    /// Builds the mechanism on the front of `block` and leaves the rest there. `None` if the block is too short, the shape is invalid (see
    /// [`InertiaNetworkShape::invalid_part`]), or it has more than `L` hidden layers or `H` units in a layer.
    pub fn take(block: &mut &'a [W], shape: &InertiaNetworkShape<N>) -> Option<Self> {
        if shape.invalid_part().is_some() {
            return None;
        }
        let network = shape.network.take(block)?;
        Some(Self { coordinates: shape.coordinates, inertia: shape.inertia, network })
    }

    /// Kind of each coordinate.
    pub fn coordinates(&self) -> &[Coordinate; N] {
        &self.coordinates
    }

    #[inline]
    fn forward<'o, S: Scalar<Weight = W::Wide>, const T: usize>(
        &self,
        q: &[S; N],
        directions: &[[S; N]; T],
        tape: &mut Tape<S, T, H, L>,
        o: &'o mut OutputJets<S, T, N>,
    ) -> (Features<S, N>, Outputs<'o, S, T, N>) {
        self.evaluate(q, directions, o, |x, y| self.network.forward(x, tape, y))
    }

    /// Evaluates features → network → energies; `pass(inputs, outputs)` runs the network.
    #[inline(always)]
    fn evaluate<'o, S: Scalar<Weight = W::Wide>, const T: usize>(
        &self,
        q: &[S; N],
        directions: &[[S; N]; T],
        o: &'o mut OutputJets<S, T, N>,
        pass: impl FnOnce(&[Jet<S, T>], &mut [Jet<S, T>]),
    ) -> (Features<S, N>, Outputs<'o, S, T, N>) {
        let features = Features::new(&self.coordinates, q);
        let (inputs, count) = features.jets(directions);
        let o = first_mut(o.as_flattened_mut().as_flattened_mut(), self.inertia.outputs(N));
        pass(first(inputs.as_flattened(), count), o);
        (features, Outputs::new(self.inertia, o))
    }

    /// ∂L/∂q and its derivatives along the directions.
    #[inline]
    fn adjoint<S: Scalar<Weight = W::Wide>, const T: usize, const A: usize>(
        &self,
        features: &Features<S, N>,
        tape: &Tape<S, T, H, L>,
        bar: &OutputJets<S, A, N>,
        directions: &[[S; N]; A],
    ) -> Jets<S, A, N> {
        let mut feature_bar = [[Jet::zero(); N]; 2];
        let bar = first(bar.as_flattened().as_flattened(), self.inertia.outputs(N));
        let feature_slots = first_mut(feature_bar.as_flattened_mut(), features.count());
        self.network.adjoint(tape, bar, feature_slots);
        features.adjoint(feature_slots, directions)
    }

    /// ∂L/∂q and the two parts of its derivatives: from the features (as tangents) and from the network.
    #[inline]
    fn adjoint_second_order<S: Scalar<Weight = W::Wide>>(
        &self,
        features: &Features<S, N>,
        tape: &SecondOrderTape<S, N, H, L>,
        bar: &OutputJets<S, N, N>,
    ) -> (Jets<S, N, N>, [[S; N]; N]) {
        let plain = bar.each_ref().map(|rows| rows.each_ref().map(without_tangents));
        let plain = first(plain.as_flattened().as_flattened(), self.inertia.outputs(N));
        let mut feature_bar = [[Jet::zero(); N]; 2];
        let slots = first_mut(feature_bar.as_flattened_mut(), features.count());
        let l_qq = self.network.second_order(tape, plain, slots);
        let feature_bar = feature_bar.map(|row| row.map(|x| Jet::constant(x.value)));
        (features.adjoint(feature_bar.as_flattened(), &unit_vectors()), l_qq)
    }
}

impl<W: WeightFormat, const N: usize, const H: usize, const L: usize> InertiaNetwork<'_, W, N, H, L> {
    /// Takes one forward pass with the tangent along v and one adjoint pass: the work of three passes.
    #[inline]
    fn dynamics_by_adjoint<S: Scalar<Weight = W::Wide>>(&self, q: &[S; N], v: &[S; N]) -> Dynamics<S, N> {
        let mut tape = Tape::<S, 1, H, L>::default();
        let mut o = no_outputs();
        let (features, outputs) = self.forward(q, &[*v], &mut tape, &mut o);
        let p = outputs.momentum(&held(v));
        let bar = outputs.without_tangents(|plain| plain.lagrangian_bar(&held(v)));
        Dynamics {
            mass: outputs.mass_matrix(),
            l_q: self.adjoint(&features, &tape, &bar, &[]).map(|l| l.value),
            l_v: p.map(|p| p.value),
            l_vq_v: p.map(|Jet { tangent: [along_v], .. }| along_v),
        }
    }
}

/// Room for the network's outputs.
#[inline(always)]
fn no_outputs<S: Scalar, const T: usize, const N: usize>() -> OutputJets<S, T, N> {
    [[[Jet::zero(); N]; N]; 2]
}

/// v, constant along all directions: all tangents are zero.
#[inline(always)]
fn held<S: Scalar, const T: usize, const N: usize>(v: &[S; N]) -> Jets<S, T, N> {
    v.map(Jet::constant)
}

/// The N unit vectors.
#[inline(always)]
fn unit_vectors<S: Scalar, const N: usize>() -> [[S; N]; N] {
    core::array::from_fn(|i| core::array::from_fn(|j| if i == j { S::one() } else { S::zero() }))
}

impl<W: WeightFormat, S: Scalar<Weight = W::Wide>, const N: usize, const H: usize, const L: usize>
    Lagrangian<S, N> for InertiaNetwork<'_, W, N, H, L>
{
    fn energies(&self, q: &[S; N], v: &[S; N]) -> Energies<S> {
        let (mut tape, mut o) = (Tape::<S, 0, H, L>::default(), no_outputs());
        let (_, outputs) = self.forward(q, &[], &mut tape, &mut o);
        let p = outputs.momentum(&held(v)).map(|p| p.value);
        Energies { kinetic: dot(&p, v).half(), potential: outputs.potential().value }
    }

    // Separate functions keep only one tape at a time on a controller's stack.
    #[inline(never)]
    fn gradient(&self, q: &[S; N], v: &[S; N]) -> Gradient<S, N> {
        let mut tape = Tape::<S, 0, H, L>::default();
        let mut o = no_outputs();
        let (features, outputs) = self.forward(q, &[], &mut tape, &mut o);
        let v = held(v);
        let l_q = self.adjoint(&features, &tape, &outputs.lagrangian_bar(&v), &[]);
        Gradient { l_q: l_q.map(|l| l.value), l_v: outputs.momentum(&v).map(|p| p.value) }
    }

    /// Uses the method that takes fewer passes through the network for this N, and forms no dense ∂H/∂q.
    fn dynamics(&self, q: &[S; N], v: &[S; N]) -> Dynamics<S, N> {
        if N <= 2 { self.linearization(q, v).dynamics(v) } else { self.dynamics_by_adjoint(q, v) }
    }

    /// Takes one forward pass with N tangents: the work of 1 + N passes. L_q = ½vᵀ(∂H/∂q)v − ∂V/∂q.
    #[inline]
    fn linearization(&self, q: &[S; N], v: &[S; N]) -> Linearization<S, N> {
        let mut o = no_outputs();
        let pass = |x: &[_], y: &mut [_]| self.network.evaluate::<S, N>(x, y);
        let (_, outputs) = self.evaluate(q, &unit_vectors(), &mut o, pass);
        let (p, potential) = (outputs.momentum(&held(v)), outputs.potential());
        let l_vq = p.map(|p| p.tangent);
        let twice_kinetic_q = multiply(&transpose(&l_vq), v);
        Linearization {
            l_q: core::array::from_fn(|k| twice_kinetic_q[k].half() - potential.tangent[k]),
            l_v: p.map(|p| p.value),
            l_vq,
            l_vv: outputs.mass_matrix(),
        }
    }

    /// Takes one forward pass with N tangents and one plain adjoint pass. L_qq is Σ_o ∂o/∂q_i ∂ō/∂q_j with ō = ∂L/∂o, plus the second
    /// derivatives of the network weighted by ō, plus those of the features.
    #[inline(never)]
    fn hessian(&self, q: &[S; N], v: &[S; N]) -> Hessian<S, N> {
        let mut tape = SecondOrderTape::<S, N, H, L>::default();
        let mut o = no_outputs();
        let pass = |x: &[_], y: &mut [_]| self.network.forward_second_order(x, &mut tape, y);
        let (features, outputs) = self.evaluate(q, &unit_vectors(), &mut o, pass);
        let v = held(v);
        let bar = outputs.lagrangian_bar(&v);
        let (l_q, of_network) = self.adjoint_second_order(&features, &tape, &bar);
        let p = outputs.momentum(&v);
        Hessian {
            l_q: l_q.map(|l| l.value),
            l_v: p.map(|p| p.value),
            l_qq: assembled(&l_q, &of_network, outputs.o, &bar),
            l_vq: p.map(|p| p.tangent),
            l_vv: outputs.mass_matrix(),
        }
    }
}

/// L_qq as the sum of three parts: the features' (tangents of `l_q`), the network's (`of_network`), and Σ_o ∂o/∂q_i ∂ō/∂q_j.
#[inline]
fn assembled<S: Scalar, const N: usize>(
    l_q: &Jets<S, N, N>,
    of_network: &[[S; N]; N],
    o: &[Jet<S, N>],
    bar: &OutputJets<S, N, N>,
) -> [[S; N]; N] {
    let mut sum: [[S; N]; N] =
        core::array::from_fn(|i| core::array::from_fn(|j| l_q[i].tangent[j] + of_network[i][j]));
    let pairs = o.iter().zip(bar.as_flattened().as_flattened());
    for (o, bar) in pairs {
        for (row, o) in sum.iter_mut().zip(&o.tangent) {
            *row = add_scaled(row, *o, &bar.tangent);
        }
    }
    sum
}
