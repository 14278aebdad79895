//! Families of energies: each gives a [`Lagrangian`](crate::lagrangian::Lagrangian), and, but for [`bodies`] and
//! [`spatial`] (which the host's programs differentiate), its [`Learnable`] derivatives in the weights.
//!
//! - [`rigid`]: inertia matrix and potential from one network (SyMo, L-NODE, DeLaN);
//! - [`bodies`]: trees of rigid bodies on joints in the plane, by their masses, lengths and inertias;
//! - [`spatial`]: the same in space: arms;
//! - [`modular`]: a tree of reusable elements (ModLaNet);
//! - [`graph`]: particles with potentials of their own, of pairs and of messages (LGNN), any number of them;
//! - [`trigonometric`]: exact mechanisms whose inertia and potential are sums of cosines: references and plants.

pub mod bodies;
mod distance;
pub mod graph;
mod list;
pub mod modular;
mod network_shape;
mod placed_network;
pub mod rigid;
pub mod spatial;
pub mod trigonometric;

pub use list::List;
pub use network_shape::{MAX_HIDDEN, NetworkShape, SizeError};
pub use placed_network::PlacedNetwork;

use crate::scalar::Scalar;

/// A Lagrangian whose derivatives in its weights θ are known, for training.
///
/// All losses are sums of these two terms: the chain rule through an implicit step or a mass solve only chooses the
/// directions. Positions are those of the weight block; a position may be visited more than once, its derivative is the
/// sum.
pub trait Learnable<S: Scalar, const N: usize> {
    /// Visits ∂/∂θ of L_q·δq + L_v·δv at (q, v), as `row(position, value)`.
    fn directional_gradient(
        &self,
        at: (&[S; N], &[S; N]),
        along: (&[S; N], &[S; N]),
        row: impl FnMut(usize, S),
    );

    /// Visits ∂/∂θ of y·(L_q − d/dt L_v) = y·(L_q − L_vq v − L_vv a) at (q, v) with acceleration a and constant y: the
    /// gradient of the Euler–Lagrange residual, and so of the acceleration.
    fn residual_gradient(&self, at: (&[S; N], &[S; N]), a: &[S; N], y: &[S; N], row: impl FnMut(usize, S));
}

/// Forces whose derivatives in their weights θ are known, for training.
pub trait LearnableForces<S: Scalar, const N: usize> {
    /// Visits ∂/∂θ of y·Q(q, v) with constant y, as `row(position, value)`; see [`Learnable`].
    fn force_gradient(&self, at: (&[S; N], &[S; N]), y: &[S; N], row: impl FnMut(usize, S));
}
