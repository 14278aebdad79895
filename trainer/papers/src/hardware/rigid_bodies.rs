//! Chains of rigid bodies with friction, learned over windows of the training logs alone, as `leastaction train` does.

use super::entries::{Fitted, Training};
use super::grid::STEP;
use super::log::Log;
use super::predictor::{Learned, Motion, Predictor};
use crate::task::TaskError;
use leastaction_core::forces::ControlKind;
use leastaction_learning::config::{
    BodiesConfig, CalibrationConfig, Config, FrictionConfig, FrictionNumberConfig, FrictionNumbers,
};
use leastaction_learning::data::{Dataset, Rows, Trajectory};
use leastaction_learning::run::Plan;
use leastaction_learning::windows::Calibrated;
use leastaction_programs::System;
use std::time::Instant;

/// What a chain learns beside its bodies and their viscous friction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Chain {
    /// Dry friction.
    pub dry: bool,
    /// That grows with the load.
    pub load: bool,
    /// Commanded torque in place of the measured one, where it is logged; of it gain and delay.
    pub commanded: bool,
    /// Zero offsets of the encoders of every training log.
    pub zeros: bool,
}

impl Chain {
    /// Learns from the training logs.
    ///
    /// # Errors
    /// Where they are too short, or nothing can be learned from them.
    pub fn fit(self, training: &Training) -> Result<Fitted, TaskError> {
        let clock = Instant::now();
        let plan = Plan::new(self.config(training), &self.dataset(&training.logs))?;
        let trained = plan.train().ok_or("no iteration has a finite loss")?;
        let system = System::new(&*trained.architecture.energies()?);
        let calibrated = trained.calibrated.unwrap_or_default();
        let chain = Fit { learned: Learned::new(&system, trained.best.weights), calibrated, kind: self };
        Ok(Fitted {
            predictor: Box::new(chain),
            parameters: plan.learned_parameters(),
            seconds: clock.elapsed().as_secs_f64(),
        })
    }

    fn config(self, training: &Training) -> Config {
        let learned = |is: bool| is.then_some(FrictionNumbers::All(FrictionNumberConfig::Learned));
        let friction = FrictionConfig {
            viscous: learned(true),
            coulomb: learned(self.dry),
            load: learned(self.load),
            ..FrictionConfig::default()
        };
        let chain = BodiesConfig { friction, ..BodiesConfig::chain(training.machine.joints()) };
        let mut config = Config::new("", chain);
        config.data.validation = 0.0;
        let known = CalibrationConfig::default();
        let CalibrationConfig { zero, gain, delay, .. } = CalibrationConfig::LEARNED;
        config.calibration = CalibrationConfig {
            zero: if self.zeros { zero } else { known.zero },
            gain: if self.commanded { gain } else { known.gain },
            delay: if self.commanded { delay } else { known.delay },
            ..known
        };
        config.training.loss = Some(leastaction_learning::config::TrainingLoss::Windows);
        if training.quick {
            (config.training.warm_up, config.training.iterations) = (3, 3);
        }
        config
    }

    /// The torques of a log that it takes.
    fn torques(self, log: &Log) -> &Rows {
        log.commanded.as_ref().filter(|_| self.commanded).unwrap_or(&log.measured)
    }

    fn dataset(self, logs: &[&Log]) -> Dataset {
        let trajectory = |(id, log): (i64, &&Log)| Trajectory {
            id,
            t0: 0.0,
            q: log.q.clone(),
            v: None,
            a: None,
            u: Some(self.torques(log).clone()),
        };
        Dataset {
            n: logs.first().map_or(1, |log| log.joints()),
            h: STEP,
            control: Some(ControlKind::Held),
            trajectories: (0..).zip(logs).map(trajectory).collect(),
        }
    }
}

/// A chain, and the drives as they were learned.
struct Fit {
    learned: Learned,
    calibrated: Calibrated,
    kind: Chain,
}

impl Predictor for Fit {
    fn torques(&self, log: &Log) -> Rows {
        let u = self.kind.torques(log);
        self.calibrated.forces(u, STEP).unwrap_or_else(|| u.clone())
    }

    fn motion(&self) -> Box<Motion<'_>> {
        self.learned.motion()
    }
}
