//! Learning the weights of a model from motion: the losses and the optimisers.
//!
//! A model of another kind is trained by the same optimisers where it is an [`Objective`]: by its [`Residuals`], or, where it is a
//! [`Family`](crate::architecture::Family), by [`Accelerations`].

mod adam;
mod blocks;
mod levenberg;
mod loss;
mod normal;
mod objective;
mod residuals;
mod samples;
mod steps;

pub use adam::{Adam, AdamSettings, Schedule};
pub use levenberg::{Levenberg, Progress};
pub use loss::LossKind;
pub use normal::NormalEquations;
pub(crate) use objective::order_of;
pub use objective::{Accelerations, Objective, Solved, objective};
pub use residuals::{ChunkRows, Failed, Residuals};
pub use samples::{SampleError, Samples};
pub use steps::Steps;
