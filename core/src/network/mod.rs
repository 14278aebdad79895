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

/// The first `n` ≤ `H` places of a layer's workspace, filled: places beyond cost no time. [`Mlp::take`] refuses wider layers.
#[inline(always)]
fn sized<T: Copy, const H: usize>(workspace: &mut Vec<T, H>, n: usize, fill: T) -> &mut [T] {
    workspace.clear();
    let resized = workspace.resize(n, fill);
    debug_assert!(resized.is_ok(), "a layer of {n} units in a network of at most {H}");
    workspace
}
