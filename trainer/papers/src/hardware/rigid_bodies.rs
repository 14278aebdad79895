//! Chains of rigid bodies with friction, learned over windows of the training logs alone, as `leastaction train` does.

use super::entries::{Fitted, Training};
use super::grid::STEP;
use super::log::Log;
use super::predictor::{Learned, Motion, Predictor};
use crate::task::TaskError;
use leastaction_core::forces::ControlKind;
use leastaction_learning::config::{
    BodiesConfig, CalibrationConfig, Config, FrictionConfig, FrictionNumberConfig, FrictionNumbers,
    TrainingLoss,
};
use leastaction_learning::data::{Dataset, Rows, Trajectory};
use leastaction_learning::run::{Plan, held_back_error};
use leastaction_learning::windows::Calibrated;
use leastaction_programs::System;
use std::time::Instant;

/// What a chain learns beside its bodies and their viscous friction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Chain {
    /// Dry friction.
    pub dry: bool,
    /// That grows with the load.
    pub load: bool,
    /// From which torques.
    pub torque: Torque,
    /// Zero offsets of the encoders of every training log.
    pub zeros: bool,
}

/// Which torques of a log are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Torque {
    /// As measured, and no more is learned of them.
    Measured,
    /// As commanded, where that is logged, with gain and delay learned.
    Commanded,
    /// Measured or commanded, with gain and delay learned: whichever predicts training logs better that are held back in turn.
    Better,
}

impl Chain {
    /// Learns from the training logs.
    ///
    /// # Errors
    /// Where they are too short, or nothing can be learned from them.
    pub fn fit(self, training: &Training) -> Result<Fitted, TaskError> {
        let clock = Instant::now();
        let commanded = self.is_commanded(training)?;
        let plan = Plan::new(self.config(training), &dataset(&training.logs, commanded))?;
        let trained = plan.train().ok_or("no iteration has a finite loss")?;
        let system = System::new(&*trained.architecture.energies()?);
        let calibrated = trained.calibrated.unwrap_or_default();
        let chain = Fit { learned: Learned::new(&system, trained.best.weights), calibrated, commanded };
        Ok(Fitted {
            predictor: Box::new(chain),
            parameters: plan.learned_parameters(),
            seconds: clock.elapsed().as_secs_f64(),
        })
    }

    /// Whether commanded torques are taken.
    fn is_commanded(self, training: &Training) -> Result<bool, TaskError> {
        let has_commands = training.logs.iter().all(|log| log.commanded.is_some());
        match self.torque {
            Torque::Measured => return Ok(false),
            _ if !has_commands => return Ok(false),
            Torque::Commanded => return Ok(true),
            Torque::Better => {}
        }
        let error = |commanded| -> Result<f64, TaskError> {
            let error = held_back_error(&self.config(training), &dataset(&training.logs, commanded))?;
            Ok(error.unwrap_or(f64::INFINITY).sqrt())
        };
        let (commanded, measured) = (error(true)?, error(false)?);
        (training.tell)(&format!(
            "training logs held back in turn: {commanded:.2e} rad off by commanded torques, {measured:.2e} by measured ones"
        ));
        Ok(commanded <= measured)
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
        let (known, is_late) = (CalibrationConfig::default(), self.torque != Torque::Measured);
        let CalibrationConfig { zero, gain, delay, .. } = CalibrationConfig::LEARNED;
        config.calibration = CalibrationConfig {
            zero: if self.zeros { zero } else { known.zero },
            gain: if is_late { gain } else { known.gain },
            delay: if is_late { delay } else { known.delay },
            ..known
        };
        config.training.loss = Some(TrainingLoss::Windows);
        if training.quick {
            (config.training.warm_up, config.training.iterations) = (3, 3);
        }
        config
    }
}

/// The torques of a log, as commanded or measured.
fn torques(log: &Log, commanded: bool) -> &Rows {
    log.commanded.as_ref().filter(|_| commanded).unwrap_or(&log.measured)
}

fn dataset(logs: &[&Log], commanded: bool) -> Dataset {
    let trajectory = |(id, log): (i64, &&Log)| Trajectory {
        id,
        t0: 0.0,
        q: log.q.clone(),
        v: None,
        a: None,
        u: Some(torques(log, commanded).clone()),
    };
    Dataset {
        n: logs.first().map_or(1, |log| log.joints()),
        h: STEP,
        control: Some(ControlKind::Held),
        trajectories: (0..).zip(logs).map(trajectory).collect(),
    }
}

/// A chain, and the drives as they were learned.
struct Fit {
    learned: Learned,
    calibrated: Calibrated,
    commanded: bool,
}

impl Predictor for Fit {
    fn torques(&self, log: &Log) -> Rows {
        let u = torques(log, self.commanded);
        self.calibrated.forces(u, STEP).unwrap_or_else(|| u.clone())
    }

    fn motion(&self) -> Box<Motion<'_>> {
        self.learned.motion()
    }
}
