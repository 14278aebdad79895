use crate::ReplicaError;
use leastaction_core::lagrangian::Energies;

/// Energies and continuous dynamics of a model at given states. All slices have n numbers, those of particles one
/// after another.
///
/// An evaluator has its own workspace, so every thread needs one.
pub trait Evaluator {
    /// Energies T(q, v) and V(q), J.
    ///
    /// # Errors
    /// [`ReplicaError::Length`].
    fn energies(&mut self, q: &[f32], v: &[f32]) -> Result<Energies<f32>, ReplicaError>;

    /// Writes v̇(q, v, τ), m/s² or rad/s², where τ is the force at the actuator's output (N or N m); for particles with rods, the
    /// acceleration under their constraints.
    ///
    /// # Errors
    /// [`ReplicaError::Length`]; an error if the inertia is singular or a number is not finite. The numbers written then have no meaning.
    fn acceleration(&mut self, q: &[f32], v: &[f32], tau: &[f32], to: &mut [f32])
    -> Result<(), ReplicaError>;

    /// Writes the force τ that gives the acceleration a (inverse dynamics), N or N m.
    ///
    /// # Errors
    /// [`ReplicaError::Length`]; an error if a number is not finite or the equation cannot be solved. The numbers written then have no
    /// meaning.
    fn inverse_dynamics(
        &mut self,
        q: &[f32],
        v: &[f32],
        a: &[f32],
        to: &mut [f32],
    ) -> Result<(), ReplicaError>;

    /// Writes M(q) = L_vv at rest, n rows of n, symmetric, kg, kg m or kg m².
    ///
    /// # Errors
    /// [`ReplicaError::Length`]; `to` must have n² numbers.
    fn mass_matrix(&mut self, q: &[f32], to: &mut [f32]) -> Result<(), ReplicaError>;
}
