//! Starts with which a model is tested, and the exact motion from them.

use super::{Compared, Experiment, Outcome, insight};
use crate::rollouts::{RolledOut, UNSEEN};
use crate::task::TaskError;
use leastaction_core::particles::Particles;
use leastaction_ground_truth::{GenerationError, Horizon, LgnnSettings, LgnnSystem, Truss, lgnn_starts};
use leastaction_learning::evaluate::prediction::Truth;
use leastaction_learning::evaluate::rollouts::{Compared as What, Rollouts};
use leastaction_models::particles::Driven;

/// Maximum number of nodes of all starts together: large systems need fewer starts.
const MOST_NODES: usize = 10_000;
/// Minimum number of starts.
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
    pub(super) fn trial(&self, row: &Outcome, system: LgnnSystem) -> Result<Trial, TaskError> {
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
    pub fn judged(&self, row: Outcome, rollouts: Rollouts) -> Result<Outcome, TaskError> {
        let (horizon, truth) = (self.truth.horizon(), (&self.truth, &self.truss, What::Positions));
        let rolled_out = Some(RolledOut::new(&rollouts, truth, self.seed)?);
        Ok(Outcome {
            system: self.system.name(),
            count: self.system.nodes(),
            rollout_seconds: horizon.h * (horizon.samples - 1) as f64,
            starts: self.truth.starts().len(),
            rolled_out,
            pictured: Some((horizon.h, rollouts)),
            ..row
        })
    }
}

/// Horizon of the authors' tests: 10 s for systems with rods, 20 s for springs.
fn horizon(system: LgnnSystem) -> Horizon {
    let (h, seconds) = if system.rods().is_empty() { (0.1, 20.0) } else { (0.05, 10.0) };
    Horizon { h, samples: (seconds / h) as usize + 1 }
}
