//! `leastaction evaluate`.

use super::Done;
use super::arguments::order;
use super::inspect::load;
use super::output::{Failure, Output};
use clap::Args;
use leastaction::data::{self, Dataset};
use leastaction::evaluate::{energy_mse, inertia_mse, integration_errors, one_step_mse, rollout};
use leastaction::ground_truth::Mechanism;
use leastaction::model_file::HostModel;
use leastaction_core::model::ModelError;
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;

/// Measure a model on logged motion.
///
/// One step ahead, and over whole trajectories from their first two positions, under the logged control. Velocities in the
/// log are not read, but for the initial energy with --system.
///
/// Example: leastaction evaluate m.postcard --data log.npz
#[derive(Args)]
pub struct Evaluate {
    /// The model file.
    model: PathBuf,
    /// The log, .npz or .csv.
    #[arg(long, value_name = "FILE")]
    data: PathBuf,
    /// Order of the steps, 2 or 4 [default: that of the model, else 4].
    #[arg(long, value_parser = order)]
    order: Option<u8>,
    /// Also compare inertia and, over motion without force, energy with this exact mechanism.
    #[arg(long)]
    system: Option<Mechanism>,
}

/// The measures.
#[derive(Serialize)]
struct Report {
    model: PathBuf,
    data: PathBuf,
    order: u8,
    h: f64,
    trajectories: usize,
    samples: usize,
    one_step_mse: f64,
    rollout_mse: f64,
    rollout_median: f64,
    rollout_mse_100: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    energy_mse: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    inertia_mse: Option<f64>,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { trajectories, samples, order, h, .. } = self;
        writeln!(
            f,
            "{trajectories} trajectories, {samples} samples; order {order}, step {h} s; mean squared errors"
        )?;
        let rows = [
            ("position, one step ahead", Some(self.one_step_mse)),
            ("position, whole trajectories", Some(self.rollout_mse)),
            ("  median over trajectories", Some(self.rollout_median)),
            ("  first 100 steps", Some(self.rollout_mse_100)),
            ("energy along them (J²)", self.energy_mse),
            ("inertia matrix", self.inertia_mse),
        ];
        let present = rows.iter().filter_map(|(name, value)| Some((name, (*value)?)));
        present.into_iter().try_for_each(|(name, value)| writeln!(f, "{name:<30} {value:.3e}"))
    }
}

impl Evaluate {
    /// Reads and measures.
    pub fn run(self, output: Output) -> Done {
        let (model, _) = load(&self.model)?;
        let (log, notes) = data::read(&self.data).map_err(|error| Failure::Input(error.to_string()))?;
        notes.iter().for_each(|note| output.note(&format!("note: {note}")));
        self.check(&model, &log, output)?;
        let report = self.measure(&model, &log).map_err(|error| Failure::input(&self.model, error))?;
        output.report(&report)
    }

    fn check(&self, model: &HostModel, log: &Dataset, output: Output) -> Done {
        let n = model.architecture.n();
        if log.n != n {
            return Err(Failure::input(&self.data, format!("q has {} coordinates, the model {n}", log.n)));
        }
        if let Some(system) = self.system.filter(|system| system.coordinates().len() != n) {
            return Err(Failure::Input(format!("--system {}: the model has {n} coordinates", system.name())));
        }
        if self.system.is_some() && log.is_forced() {
            output.note("note: the log is forced, so that its energy changes: energy is not compared");
        }
        if let Some(trained) = model.discretisation.filter(|d| (f64::from(d.h) - log.h).abs() > 1e-6 * log.h)
        {
            output.note(&format!(
                "note: the model was trained for a step of {} s and is evaluated at {} s, where it is less accurate",
                trained.h, log.h
            ));
        }
        Ok(())
    }

    fn measure(&self, model: &HostModel, log: &Dataset) -> Result<Report, ModelError> {
        let (architecture, weights) = (&model.architecture, &model.weights);
        let order = self.order.or(model.discretisation.map(|d| d.order)).unwrap_or(4);
        let runs = rollout(architecture, weights, order, log)?;
        let errors = integration_errors(&runs, log);
        let inertia = |system| inertia_mse(architecture, weights, system, log);
        Ok(Report {
            model: self.model.clone(),
            data: self.data.clone(),
            order,
            h: log.h,
            trajectories: log.trajectories.len(),
            samples: log.samples(),
            one_step_mse: one_step_mse(architecture, weights, order, log)?,
            rollout_mse: errors.mean,
            rollout_median: errors.median,
            rollout_mse_100: errors.first_100,
            // Under a force even the true energy does not keep its first value, which the measure compares with.
            energy_mse: self.system.filter(|_| !log.is_forced()).map(|system| energy_mse(system, &runs, log)),
            inertia_mse: self.system.map(inertia).transpose()?,
        })
    }
}
