//! Rollouts of particles in the measures of LGNN's and CHNN's papers.

use super::record::Measure;
use leastaction_ground_truth::{ExactMotion, IntegrationError, Start, Truss};
use leastaction_learning::evaluate::prediction::Truth;
use leastaction_learning::evaluate::rollouts::{Compared, Rollouts};
use serde::Serialize;

/// Mask for the seed that makes the random stream of starts differ from that of the data.
pub(crate) const UNSEEN: u64 = 0x5eed_0000_0000_0000;
/// Disturbance of the starts with which the floor is computed, m.
const DISTURBANCE: f64 = 1e-8;

/// Errors of rollouts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RolledOut {
    /// Geometric mean over starts and times of the rollout error.
    pub rollout_error: f64,
    /// Geometric mean of the rollout error at the end.
    pub last_rollout_error: f64,
    /// Geometric mean of the energy violation.
    pub energy_violation: f64,
    /// Number of rollouts that could not be followed to the end.
    pub failed: usize,
    /// Rollout error of exact motion from starts that are off by 1e-8 m.
    pub floor_rollout_error: f64,
    /// Energy violation of this motion.
    pub floor_energy_violation: f64,
}

impl RolledOut {
    /// Summarises rollouts beside the exact motion and its floor.
    pub(crate) fn new(
        rollouts: &Rollouts,
        (truth, truss, compared): (&Truth, &Truss, Compared),
        seed: u64,
    ) -> Result<Self, IntegrationError> {
        let [rollout_error, energy_violation] = rollouts.means();
        let [floor_rollout_error, floor_energy_violation] = floor(truth, truss, compared, seed)?;
        let (last_rollout_error, failed) = (rollouts.last(), rollouts.failed);
        Ok(Self {
            rollout_error,
            last_rollout_error,
            energy_violation,
            failed,
            floor_rollout_error,
            floor_energy_violation,
        })
    }

    /// Measures beside the published rollout error and energy violation.
    pub(crate) fn measures(&self, [error, energy]: [Option<f64>; 2]) -> [Measure; 3] {
        [
            Measure::error("rollout error", self.rollout_error, error).over(self.floor_rollout_error),
            Measure::error("… at the end", self.last_rollout_error, None),
            Measure::error("energy violation", self.energy_violation, energy)
                .over(self.floor_energy_violation),
        ]
    }

    /// Remark on the rollouts that failed; `None` if there are none.
    pub(crate) fn failures(&self) -> Option<String> {
        let failed = Some(self.failed).filter(|failed| *failed > 0);
        failed.map(|failed| format!("{failed} rollouts could not be followed to the end"))
    }
}

/// Errors of exact motion from disturbed starts, treated as a prediction.
fn floor(truth: &Truth, truss: &Truss, compared: Compared, seed: u64) -> Result<[f64; 2], IntegrationError> {
    let sign = |k: usize| if (seed >> (k % 64)) & 1 == 0 { DISTURBANCE } else { -DISTURBANCE };
    let disturbed = |start: &Start| {
        let mut state: Vec<f64> = start.q.iter().enumerate().map(|(k, q)| q + sign(k)).collect();
        state.extend(&start.v);
        truss.project(&mut state);
        let v = state.split_off(start.q.len());
        Start { q: state, v }
    };
    let starts = truth.starts().iter().map(disturbed).collect();
    let other = Truth::new(truss, starts, truth.horizon())?;
    Ok(Rollouts::between(truth, &other, truss, compared).means())
}
