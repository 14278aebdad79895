//! `leastaction inspect`.

mod contacts;
mod network;
mod patch;
mod target;

use clap::Args;
use contacts::{DryFrictionReport, StopReport};
use leastaction::cli::{Done, Failure, Output};
use leastaction::models::load_part;
use leastaction_core::model::{CoordinateRange, FORMAT_VERSION, Interval};
use leastaction_cost::{Cost, cost};
use leastaction_learning::data::control_name;
use leastaction_models::describe::Description;
use leastaction_models::file::Precision;
use leastaction_models::{Actuator, Model};
use network::NetworkReport;
use patch::PatchReport;
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};
use target::{OnTarget, Target};

/// Show what a model file contains, and its cost on a chip.
///
/// Multiply-adds are those of the network's layers or, for rigid bodies, of the energies. Stack bytes are the arrays that are live at once
/// in an evaluation; call frames come on top. A step takes 2 to 3 Newton iterations.
#[derive(Args)]
pub struct Inspect {
    /// The model file.
    model: PathBuf,
    /// The tree or graph to report coordinates and cost for, if the model has several [default: the one that was trained].
    #[arg(long, visible_alias = "graph", value_name = "NAME")]
    tree: Option<String>,
    /// Also predict the cost on this processor: instructions, stack and code.
    #[arg(long, value_enum)]
    target: Option<Target>,
    /// Also show a patch of the model: the distances of its numbers that a machine found and saved while it ran.
    #[arg(long, value_name = "PATCH")]
    patch: Option<PathBuf>,
}

/// Contents of the file.
#[derive(Serialize)]
struct Report {
    model: PathBuf,
    family: &'static str,
    coordinates: Vec<&'static str>,
    /// Tree or graph to which coordinates and cost refer, if the file has several.
    #[serde(skip)]
    part: Option<[String; 2]>,
    #[serde(flatten)]
    shape: Description,
    damping: Option<Vec<f64>>,
    /// Damping by direction: 1 + x of it forwards, 1 − x backwards; empty if it is the same.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    damping_asymmetry: Vec<f64>,
    /// Dry friction of every coordinate; empty if there is none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    dry_friction: Vec<DryFrictionReport>,
    /// End stops of the coordinates that have some.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    stops: Vec<StopReport>,
    /// The dissipation network, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    dissipation: Option<NetworkReport>,
    /// The network that is added to the potential, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    potential: Option<NetworkReport>,
    /// Stiffness of the servo of every coordinate, N/m or N m/rad, if commands are positions; else empty.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    servo: Vec<f64>,
    /// The actuator between command and force; `None` if it is ideal.
    #[serde(skip_serializing_if = "Option::is_none")]
    actuator: Option<ActuatorReport>,
    parameters: usize,
    weight_bits: u8,
    order: Option<u8>,
    h: Option<f64>,
    /// Control kind in training.
    control: Option<&'static str>,
    /// Range of the training data; empty if the file does not give it.
    range: Vec<RangeReport>,
    format_version: u8,
    provenance: String,
    flash_bytes: usize,
    /// Cost; `None` for a model without a selected graph.
    cost: Option<Cost>,
    #[serde(skip_serializing_if = "Option::is_none")]
    target: Option<OnTarget>,
    /// Numbers of a patch, if one is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    patch: Option<PatchReport>,
}

impl Inspect {
    /// Reads the file and reports.
    pub fn run(self, output: Output) -> Done {
        let (model, bytes) = load_part(&self.model, self.tree.as_deref())?;
        let target = self.target.map(|target| on(target, &self.model, &model, bytes)).transpose()?;
        let patch = self.patch.map(|patch| PatchReport::read((&model, &self.model), &patch)).transpose()?;
        output.report(&Report { target, patch, ..report(self.model, model, bytes) })
    }
}

/// The prediction for a processor.
fn on(target: Target, file: &Path, model: &Model, model_bytes: usize) -> Result<OnTarget, Failure> {
    let unknown = || {
        let name = target.processor().name();
        let why = match model.precision {
            Precision::Half => "of weights in half precision it was not measured",
            Precision::Single if !model.architecture.corrections.is_none() => {
                "of laws with networks it was not measured"
            }
            Precision::Single => "its shape is beyond those that were measured",
        };
        Failure::input(file, format!("what it takes on a {name} is not known: {why}"))
    };
    let prediction = target.processor().predict(model).ok_or_else(unknown)?;
    Ok(OnTarget { prediction, model_bytes, static_ram_bytes: 0 })
}

fn report(file: PathBuf, model: Model, flash_bytes: usize) -> Report {
    let architecture = &model.architecture;
    let friction = architecture.friction_of_coordinates(&model.weights);
    let damping: Vec<f64> = friction.iter().map(|friction| friction.viscous).collect();
    let asymmetry: Vec<f64> = friction.iter().map(|friction| friction.viscous_asymmetry).collect();
    let is_asymmetric = asymmetry.iter().any(|asymmetry| *asymmetry != 0.0);
    // Every modular model has damping numbers, but most are 0.
    let damped =
        architecture.family.inertia_network().is_some() || damping.iter().any(|damping| *damping != 0.0);
    Report {
        cost: cost(architecture).ok(),
        target: None,
        patch: None,
        family: architecture.with_header(|header| header.name()),
        coordinates: architecture.coordinates().chars().map(kind).collect(),
        part: architecture.family.parts().map(|parts| [parts.what, parts.meant].map(str::to_owned)),
        shape: Description::of(&architecture.family),
        damping: (!damping.is_empty() && damped).then_some(damping),
        damping_asymmetry: if is_asymmetric { asymmetry } else { Vec::new() },
        dry_friction: friction.iter().filter_map(|friction| friction.dry).map(Into::into).collect(),
        stops: StopReport::of(architecture.stops_of_coordinates(&model.weights)),
        dissipation: architecture
            .corrections
            .dissipation
            .as_ref()
            .map(|of| NetworkReport::of(&of.network, &of.scales)),
        potential: architecture.corrections.potential.as_ref().map(|of| NetworkReport::of(of, &[])),
        servo: architecture.stiffness_of_coordinates(&model.weights),
        actuator: ActuatorReport::of(&model),
        parameters: model.weights.len(),
        weight_bits: model.precision.bits(),
        order: model.facts.trained_step.map(|step| step.order.number()),
        h: model.facts.trained_step.map(|step| shortest(step.h)),
        control: model.facts.trained_step.map(|step| control_name(step.control)),
        range: model.facts.range.iter().map(RangeReport::from).collect(),
        format_version: model.version,
        provenance: model.facts.provenance,
        flash_bytes,
        model: file,
    }
}

/// The actuator: from the command u to the force gain y + offset, where y is u(t − delay) behind the lag.
#[derive(Serialize)]
struct ActuatorReport {
    /// Gain of every coordinate.
    gain: Vec<f64>,
    /// Offset of every coordinate, N or N m.
    offset: Vec<f64>,
    /// Delay, s.
    delay: f64,
    /// Time constant of the lag, s; left out if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    lag: Option<f64>,
}

impl ActuatorReport {
    fn of(model: &Model) -> Option<Self> {
        let Actuator { gain, offset, delay, lag } = model.facts.actuator.clone();
        let lag = Some(lag).filter(|lag| *lag > 0.0);
        (!model.facts.actuator.is_ideal()).then_some(Self { gain, offset, delay, lag })
    }
}

impl fmt::Display for ActuatorReport {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { gain, offset, delay, lag } = self;
        let list = |numbers: &[f64]| numbers.iter().map(|x| format!("{x:.4}")).collect::<Vec<_>>().join(", ");
        write!(f, "gain {}, offset {} N or N m, delay {delay:.5} s", list(gain), list(offset))?;
        lag.iter().try_for_each(|lag| write!(f, ", lag {lag:.5} s"))
    }
}

/// Range of the training data in one coordinate: smallest and largest values.
#[derive(Serialize)]
struct RangeReport {
    q: [f64; 2],
    v: [f64; 2],
    u: [f64; 2],
}

impl From<&CoordinateRange> for RangeReport {
    fn from(range: &CoordinateRange) -> Self {
        let ends = |interval: Interval| [interval.least, interval.most].map(shortest);
        Self { q: ends(range.q), v: ends(range.v), u: ends(range.u) }
    }
}

/// The shortest decimal notation of this single-precision number.
fn shortest(x: f32) -> f64 {
    x.to_string().parse().unwrap_or(f64::from(x))
}

fn kind(letter: char) -> &'static str {
    match letter {
        't' => "translation",
        'a' => "angle",
        _ => "cyclic",
    }
}

impl Report {
    /// Unit of viscous damping: one if all coordinates are of a kind that has one.
    fn damping_unit(&self) -> &'static str {
        let all = |kind: &str| self.coordinates.iter().all(|own| *own == kind);
        match (all("translation"), all("angle")) {
            (true, _) => "N s/m",
            (_, true) => "N m s/rad",
            _ => "N s/m or N m s/rad",
        }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let line = |f: &mut fmt::Formatter, name: &str, value: &str| writeln!(f, "{name:<22} {value}");
        line(f, "family", self.family)?;
        line(f, "coordinates", &self.coordinates.join(", "))?;
        self.shape.lines().iter().try_for_each(|(name, value)| line(f, name, value))?;
        if let Some(damping) = &self.damping {
            line(f, "damping", &format!("{damping:.4?} {}", self.damping_unit()))?;
        }
        if !self.damping_asymmetry.is_empty() {
            let by = &self.damping_asymmetry;
            line(f, "", &format!("times 1 + x forwards and 1 - x backwards: x = {by:.4?}"))?;
        }
        for (i, dry) in self.dry_friction.iter().enumerate() {
            line(f, if i == 0 { "dry friction" } else { "" }, &format!("q{i}: {dry}"))?;
        }
        for (k, stop) in self.stops.iter().enumerate() {
            line(f, if k == 0 { "end stops" } else { "" }, &stop.to_string())?;
        }
        for (name, network) in [("dissipation", &self.dissipation), ("potential beside it", &self.potential)]
        {
            network.iter().try_for_each(|network| line(f, name, &network.to_string()))?;
        }
        if !self.servo.is_empty() {
            line(f, "commands", "positions, m or rad: the force of the drive is k (u - q)")?;
            line(f, "stiffness k", &format!("{:.4?} N/m or N m/rad", self.servo))?;
        }
        self.actuator.iter().try_for_each(|actuator| line(f, "actuator", &actuator.to_string()))?;
        line(f, "parameters", &format!("{} of {} bits", self.parameters, self.weight_bits))?;
        match (self.order, self.h) {
            (Some(order), Some(h)) => {
                let control = self.control.unwrap_or("unknown");
                line(
                    f,
                    "trained for",
                    &format!("order {order}, step {h} s, control {control} between samples"),
                )?;
            }
            _ => line(f, "trained for", "accelerations: any order and step")?,
        }
        self.ranges(f)?;
        line(f, "from", &self.provenance)?;
        if self.format_version != FORMAT_VERSION {
            let version = self.format_version;
            line(
                f,
                "format",
                &format!("version {version}, which controllers refuse: `leastaction convert`"),
            )?;
        }
        writeln!(f)?;
        self.costs(f)?;
        self.target.iter().try_for_each(|target| write!(f, "{target}"))?;
        self.patch.iter().try_for_each(|patch| write!(f, "{patch}"))
    }
}

impl Report {
    /// Writes a line for every coordinate, if the file gives the range of the training data.
    fn ranges(&self, f: &mut fmt::Formatter) -> fmt::Result {
        for (i, RangeReport { q, v, u }) in self.range.iter().enumerate() {
            let name = if i == 0 { "training data" } else { "" };
            let ends = |[least, most]: [f64; 2]| format!("{least:.4} … {most:.4}");
            writeln!(f, "{name:<22} q{i}: {}, v: {}, u: {}", ends(*q), ends(*v), ends(*u))?;
        }
        Ok(())
    }

    fn costs(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Some(cost) = self.cost else {
            return writeln!(f, "flash {} bytes", self.flash_bytes);
        };
        let Cost { state_bytes, handle_bytes, acceleration, step_order_2, step_order_4, iterated } = cost;
        let [second, fourth] = if iterated {
            ["Newton iteration, order 2", "Newton iteration, order 4"]
        } else {
            ["step, order 2", "step, order 4"]
        };
        if let Some([what, name]) = &self.part {
            writeln!(f, "{what} {name}, of {} coordinates", self.coordinates.len())?;
        }
        writeln!(
            f,
            "flash {} bytes; RAM {handle_bytes} bytes for the model, {state_bytes} for a state",
            self.flash_bytes
        )?;
        writeln!(f, "{:<30} {:>13} {:>13}", "", "multiply-adds", "stack bytes")?;
        let rows = [("acceleration", acceleration), (second, step_order_2), (fourth, step_order_4)];
        rows.iter().try_for_each(|(name, work)| {
            writeln!(f, "{name:<30} {:>13} {:>13}", work.multiply_adds, work.stack_bytes)
        })
    }
}
