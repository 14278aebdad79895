//! Learning the weights of a model from motion: the losses and the optimisers.

mod adam;
mod del;
mod levenberg;
mod loss;
mod next_state;
mod normal;
mod objective;
mod residuals;
mod rods;
mod samples;

pub use adam::{Adam, AdamSettings, Schedule};
pub use levenberg::{Levenberg, Progress};
pub use loss::LossKind;
pub(crate) use next_state::Steps;
pub use normal::NormalEquations;
pub(crate) use objective::Accelerations;
pub use objective::{Objective, objective};
pub(crate) use residuals::{ChunkRows, Failed, Residuals};
pub use samples::{SampleError, Samples};
