//! Results of a run in the loop.

use super::adapting::AdaptiveReport;
use super::changes::{Carried, FrictionDrift};
use super::follow::PlanReport;
use super::gravity::FloatingReport;
use super::mpc::DecidedReport;
use super::{Plant, Request, Scenario};
use leastaction::cli::{Done, Failure};
use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_firmware_sim::{Incidents, Summary};
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;

/// Results of a run.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// The model file.
    pub model: PathBuf,
    /// Scenario of the loop.
    pub scenario: Scenario,
    /// Name of the plant.
    pub system: String,
    /// Units of positions and of forces.
    #[serde(skip)]
    units: [String; 2],
    /// Seed of all noise.
    pub seed: u64,
    /// Loads that the mechanism carried.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    carried: Vec<Carried>,
    /// Growth of the mechanism's friction.
    #[serde(skip_serializing_if = "Option::is_none")]
    friction_drift: Option<FrictionDrift>,
    /// Processor that ran the controller.
    pub processor: String,
    /// Median and largest number of instructions in a tick, if they are counted.
    pub tick_instructions: Option<[u32; 2]>,
    /// Whether the goal was reached.
    pub success: bool,
    /// Number of ticks.
    pub ticks: u32,
    /// Time from which the error stayed within the tolerance, s.
    pub settled_at: Option<f32>,
    /// Largest |q|.
    pub max_q: Vec<f32>,
    /// Largest |error|.
    pub max_error: Vec<f32>,
    /// Root mean square of the error.
    pub rms_error: Vec<f32>,
    /// Root mean square of estimated minus true position.
    pub rms_estimate_q: Vec<f32>,
    /// Root mean square of estimated minus true velocity.
    pub rms_estimate_v: Vec<f32>,
    /// Largest |force|.
    pub max_force: Vec<f32>,
    /// Largest number of Newton iterations in a step.
    pub newton_iterations: u8,
    /// Largest relative residual of an accepted step.
    pub newton_residual: f32,
    /// Number of dropped encoder readings.
    pub dropped: u32,
    /// Number of late ticks.
    pub late: u32,
    /// Number of missed ticks.
    pub missed: u32,
    /// Number of errors of the model.
    pub model_errors: u32,
    /// Result of floating, in the scenario gravity.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub floating: Option<FloatingReport>,
    /// Result of following a plan, in the scenario follow.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub planned: Option<PlanReport>,
    /// Origin of the commands, in the scenario mpc.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub decided: Option<DecidedReport>,
    /// Findings of the firmware about its mechanism, with --adapt.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub adapted: Option<AdaptiveReport>,
    /// Fingerprint of the trace.
    pub trace_hash: String,
    /// File of the trace.
    pub trace: PathBuf,
    /// File of the plot.
    pub picture: PathBuf,
    /// File of the moving picture, if the mechanism can be drawn.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub moving: Option<PathBuf>,
}

impl Report {
    /// The results that the loop knows; the files are filled in later.
    pub fn new<const N: usize>(request: &Request, summary: &Summary<N>) -> Self {
        let Incidents { dropped, late, missed, model, .. } = summary.incidents;
        Self {
            model: PathBuf::new(),
            scenario: request.scenario,
            system: request.plant.name(),
            units: [POSITION, FORCE].map(|units| units_of(&request.plant, units)),
            seed: request.seed,
            carried: request.world.changes.carried(&request.plant),
            friction_drift: request.world.changes.drift(),
            processor: "host".to_owned(),
            tick_instructions: None,
            success: summary.success,
            ticks: summary.ticks,
            settled_at: summary.settled_at,
            max_q: summary.max_q.to_vec(),
            max_error: summary.max_error.to_vec(),
            rms_error: summary.rms_error.to_vec(),
            rms_estimate_q: summary.rms_estimate_q.to_vec(),
            rms_estimate_v: summary.rms_estimate_v.to_vec(),
            max_force: summary.max_force.to_vec(),
            newton_iterations: summary.newton.iterations,
            newton_residual: summary.newton.residual,
            dropped,
            late,
            missed,
            model_errors: model,
            floating: None,
            planned: None,
            decided: None,
            adapted: None,
            trace_hash: format!("{:016x}", summary.hash),
            trace: PathBuf::new(),
            picture: PathBuf::new(),
            moving: None,
        }
    }

    fn controller(&self) -> String {
        let processor = &self.processor;
        match self.tick_instructions {
            None | Some([_, 0]) => processor.clone(),
            Some([median, largest]) => {
                format!("{processor}, {median} instructions a tick (median), {largest} at most")
            }
        }
    }

    /// Records which processor ran the controller, and the instructions of its ticks.
    pub fn on_processor(&mut self, name: &str, instructions: &[u32]) {
        name.clone_into(&mut self.processor);
        self.tick_instructions = median_and_most(instructions);
    }

    /// Fails if the goal was not reached.
    pub fn judge(&self) -> Done {
        if self.success {
            return Ok(());
        }
        Err(Failure::Work(format!(
            "{} of the {} did not reach its goal; see {}",
            self.scenario,
            self.system,
            self.picture.display()
        )))
    }
}

/// Median and largest; `None` if there are none.
pub fn median_and_most(instructions: &[u32]) -> Option<[u32; 2]> {
    let mut sorted = instructions.to_vec();
    sorted.sort_unstable();
    let both = sorted.get(sorted.len() / 2).zip(sorted.last());
    both.map(|(median, largest)| [*median, *largest])
}

/// Units of position by kind of coordinate: translation, angle.
pub const POSITION: [&str; 2] = ["m", "rad"];
/// Units of force by kind of coordinate: translation, angle.
pub const FORCE: [&str; 2] = ["N", "N m"];

/// The unit of a coordinate of this kind.
pub fn unit(kind: Coordinate, [translation, angle]: [&'static str; 2]) -> &'static str {
    if kind == Coordinate::Angle { angle } else { translation }
}

/// The units of all coordinates, in order.
fn units_of(plant: &Plant, units: [&'static str; 2]) -> String {
    let units: Vec<_> = plant.coordinates().iter().map(|kind| unit(*kind, units)).collect();
    units.join(", ")
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let goal = if self.success { "goal reached" } else { "goal NOT reached" };
        let settled = match self.settled_at {
            _ if self.floating.is_some() => "see below".to_owned(),
            None => "not within the tolerance at the end".to_owned(),
            Some(0.0) => "within the tolerance throughout".to_owned(),
            Some(t) => format!("within the tolerance for good after {t:.2} s"),
        };
        writeln!(f, "{} of the {}, seed {}: {goal}, {settled}", self.scenario, self.system, self.seed)?;
        let [q, u] = &self.units;
        let line = |f: &mut fmt::Formatter, name: &str, value: &str| writeln!(f, "{name:<32} {value}");
        for carried in &self.carried {
            line(f, "mechanism carried", &carried.told())?;
        }
        if let Some(drift) = &self.friction_drift {
            line(f, "mechanism's friction", &drift.told())?;
        }
        if let Some(FloatingReport { drift, peak, rest_after }) = &self.floating {
            line(f, &format!("drift before the push ({q}, per s)"), &list(drift))?;
            line(f, &format!("largest way from there ({q})"), &list(peak))?;
            let rest = rest_after
                .map_or("not at the end".to_owned(), |after| format!("{after:.2} s after the push"));
            line(f, "at rest", &rest)?;
        }
        if let Some(DecidedReport { decided, followed, floated }) = &self.decided {
            line(f, "decisions", &decided.to_string())?;
            line(f, "without: last motion, gravity", &format!("{followed}, {floated}"))?;
        }
        for (name, value) in self.planned.iter().flat_map(|planned| planned.lines(q, list)) {
            line(f, &name, &value)?;
        }
        for (name, value) in self.adapted.iter().flat_map(AdaptiveReport::lines) {
            line(f, name, &value)?;
        }
        line(f, "controller on", &self.controller())?;
        line(f, "ticks", &format!("{} (model errors: {})", self.ticks, self.model_errors))?;
        line(f, &format!("error, rms ({q})"), &list(&self.rms_error))?;
        line(f, "error, largest", &list(&self.max_error))?;
        line(f, "estimated position, rms error", &list(&self.rms_estimate_q))?;
        line(f, "estimated velocity, rms error", &list(&self.rms_estimate_v))?;
        line(f, &format!("position, largest ({q})"), &list(&self.max_q))?;
        line(f, &format!("force, largest ({u})"), &list(&self.max_force))?;
        let (iterations, residual) = (self.newton_iterations, self.newton_residual);
        line(f, "Newton", &format!("{iterations} iterations at most, residual {residual:.1e}"))?;
        line(f, "trace", &format!("{} in {}", self.trace_hash, self.trace.display()))?;
        line(f, "picture", &self.picture.display().to_string())?;
        self.moving.iter().try_for_each(|file| line(f, "moving picture", &file.display().to_string()))
    }
}

/// Formats values with three digits each.
fn list(values: &[f32]) -> String {
    let digits = |x: &f32| if *x == 0.0 || x.abs() >= 0.01 { format!("{x:.3}") } else { format!("{x:.1e}") };
    values.iter().map(digits).collect::<Vec<_>>().join(", ")
}
