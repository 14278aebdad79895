//! Models that `leastaction train` learns with a configuration, directly from the files of the training logs.

use super::entries::{Fitted, Training};
use super::grid::STEP;
use super::log::Log;
use super::predictor::{Learned, Predict, Predictor};
use crate::task::{TaskError, Tell};
use leastaction::look::Look;
use leastaction_core::forces::ControlKind;
use leastaction_learning::checkpoint::Trained;
use leastaction_learning::config::Config;
use leastaction_learning::data::{Column, Rows};
use leastaction_learning::run::{Chosen, Monitor, Plan, Row, Run, choose};
use leastaction_learning::windows::{Calibrated, Shown};
use leastaction_programs::System;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// Trains with the configuration that `leastaction look` writes for the training logs.
pub(super) fn default(training: &Training) -> Result<Fitted, TaskError> {
    let files: Vec<PathBuf> = training.logs.iter().map(|log| log.file.clone()).collect();
    let folder = tempfile::tempdir()?;
    let proposal = Look::at(&files)?.configuration(&folder.path().join("machine.toml"))?;
    train(&proposal.text, training, folder.path())
}

/// Terms of a chain of rigid bodies beside viscous friction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Chain {
    /// Dry friction.
    pub dry: bool,
    /// Whether the commanded torque is used, with learned gain and delay, if it is logged; otherwise the measured
    /// torque.
    pub commanded: bool,
    /// Dry friction that grows with the load.
    pub load: bool,
}

impl Chain {
    /// Learns the chain over windows.
    pub fn fit(self, training: &Training) -> Result<Fitted, TaskError> {
        let folder = tempfile::tempdir()?;
        train(&chain(training, self), training, folder.path())
    }
}

/// Returns the configuration of a chain.
fn chain(training: &Training, kind: Chain) -> String {
    let (columns, joints) = (training.machine.columns(), training.machine.joints());
    let names = |columns: &[Column]| listed(columns.iter().take(joints).map(|column| column.name.clone()));
    let commanded = kind.commanded && training.machine.logs_commands();
    let files = listed(training.logs.iter().map(|log| full(&log.file).display().to_string()));
    let (t, q) = (&columns.t.name, names(&columns.q));
    let u = names(if commanded { &columns.u[joints..] } else { &columns.u });
    let given = |is_given: bool, text: &'static str| if is_given { text } else { "" };
    let coulomb = given(kind.dry, "coulomb = \"learned\"\n");
    let load = given(kind.load, "load = \"learned\"\n");
    let calibration = given(kind.commanded, "\n[calibration]\ngain = \"learned\"\ndelay = \"learned\"\n");
    format!(
        "[data]\nfile = {files}\nstep = {STEP}\nvalidation = 0.0\n\n\
         [data.columns]\nt = \"{t}\"\nq = {q}\nu = {u}\n\n\
         [model]\nfamily = \"bodies\"\nchain = {joints}\n\n\
         [model.friction]\nviscous = \"learned\"\n{coulomb}{load}{calibration}\n\
         [training]\nloss = \"windows\"\n"
    )
}

/// Returns the names as a TOML list, whose strings are written like those of JSON.
fn listed(names: impl Iterator<Item = String>) -> String {
    serde_json::Value::from(names.collect::<Vec<_>>()).to_string()
}

/// Returns the absolute path of a file.
pub(super) fn full(file: &Path) -> PathBuf {
    std::path::absolute(file).unwrap_or_else(|_| file.to_owned())
}

/// Trains in a temporary folder.
fn train(text: &str, training: &Training, folder: &Path) -> Result<Fitted, TaskError> {
    let mut config = Config::parse(text, &folder.join("machine.toml"))?;
    config.training.seed = training.seed;
    let end = trained(config, (folder, training.quick), training.tell)?;
    let is_commanded = is_commanded(&end.config, training)?;
    let Trained { architecture, best, calibrated, .. } = end.trained;
    let system = System::new(&*architecture.energies()?);
    let learned = Learned::new(&system, best.weights);
    let predictor = Driven { learned, calibrated: calibrated.unwrap_or_default(), is_commanded };
    Ok(Fitted { predictor: Box::new(predictor), parameters: end.parameters, seconds: end.seconds })
}

/// End of a training.
pub struct End {
    /// The configuration with all choices.
    pub config: Config,
    /// The model.
    pub trained: Trained,
    /// Number of learned parameters.
    pub parameters: usize,
    /// Positions of the numbers that the logs leave free, alone or together with others.
    pub free: Vec<usize>,
    /// Training time, s.
    pub seconds: f64,
}

/// Trains as `leastaction train` does, with choices of its own, in a folder.
pub fn trained(mut config: Config, (folder, quick): (&Path, bool), tell: &Tell) -> Result<End, TaskError> {
    if quick {
        config.training.iterations = config.training.iterations.min(QUICK);
    }
    let clock = Instant::now();
    let Chosen { config, data, choices, .. } = choose(config)?;
    choices.sentences().iter().for_each(|sentence| tell(sentence));
    let plan = Plan::new(config.clone(), &data)?;
    let (parameters, folder) = (plan.learned_parameters(), folder.join("run"));
    let mut run = Run::begin(plan, &folder, false)?;
    run.train(&mut Told(tell), &AtomicBool::new(false))?;
    let (trained, seconds) = (Trained::read(&folder)?, clock.elapsed().as_secs_f64());
    let certainty = run.certainty().map_or(Vec::new(), |certainty| certainty.numbers);
    let free = certainty.into_iter().filter(|number| number.shown == Shown::Together);
    Ok(End { config, trained, parameters, free: free.map(|number| number.position).collect(), seconds })
}

/// Maximum number of iterations for a first look.
const QUICK: u64 = 10;

/// Whether a configuration reads the commanded torque instead of the measured one.
fn is_commanded(config: &Config, training: &Training) -> Result<bool, TaskError> {
    let read = config.data.reading().columns.map_or(Vec::new(), |columns| columns.u);
    let known = training.machine.columns().u;
    let (measured, commanded) = known.split_at(training.machine.joints());
    match &read[..] {
        read if read == measured => Ok(false),
        read if read == commanded => Ok(true),
        _ => Err("the configuration reads other torques than those of this machine".into()),
    }
}

/// Reports progress every ten iterations.
struct Told<'t>(&'t Tell<'t>);

impl Monitor for Told<'_> {
    fn row(&mut self, row: &Row) {
        if row.iteration.is_multiple_of(10) {
            let held_back = row.validation.map_or(String::new(), |loss| format!(", held back {loss:.2e}"));
            (self.0)(&format!(
                "{}, iteration {}: loss {:.2e}{held_back}",
                row.stage, row.iteration, row.train
            ));
        }
    }

    fn warning(&mut self, message: &str) {
        (self.0)(message);
    }
}

/// Learned energies and forces under the torques of drives with learned gain, offset and delay.
struct Driven {
    learned: Learned,
    calibrated: Calibrated,
    is_commanded: bool,
}

impl Predictor for Driven {
    fn torques(&self, log: &Log) -> Rows {
        let all = log.commanded.as_ref().filter(|_| self.is_commanded).unwrap_or(&log.measured);
        self.calibrated.forces(all, (STEP, ControlKind::Held)).unwrap_or_else(|| all.clone())
    }

    fn motion(&self) -> Box<Predict<'_>> {
        self.learned.motion()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use leastaction_core::energy::inertia_network::Coordinate;
    use leastaction_models::{Actuator, Architecture, InertiaNetworkArchitecture};

    #[test]
    fn torques_are_those_of_the_drive_a_delay_ago() {
        let rows = |scale: f64| Rows::from_rows(1, (0..6).map(|k| [scale * f64::from(k * k)])).unwrap();
        let log = Log {
            file: "log.csv".into(),
            q: rows(0.0),
            v: rows(0.0),
            measured: rows(100.0),
            commanded: Some(rows(1.0)),
        };
        let architecture: Architecture = InertiaNetworkArchitecture::new(&[Coordinate::Angle], 2).into();
        let system = System::new(&*architecture.energies().unwrap());
        let calibrated = Calibrated {
            actuator: Actuator { gain: vec![2.0], offset: vec![0.5], delay: 1.25 * STEP, lag: 0.0 },
            zeros: Vec::new(),
        };
        let learned = Learned::new(&system, architecture.initial_weights(0));
        let driven = Driven { learned, calibrated, is_commanded: true };
        let found = driven.torques(&log);
        let u = |k: f64| 0.75 * (k - 1.0) * (k - 1.0) + 0.25 * (k - 2.0) * (k - 2.0);
        for k in 2..6 {
            assert!((found[k][0] - (2.0 * u(k as f64) + 0.5)).abs() < 1e-12, "{k}");
        }
        assert_eq!(found[0], [0.5]);
    }
}
