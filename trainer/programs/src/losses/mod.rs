//! Residuals of samples and their derivatives in the weights.
//!
//! By the chain rule through an implicit step the derivative of every residual component in θ is a sum of
//! ∂/∂θ \[F·δq + L_v·δv\] over the Gauss points of the intervals involved, or the points of a chain of
//! RATTLE steps; the implicit function theorem only chooses δq and δv. That of an acceleration is ∂/∂θ (F − d/dt L_v)·y. Programs
//! of a system do the rest.

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
    /// (q₋, q, q₊) of the discrete losses; (q, v, v̇) of the losses of accelerations and torques.
    pub states: [Vec<Row>; 3],
    /// v₊, of the loss of the next state.
    pub next_velocity: Vec<Row>,
    /// Controls at the same times: of the loss of the next state u and u₊ are the first two, of those of accelerations and torques u is the first.
    pub controls: [Vec<Row>; 3],
    /// What they do between these times.
    pub control: ControlKind,
}

impl Block {
    /// The control at the start and at the end of the first step, 0, or the second, 1; linear between.
    fn acting(&self, step: usize) -> [&[Row]; 2] {
        let end = match self.control {
            ControlKind::Held => step,
            ControlKind::Linear => step + 1,
        };
        [&self.controls[step], &self.controls[end]]
    }
}

/// What is differentiated.
pub enum Derivatives<'r> {
    /// Nothing.
    None,
    /// Every residual component in every weight: a row a component.
    Jacobian(&'r mut [Vec<Row>]),
    /// ½Σ r², in every weight.
    Gradient(&'r mut Vec<Row>),
}

/// A residual of every sample, with the workspace to compute it in.
pub trait Loss: Send {
    /// Residual components of a sample.
    fn components(&self) -> usize;
    /// Writes the residuals, a row a component, and adds their derivatives. Samples that cannot be computed have residual and
    /// derivatives 0.
    fn evaluate(
        &mut self,
        weights: &[f64],
        block: &Block,
        residual: &mut [Row],
        derivatives: Derivatives,
    ) -> Failures;
    /// The residual that stands for a sample that cannot be computed: that of a constant velocity. None where there is no such
    /// thing, of a residual of momenta.
    fn of_constant_velocity(&self, block: &Block) -> Option<Vec<Row>>;
}

/// q + (q − q₋) − q₊.
fn straight_on([before, now, next]: &[Vec<Row>; 3]) -> Vec<Row> {
    let rows = before.iter().zip(now).zip(next);
    rows.map(|((before, now), next)| {
        now.zip(before, |q, before| 2.0 * q - before).zip(next, |q, next| q - next)
    })
    .collect()
}

/// 0 in the samples that failed.
fn clear(failures: &Failures, rows: &mut [Row]) {
    for (sample, _) in failures.0.iter().enumerate().filter(|(_, failed)| **failed) {
        rows.iter_mut().for_each(|row| row.0[sample] = 0.0);
    }
}

/// These rows with the numbers of a sample that did not fail in place of those that did: what is weighed by 0 must be finite.
fn mended(failures: &Failures, rows: &[Row]) -> Vec<Row> {
    let mut mended = rows.to_vec();
    if let Some(good) = failures.0.iter().position(|failed| !failed) {
        for (sample, _) in failures.0.iter().enumerate().filter(|(_, failed)| **failed) {
            mended.iter_mut().for_each(|row| row.0[sample] = row.0[good]);
        }
    }
    mended
}
