//! Starts from which a model is judged, with the exact motion from them.

use super::{Compared, Experiment, Outcome, ReproduceError, RolledOut, insight};
use leastaction_core::particles::Particles;
use leastaction_ground_truth::{
    ExactMotion, GenerationError, Horizon, IntegrationError, LgnnSettings, LgnnSystem, Start, Truss,
    lgnn_starts,
};
use leastaction_learning::evaluate::prediction::Truth;
use leastaction_learning::evaluate::rollouts::{Compared as What, Rollouts};
use leastaction_models::particles::Driven;

/// Mask that makes the random stream of rollout starts differ from that of the data.
const UNSEEN: u64 = 0x5eed_0000_0000_0000;
/// Disturbance of the starts for the floor, m.
const DISTURBANCE: f64 = 1e-8;
/// Maximum number of nodes of all starts together, and minimum number of starts: large systems need fewer.
const MOST_NODES: usize = 10_000;
const FEWEST_STARTS: usize = 4;

/// A system with its exact motions.
pub(super) struct Trial {
    system: LgnnSystem,
    truss: Truss,
    truth: Truth,
    seed: u64,
}

impl Experiment<'_> {
    /// Creates the trial of a system under the drag and the pull of a row.
    pub(super) fn trial(&self, row: &Outcome, system: LgnnSystem) -> Result<Trial, ReproduceError> {
        (self.tell)(&format!("rolling out on {} of {}", system.name(), system.nodes()));
        let seed = self.options.seed ^ UNSEEN;
        let trajectories = self.options.starts.min((MOST_NODES / system.nodes()).max(FEWEST_STARTS));
        let (drag, pull) = (row.drag, row.pull);
        let settings = LgnnSettings { drag, pull, trajectories, ..LgnnSettings::published(system, seed) };
        let truss = settings.truss().map_err(GenerationError::from)?;
        let truth = Truth::new(&truss, lgnn_starts(&settings), horizon(system))?;
        Ok(Trial { system, truss, truth, seed })
    }
}

impl Trial {
    /// Force on every coordinate, N; empty if there is none.
    pub fn pull(&self) -> Vec<f64> {
        if self.truss.pulls.is_empty() { Vec::new() } else { self.truss.pull().into_flattened() }
    }

    /// Rolls out accelerations v̇(q, v).
    pub fn roll_out(
        &self,
        tolerance: f64,
        acceleration: impl Fn(&[f64], &[f64], &mut [f64]) -> Option<()> + Sync,
    ) -> Rollouts {
        Rollouts::new(&self.truth, &self.truss, What::Positions, tolerance, acceleration)
    }

    /// Pulls of the rods along the first motion.
    pub fn pulls<P: Particles<f64, 2>>(&self, driven: &Driven<'_, P, 2>, u: &[f64]) -> Vec<Compared> {
        insight::pulls(driven, u, &self.truss, self.truth.first(), self.truth.horizon().h)
    }

    /// Completes a row with these rollouts.
    pub fn judged(&self, row: Outcome, rollouts: Rollouts) -> Result<Outcome, ReproduceError> {
        let horizon = self.truth.horizon();
        let [floor_rollout_error, floor_energy_violation] =
            floor(&self.truth, &self.truss, What::Positions, self.seed)?;
        let [rollout_error, energy_violation] = rollouts.means();
        let rolled_out = RolledOut {
            rollout_seconds: horizon.h * (horizon.samples - 1) as f64,
            starts: self.truth.starts().len(),
            rollout_error,
            last_rollout_error: rollouts.last(),
            energy_violation,
            failed: rollouts.failed,
            floor_rollout_error,
            floor_energy_violation,
        };
        let (system, count) = (self.system.name(), self.system.nodes());
        let pictured = Some((horizon.h, rollouts));
        Ok(Outcome { system, count, rolled_out: Some(rolled_out), pictured, ..row })
    }

    /// Exact motion of the system.
    pub fn motion(&self) -> &dyn ExactMotion {
        &self.truss
    }
}

/// Horizon of the authors' tests: 10 s for systems with rods, 20 s for springs.
fn horizon(system: LgnnSystem) -> Horizon {
    let (h, seconds) = if system.rods().is_empty() { (0.1, 20.0) } else { (0.05, 10.0) };
    Horizon { h, samples: (seconds / h) as usize + 1 }
}

/// Errors of exact motion from disturbed starts, taken as a prediction.
pub(crate) fn floor(
    truth: &Truth,
    truss: &Truss,
    compared: What,
    seed: u64,
) -> Result<[f64; 2], IntegrationError> {
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
