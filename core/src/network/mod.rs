//! Multilayer perceptrons over borrowed weights: value, tangents, adjoint, and second order by carrying tangents
//! through the adjoint.

mod activation;
mod apart;
mod bends;
mod dense;
mod jet;
mod mlp;
mod series;

use heapless::Vec;

pub use activation::{Activation, Curve};
pub use bends::Bends;
pub use dense::{Dense, NARROW};
pub use jet::Jet;
pub use mlp::{Mlp, Tape};

/// The first `n` places of a layer's room, each written before it is read: room that is not used costs no time.
///
/// Nothing where the room is too small; shapes are checked when a model is read.
#[inline(always)]
fn sized<T: Copy, const H: usize>(room: &mut Vec<T, H>, n: usize, fill: T) -> &mut [T] {
    room.clear();
    // An error leaves it empty.
    let _: Result<(), _> = room.resize(n, fill);
    room
}
