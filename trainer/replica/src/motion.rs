use crate::{Control, ReplicaError};
use leastaction_core::discrete::Report;

/// A model in motion, advanced in the same steps as on the chip.
///
/// A motion may move between threads.
pub trait Motion: Send {
    /// Position q, m or rad.
    fn q(&self) -> &[f32];

    /// Generalised momentum p = L_v.
    fn p(&self) -> &[f32];

    /// Writes the velocity for the momentum: L_v(q, v) = p, m/s or rad/s.
    ///
    /// # Errors
    /// [`ReplicaError::Length`]; an error if the inertia is singular.
    fn velocity(&self, to: &mut [f32]) -> Result<(), ReplicaError>;

    /// Numbers from which [`Replica::motion_resumed`](crate::Replica::motion_resumed) continues with the same bits.
    fn saved(&self) -> Vec<f32>;

    /// Advances by one step under a control, and returns the number of Newton updates and their residual. The step of a graph takes a
    /// constant force: the mean of both ends.
    ///
    /// # Errors
    /// [`ReplicaError::Length`]; an error if the step cannot be solved. The motion is then unchanged.
    fn step(&mut self, control: Control) -> Result<Report<f32>, ReplicaError>;
}
