//! Multilayer perceptrons over borrowed weights: value, tangents, adjoint, and second order by carrying tangents
//! through the adjoint.

mod activation;
mod dense;
mod jet;
mod mlp;
mod product;
mod second_order;
mod series;
mod units;

pub(crate) use activation::softplus_jets;
pub use activation::{Activation, Curve};
pub use dense::Dense;
pub use jet::Jet;
pub(crate) use mlp::Vectors;
pub use mlp::{Mlp, Tape};
pub use second_order::SecondOrderTape;
pub use units::Units;
