//! Inertia matrix and potential of a mechanism from one network (SyMo; also L-NODE and DeLaN).
//!
//! L(q, v) = ½vᵀH(q)v − V(q), (H, V) = heads(trunk(s(q))), with features s(q) of the coordinates. Sources: SyMo,
//! section 3 and its published program; Lutter et al., "Deep Lagrangian Networks", ICLR 2019.

mod features;
mod inertia;
mod parameters;

pub use features::{Coordinate, count as feature_count};
pub use inertia::Inertia;

use crate::lagrangian::{DenseMass, Dynamics, Energies, Gradient, Hessian, Lagrangian};
use crate::linear::dot;
use crate::network::{Activation, Jet, Mlp, Tape};
use crate::scalar::Scalar;
use features::Features;
use inertia::{Jets, OutputBar, Outputs};

/// The shape of a rigid model, apart from its numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape<'a, const N: usize> {
    /// What each coordinate is.
    pub coordinates: [Coordinate; N],
    /// Units of every hidden layer, first to last.
    pub widths: &'a [usize],
    /// Of the hidden layers.
    pub activation: Activation,
    /// Of H.
    pub inertia: Inertia,
}

impl<const N: usize> Shape<'_, N> {
    /// Numbers in the network's weight block; `None` on overflow.
    pub fn parameters(&self) -> Option<usize> {
        let inputs = feature_count(&self.coordinates);
        Mlp::<f32, 0>::parameters(inputs, self.widths, self.inertia.outputs(N))
    }
}

/// A rigid mechanism in N coordinates over borrowed weights: at most `D` hidden layers of at most `H` units.
#[derive(Clone, Copy, Debug)]
pub struct Rigid<'a, W, const N: usize, const H: usize, const D: usize> {
    coordinates: [Coordinate; N],
    inertia: Inertia,
    network: Mlp<'a, W, D>,
}

impl<'a, W: Copy, const N: usize, const H: usize, const D: usize> Rigid<'a, W, N, H, D> {
    /// Builds the mechanism on the front of `block` and leaves the rest there. `None` where the block is too short, there
    /// are more than `D` hidden layers, or one is wider than `H`.
    pub fn take(block: &mut &'a [W], shape: &Shape<N>) -> Option<Self> {
        if shape.widths.iter().any(|width| *width > H) {
            return None;
        }
        let inputs = feature_count(&shape.coordinates);
        let outputs = shape.inertia.outputs(N);
        let network = Mlp::take(block, inputs, shape.widths, outputs, shape.activation)?;
        Some(Self { coordinates: shape.coordinates, inertia: shape.inertia, network })
    }

    /// What each coordinate is.
    pub fn coordinates(&self) -> &[Coordinate; N] {
        &self.coordinates
    }

    #[inline]
    fn forward<S: Scalar<Weight = W>, const T: usize>(
        &self,
        q: &[S; N],
        directions: &[[S; N]; T],
        tape: &mut Tape<S, T, H, D>,
    ) -> (Features<S, N>, Outputs<S, T, N>) {
        let features = Features::new(&self.coordinates, q);
        let (inputs, count) = features.jets(directions);
        let mut outputs: OutputBar<S, T, N> = [[[Jet::zero(); N]; N]; 2];
        let outputs = outputs.as_flattened_mut().as_flattened_mut();
        let outputs = outputs.get_mut(..self.network.outputs()).unwrap_or_default();
        self.network.forward(inputs.as_flattened().get(..count).unwrap_or(&[]), tape, outputs);
        (features, Outputs::new(self.inertia, outputs))
    }

    /// ∂L/∂q and its derivatives along the directions.
    #[inline]
    fn adjoint<S: Scalar<Weight = W>, const T: usize, const A: usize>(
        &self,
        features: &Features<S, N>,
        tape: &Tape<S, T, H, D>,
        bar: &OutputBar<S, A, N>,
        directions: &[[S; N]; A],
    ) -> Jets<S, A, N> {
        let mut feature_bar = [[Jet::zero(); N]; 2];
        let bar = bar.as_flattened().as_flattened().get(..self.network.outputs()).unwrap_or(&[]);
        let count = feature_count(&self.coordinates);
        let feature_slots = feature_bar.as_flattened_mut().get_mut(..count).unwrap_or_default();
        self.network.adjoint(tape, bar, feature_slots);
        features.adjoint(feature_slots, directions)
    }
}

/// v with all tangents zero.
#[inline(always)]
fn held<S: Scalar, const T: usize, const N: usize>(v: &[S; N]) -> Jets<S, T, N> {
    v.map(Jet::constant)
}

/// The N unit vectors.
#[inline(always)]
fn unit_vectors<S: Scalar, const N: usize>() -> [[S; N]; N] {
    core::array::from_fn(|i| core::array::from_fn(|j| if i == j { S::one() } else { S::zero() }))
}

impl<S: Scalar, const N: usize, const H: usize, const D: usize> Lagrangian<S, N>
    for Rigid<'_, S::Weight, N, H, D>
{
    type Mass = DenseMass<S, N>;

    fn energies(&self, q: &[S; N], v: &[S; N]) -> Energies<S> {
        let (_, outputs) = self.forward(q, &[], &mut Tape::<S, 0, H, D>::default());
        let p = outputs.momentum(&held(v)).map(|p| p.value);
        Energies { kinetic: dot(&p, v).half(), potential: outputs.potential.value }
    }

    fn gradient(&self, q: &[S; N], v: &[S; N]) -> Gradient<S, N> {
        let mut tape = Tape::<S, 0, H, D>::default();
        let (features, outputs) = self.forward(q, &[], &mut tape);
        let v = held(v);
        let l_q = self.adjoint(&features, &tape, &outputs.lagrangian_bar(&v), &[]);
        Gradient { l_q: l_q.map(|l| l.value), l_v: outputs.momentum(&v).map(|p| p.value) }
    }

    /// One forward pass with the tangent along v, one adjoint: no dense derivative of H is ever formed.
    fn dynamics(&self, q: &[S; N], v: &[S; N]) -> Dynamics<S, Self::Mass, N> {
        let mut tape = Tape::<S, 1, H, D>::default();
        let (features, outputs) = self.forward(q, &[*v], &mut tape);
        let p = outputs.momentum(&held(v));
        let bar = outputs.without_tangents().lagrangian_bar(&held(v));
        Dynamics {
            mass: DenseMass(outputs.mass_matrix()),
            l_q: self.adjoint(&features, &tape, &bar, &[]).map(|l| l.value),
            l_v: p.map(|p| p.value),
            l_vq_v: p.map(|Jet { tangent: [along_v], .. }| along_v),
        }
    }

    fn hessian(&self, q: &[S; N], v: &[S; N]) -> Hessian<S, N> {
        let mut tape = Tape::<S, N, H, D>::default();
        let directions = unit_vectors();
        let (features, outputs) = self.forward(q, &directions, &mut tape);
        let v = held(v);
        let l_q = self.adjoint(&features, &tape, &outputs.lagrangian_bar(&v), &directions);
        let p = outputs.momentum(&v);
        Hessian {
            l_q: l_q.map(|l| l.value),
            l_v: p.map(|p| p.value),
            l_qq: l_q.map(|l| l.tangent),
            l_vq: p.map(|p| p.tangent),
            l_vv: outputs.mass_matrix(),
        }
    }
}
