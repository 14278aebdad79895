//! Multilayer perceptrons over borrowed weights: value, tangents, adjoint, and second order by carrying tangents
//! through the adjoint.

mod activation;
mod componentwise;
mod dense;
mod jet;
mod mlp;
mod second_order;
mod series;

use heapless::Vec;

pub use activation::{Activation, Curve};
pub use dense::{Dense, NARROW};
pub use jet::Jet;
pub use mlp::{Mlp, Tape};
pub use second_order::SecondOrderTape;

/// The first `n` places of a layer's workspace, each written before it is read: workspace that is not used costs no time.
///
/// Nothing where the workspace is too small; shapes are checked when a model is read.
#[inline(always)]
fn sized<T: Copy, const H: usize>(workspace: &mut Vec<T, H>, n: usize, fill: T) -> &mut [T] {
    workspace.clear();
    // An error leaves it empty.
    let _: Result<(), _> = workspace.resize(n, fill);
    workspace
}
