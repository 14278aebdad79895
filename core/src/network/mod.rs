//! Multilayer perceptrons over borrowed weights: value, tangents, adjoint, and second order by carrying tangents
//! through the adjoint.

mod activation;
mod dense;
mod jet;
mod mlp;

pub use activation::Activation;
pub use dense::Dense;
pub use jet::Jet;
pub use mlp::{Mlp, Tape};
