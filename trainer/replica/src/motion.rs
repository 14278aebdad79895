use crate::{Control, ReplicaError};
use leastaction_core::discrete::Report;

/// A model in motion, from step to step as the chip takes them.
///
/// It may move from thread to thread.
pub trait Motion: Send {
    /// q, m or rad.
    fn q(&self) -> &[f32];

    /// The generalised momentum p = L_v.
    fn p(&self) -> &[f32];

    /// Writes the velocity that belongs to the momentum: L_v(q, v) = p, m/s or rad/s.
    ///
    /// # Errors
    /// [`ReplicaError::Length`]; where the inertia is singular.
    fn velocity(&self, to: &mut [f32]) -> Result<(), ReplicaError>;

    /// Goes on by one step under a control, and says how many updates Newton's method took and what it left. A graph's step
    /// takes a constant force: the mean of both ends.
    ///
    /// # Errors
    /// [`ReplicaError::Length`]; where the step cannot be solved. The motion is then where it was.
    fn step(&mut self, control: Control) -> Result<Report<f32>, ReplicaError>;
}
