//! Evaluation of a model on logged motion.

mod joint_bag;
mod long_term;
mod on_chip;
mod page;
mod reading;
mod report;

pub use joint_bag::write as write_joint_bag;
pub use long_term::{LongTerm, Request as LongTermRequest, Scalable};
pub use page::{is_page, write as write_page};
pub use reading::LogReading;
pub use report::{Acceleration, Report, Steps, Torques};

use crate::cli::Failure;
use crate::models::{chip_file, meant};
use leastaction_core::discrete::Order;
use leastaction_core::forces::ControlKind;
use leastaction_core::model::ModelError;
use leastaction_ground_truth::Mechanism;
use leastaction_learning::config::TrainingConfig;
use leastaction_learning::data::{Dataset, control_name};
use leastaction_learning::evaluate::{acceleration_mse, energy_mse, finished, inertia_mse, one_step_mse};
use leastaction_learning::torque_numbers::torque_numbers;
use leastaction_learning::torques::{TorqueErrors, torque_errors};
use leastaction_models::{Beginning, Model};
use std::path::{Path, PathBuf};

/// Receives messages, each a sentence.
pub type Tell<'t> = &'t mut dyn FnMut(String);

/// A model to evaluate.
pub struct Evaluation<'a> {
    /// File of the model.
    pub file: &'a Path,
    /// The model.
    pub model: &'a Model,
    /// Order of the steps; by default the model's, or 4.
    pub order: Option<u8>,
    /// Control kind; by default as the log says, or as in training.
    pub control: Option<ControlKind>,
}

/// A log that a model is evaluated on.
pub struct Log {
    /// File of the log.
    pub file: PathBuf,
    /// Contents of the log.
    pub data: Dataset,
    /// Names of the coordinates in the log; empty if they have none but q0, q1, …
    pub names: Vec<String>,
}

impl Evaluation<'_> {
    /// Reads a log; reports what the user should know about it.
    ///
    /// # Errors
    /// [`Failure::Input`] if the log cannot be read, or belongs to another mechanism.
    pub fn read(&self, reading: &LogReading, tell: Tell) -> Result<Log, Failure> {
        let trained = self.model.facts.trained_step.map(|step| step.control);
        let mut data = reading.read((self.control, trained), tell)?;
        let file = reading.file();
        self.check((&file, &data), tell)?;
        self.take_control((&file, &mut data), tell)?;
        prepare(&mut data, &self.model.architecture.coordinates(), tell);
        Ok(Log { file, data, names: reading.names() })
    }

    /// Measures the model on a log, and compares it with an exact mechanism if one is given; reports what could not be measured.
    ///
    /// # Errors
    /// [`Failure::Input`] if the shape of the model is inconsistent.
    pub fn measure(&self, log: &Log, mechanism: Option<Mechanism>, tell: Tell) -> Result<Report, Failure> {
        if mechanism.is_some() && log.data.is_forced() {
            tell("the log is forced, so that its energy changes: energy is not compared".to_owned());
        }
        let report = self.report((log.file.clone(), &log.data), mechanism);
        let mut report = report.map_err(|error| Failure::input(self.file, error))?;
        report.chip = on_chip(self.model, report.order, &log.data)
            .map_err(|error| tell(format!("steps on the chip are not measured: {error}")))
            .ok();
        if report.steps.is_none() {
            tell("on rods, positions are stepped on the chip alone".to_owned());
        }
        Ok(report)
    }

    fn check(&self, (file, log): (&Path, &Dataset), tell: Tell) -> Result<(), Failure> {
        let model = self.model;
        let n = model.architecture.n();
        if log.n != n {
            let message = match model.architecture.part() {
                None => format!("q has {} coordinates, the model {n}", log.n),
                Some((what, name)) => {
                    format!(
                        "q has {} coordinates, {what} {name:?} {n}; name the {what} of the log with --{what}",
                        log.n
                    )
                }
            };
            return Err(Failure::input(file, message));
        }
        if let Some(trained) =
            model.facts.trained_step.filter(|d| (f64::from(d.h) - log.h).abs() > 1e-6 * log.h)
        {
            tell(format!(
                "the model was trained for a step of {} s and is evaluated at {} s, where it is less accurate",
                trained.h, log.h
            ));
        }
        Ok(())
    }

    /// Decides the control kind, and reports if the model was trained for another one.
    fn take_control(&self, (file, log): (&Path, &mut Dataset), tell: Tell) -> Result<(), Failure> {
        let trained = self.model.facts.trained_step.map(|step| step.control);
        if let Some(asked) = self.control {
            log.set_control(asked).map_err(|stated| {
                let (asked, stated) = (control_name(asked), control_name(stated));
                let message =
                    format!("--control {asked}: the log says that its u is {stated} between samples");
                Failure::input(file, message)
            })?;
        }
        let kind = log.control_kind();
        log.control = Some(kind);
        if let Some(trained) = trained.filter(|trained| *trained != kind && log.control_changes()) {
            let (trained, kind) = (control_name(trained), control_name(kind));
            tell(format!(
                "the model was trained with a control that is {trained} between samples and is evaluated with one that is {kind}"
            ));
        }
        Ok(())
    }

    fn report(
        &self,
        (data, log): (PathBuf, &Dataset),
        system: Option<Mechanism>,
    ) -> Result<Report, ModelError> {
        let model = self.model;
        let architecture = &model.architecture;
        let order = self.order.or(model.facts.trained_step.map(|step| step.order.number())).unwrap_or(4);
        // Under a force even the true energy changes, but the measure compares it with its first value.
        let free = system.filter(|_| !log.is_forced());
        let steps = || steps(model, order, log, free);
        let inertia = |system| inertia_mse(model, system, log);
        let part = |what| {
            let (_, name) = architecture.part().filter(|(of, _)| *of == what)?;
            Some(name.to_owned())
        };
        let acceleration = acceleration_mse(model, log)?;
        Ok(Report {
            model: self.file.to_owned(),
            data,
            tree: part("tree"),
            graph: part("graph"),
            order,
            h: log.h,
            control: log.control_changes().then(|| control_name(log.control_kind())),
            trajectories: log.trajectories.len(),
            samples: log.samples(),
            acceleration: acceleration.map(|(solved, square)| Acceleration {
                acceleration_mse: solved.mean_square,
                acceleration_relative: solved.mean_square.map(|error| error / square),
                acceleration_unsolved: solved.unsolved,
            }),
            torques: torques(model, log),
            steps: architecture.has_steps().then(steps).transpose()?,
            chip: None,
            inertia_mse: system.map(inertia).transpose()?,
            prediction: None,
        })
    }
}

/// Errors of steps in the chip's arithmetic; an error message if core is not compiled for the model's size.
fn on_chip(model: &Model, order: u8, log: &Dataset) -> Result<Steps, String> {
    let order = Order::from_number(order).ok_or("there is no such order")?;
    let file = chip_file(model)?;
    let measured = on_chip::steps(&meant(&file, model)?, order, log);
    measured.map_err(|error| error.to_string())
}

/// Measures steps, and energies if a mechanism is given to compare with.
fn steps(model: &Model, order: u8, log: &Dataset, mechanism: Option<Mechanism>) -> Result<Steps, ModelError> {
    let one_step = one_step_mse(model, order, log)?;
    let (runs, motions) = finished(&model.rollout(order, (log, Beginning::Velocity))?, log);
    let energy = mechanism.filter(|_| !runs.is_empty()).map(|system| energy_mse(system, &runs, &motions));
    let steps = Steps::new(one_step, (&runs, &motions), log.trajectories.len());
    Ok(Steps { energy_mse: energy, ..steps })
}

/// Unwraps angles, and reports doubts about the log.
fn prepare(log: &mut Dataset, letters: &str, tell: Tell) {
    log.unwrap_angles(letters).iter().for_each(|seams| tell(seams.to_string()));
    log.doubts(letters).iter().for_each(|doubt| tell(doubt.to_string()));
}

/// Torque errors, and estimates for an arm from the torques alone; motion and torques are filtered as training does by default.
pub fn torques(model: &Model, log: &Dataset) -> Option<Torques> {
    let cut_off = TrainingConfig::default().cut_off;
    let TorqueErrors { nmse, rmse, .. } = torque_errors(model, log, cut_off)?;
    let torque_numbers = torque_numbers(model, log, cut_off);
    Some(Torques { torque_nmse: nmse, torque_rmse: rmse, torque_numbers })
}
