//! Multilayer perceptrons over borrowed weights: value, tangents, adjoint, and second order by carrying tangents
//! through the adjoint.

mod activation;
mod dense;
mod jet;
mod mlp;
mod series;

pub use activation::{Activation, Curve};
pub use dense::Dense;
pub use jet::Jet;
pub use mlp::{Mlp, Tape};
