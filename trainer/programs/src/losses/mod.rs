//! Residuals of samples and their derivatives with respect to the weights.
//!
//! When an implicit step is differentiated, the derivative of every residual component with respect to θ is a sum of
//! ∂/∂θ \[F·δq + L_v·δv\] over the Gauss points of the intervals involved, or over the points of a chain of RATTLE
//! steps; the implicit function theorem only determines δq and δv. The derivative of an acceleration is ∂/∂θ (F − d/dt
//! L_v)·y. Programs of a system compute these sums.

mod acceleration;
mod del;
mod next_state;
mod rods;
mod torque;

pub use acceleration::AccelerationLoss;
pub use del::DelLoss;
pub use next_state::NextStateLoss;
pub use rods::RodsLoss;
pub use torque::TorqueLoss;

use crate::dynamics::Failures;
use crate::row::Row;
use leastaction_core::forces::ControlKind;

/// Samples side by side, n rows each.
#[derive(Clone, Debug, Default)]
pub struct Block {
    /// States (q₋, q, q₊) of the discrete losses; (q, v, v̇) of the losses of accelerations and torques.
    pub states: [Vec<Row>; 3],
    /// Next velocity v₊, for the loss of the next state.
    pub next_velocity: Vec<Row>,
    /// Controls at the same times. For the loss of the next state only the first two, u and u₊, are used; for the
    /// losses of accelerations and torques only the first, u.
    pub controls: [Vec<Row>; 3],
    /// Kind of the controls between these times.
    pub control: ControlKind,
}

impl Block {
    /// Control at the start and at the end of the first step (0) or the second step (1); it is linear between them.
    fn acting(&self, step: usize) -> [&[Row]; 2] {
        let end = match self.control {
            ControlKind::Held => step,
            ControlKind::Linear => step + 1,
        };
        [&self.controls[step], &self.controls[end]]
    }
}

/// Quantity that is differentiated.
pub enum Derivatives<'r> {
    /// Nothing.
    None,
    /// Every residual component with respect to every weight: one row per component.
    Jacobian(&'r mut [Vec<Row>]),
    /// Sum ½Σ r² with respect to every weight.
    Gradient(&'r mut Vec<Row>),
}

/// A residual of every sample, with the workspace to compute it.
pub trait Loss: Send {
    /// Number of residual components of a sample.
    fn components(&self) -> usize;
    /// Writes the residuals, one row per component, and adds their derivatives. Samples that cannot be computed have residual and
    /// derivatives 0.
    fn evaluate(
        &mut self,
        weights: &[f64],
        block: &Block,
        residual: &mut [Row],
        derivatives: Derivatives,
    ) -> Failures;
    /// Residual of a motion with constant velocity, which is used for a sample that cannot be computed. `None` if it is
    /// not defined, as for a residual in units of momentum.
    fn of_constant_velocity(&self, block: &Block) -> Option<Vec<Row>>;
}

/// Returns q + (q − q₋) − q₊.
fn straight_on([before, now, next]: &[Vec<Row>; 3]) -> Vec<Row> {
    let rows = before.iter().zip(now).zip(next);
    rows.map(|((before, now), next)| {
        now.zip(before, |q, before| 2.0 * q - before).zip(next, |q, next| q - next)
    })
    .collect()
}

/// Sets the failed samples to 0.
fn clear(failures: &Failures, rows: &mut [Row]) {
    for (sample, _) in failures.0.iter().enumerate().filter(|(_, failed)| **failed) {
        rows.iter_mut().for_each(|row| row.0[sample] = 0.0);
    }
}

/// Returns these rows with the numbers of a good sample in place of those of failed ones: even a number with weight 0
/// must be finite.
fn mended(failures: &Failures, rows: &[Row]) -> Vec<Row> {
    let mut mended = rows.to_vec();
    if let Some(good) = failures.0.iter().position(|failed| !failed) {
        for (sample, _) in failures.0.iter().enumerate().filter(|(_, failed)| **failed) {
            mended.iter_mut().for_each(|row| row.0[sample] = row.0[good]);
        }
    }
    mended
}
