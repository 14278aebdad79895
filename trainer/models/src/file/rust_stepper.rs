//! The stepper of a generated module: its types, and the function that makes it.

use crate::GraphArchitecture;
use crate::Model;
use leastaction_core::discrete::Order;
use leastaction_core::forces::{ControlKind, Lag};
use leastaction_core::model::{ActuatorBytes, ModelError, TrainedStep};
use std::fmt::{self, Write};

/// Number of commands that are kept for the delay of a model without a trained step: enough for up to 8 whole steps and
/// a fraction of one.
const PAST: usize = 9;

/// Facts about a model that determine the types of its stepper.
pub(super) struct StepperType {
    step: Option<TrainedStep>,
    /// Bytes of the actuator; empty if the command is the force.
    actuator: Vec<u8>,
    /// Number of past commands that are kept.
    past: usize,
}

impl StepperType {
    pub(super) fn of(model: &Model) -> Result<Self, ModelError> {
        let (step, bytes) = (model.facts.trained_step, model.facts.actuator.to_bytes());
        let actuator = (!bytes.is_empty()).then(|| ActuatorBytes::new(&bytes)).transpose()?;
        let of_kind = usize::from(step.is_some_and(|step| step.control == ControlKind::Linear));
        let late = match (actuator, step) {
            (None, _) => 0,
            (Some(_), None) => PAST,
            (Some(actuator), Some(step)) => {
                let (whole, rest) = actuator.delay_at_step(step.h)?;
                usize::from(whole) + usize::from(rest > 0.0)
            }
        };
        Ok(Self { step, past: of_kind + late, actuator: bytes })
    }

    fn actuator(&self) -> Option<ActuatorBytes<'_>> {
        ActuatorBytes::new(&self.actuator).ok()
    }

    /// Whether the actuator depends on a step that is not known.
    pub(super) fn is_open(&self) -> bool {
        self.step.is_none() && self.has_actuator()
    }

    fn order(&self) -> Order {
        self.step.map_or(Order::Four, |step| step.order)
    }

    pub(super) fn has_step(&self) -> bool {
        self.step.is_some()
    }

    /// Whether the actuator has a lag.
    pub(super) fn has_lag(&self) -> bool {
        self.actuator().is_some_and(|actuator| actuator.lag() > 0.0)
    }

    pub(super) fn has_actuator(&self) -> bool {
        !self.actuator.is_empty()
    }

    /// Name of the integrator.
    pub(super) fn path(&self) -> &'static str {
        match self.order() {
            Order::Two => "Midpoint",
            Order::Four => "Galerkin",
        }
    }

    fn kind(&self) -> &'static str {
        match self.step.map_or(ControlKind::Held, |step| step.control) {
            ControlKind::Held => "Held",
            ControlKind::Linear => "Linear",
        }
    }

    fn actuation(&self) -> &'static str {
        match self.actuator() {
            None => "Direct",
            Some(actuator) if actuator.lag() > 0.0 => "Lagged",
            Some(_) => "Actuated",
        }
    }

    /// Import line for core's module `stepper`, with the names in `others` included.
    pub(super) fn imports(&self, others: &[&'static str]) -> String {
        let mut names = [&[self.kind(), self.actuation()], others].concat();
        names.sort_unstable_by_key(|name| (name.starts_with(char::is_lowercase), *name));
        format!("use leastaction_core::stepper::{{self, {}}};", names.join(", "))
    }

    /// Writes the types of the drive and of the stepper, and the function that makes a stepper from the file.
    pub(super) fn write(&self, to: &mut impl Write) -> fmt::Result {
        self.write_made(to, "Stepper::new(load()?)")
    }

    /// Writes the same as [`StepperType::write`], but for a model held as constants.
    pub(super) fn write_of_constants(&self, to: &mut impl Write) -> fmt::Result {
        let made = match self.actuator() {
            None => "Stepper::new(load()?)",
            Some(_) => "Stepper::with_drive(load()?, Drive::new(ACTUATOR)?)",
        };
        self.write_made(to, made)
    }

    fn write_made(&self, to: &mut impl Write, made: &str) -> fmt::Result {
        self.write_types(to)?;
        writeln!(to, "pub type Stepper = stepper::Stepper<Model, {}, Drive, N>;\n", self.path())?;
        let [of, argument, made] = match self.step {
            Some(_) => ["", "", made],
            None => [" of a step of h seconds", "h: f32", "Stepper::with_step(load()?, h)"],
        };
        writeln!(to, "/// A stepper{of}, not started. {VALIDATES}")?;
        writeln!(to, "pub fn stepper({argument}) -> Result<Stepper, ModelError> {{\n    {made}\n}}")
    }

    /// Writes the types of a graph's stepper, and the function that makes one.
    pub(super) fn write_of_graph(&self, to: &mut impl Write, graph: &GraphArchitecture) -> fmt::Result {
        let named = graph.graphs.get(graph.graph);
        let (nodes, band) = named.map_or((0, 0), |graph| (graph.nodes.len(), graph.band()));
        let sizes = format!("N / DIMENSION, RODS, {band}, {}", graph.shape.workspace(nodes));
        self.write_types(to)?;
        writeln!(to, "pub type Stepper<'a> = ParticleStepper<'a, Model<'a>, Drive, DIMENSION, N>;")?;
        writeln!(to, "/// Memory that the graph is read to and stepped in.")?;
        writeln!(to, "pub type Memory = ParticleMemory<DIMENSION, EDGES, RODS, NUMBERS>;")?;
        writeln!(to, "const NUMBERS: usize = particle_numbers::<DIMENSION>({sizes});\n")?;
        let [of, argument, new, h] = if self.step.is_some() {
            ["", "", "new", ""]
        } else {
            [" of a step of h seconds", ", h: f32", "with_step", ", h"]
        };
        writeln!(to, "/// A stepper{of}, not started. {VALIDATES}")?;
        writeln!(to, "pub fn stepper(memory: &mut Memory{argument}) -> Result<Stepper<'_>, ModelError> {{")?;
        writeln!(to, "    Stepper::{new}(&FILE.0, GRAPH, memory{h})\n}}")
    }

    /// Writes the trained step, the type of the drive, and the doc comment of the stepper.
    fn write_types(&self, to: &mut impl Write) -> fmt::Result {
        if let Some(TrainedStep { h, .. }) = self.step {
            writeln!(to, "\n/// The step that the model was trained with, s.\npub const STEP: f32 = {h:?};")?;
        }
        let (kind, past, order) = (self.kind(), self.past, self.order());
        let commands = match kind {
            "Held" => "A command is held over its step",
            _ => "A command is the sample at the end of its step, linear from the one before",
        };
        writeln!(to, "\n/// {commands}; {}", self.between())?;
        let actuation = self.actuation();
        let sizes = if self.has_actuator() { "<N>" } else { "" };
        writeln!(to, "pub type Drive = stepper::Drive<{kind}, {actuation}{sizes}, N, {past}>;")?;
        writeln!(to, "/// Model, integrator of order {order}, drive and state: `start`, then `step`.")
    }

    /// End of the sentence about commands: the path from command to force.
    fn between(&self) -> String {
        let Some(actuator) = self.actuator() else { return "it is the force.".to_owned() };
        let (delay, lag) = (actuator.delay(), actuator.lag());
        if lag > 0.0 {
            return format!(
                "the actuator has gains, offsets, a delay of {delay:?} s and a lag of {lag:?} s."
            );
        }
        format!("the actuator has gains, offsets and a delay of {delay:?} s.")
    }

    /// Trained step of a model held as constants, as an expression.
    pub(super) fn trained(&self) -> &'static str {
        if self.step.is_some() { "Some(TRAINED)" } else { "None" }
    }

    /// Writes the constants for the trained step and the actuator of a model without a file.
    pub(super) fn write_numbers(&self, to: &mut impl Write) -> fmt::Result {
        let Some(TrainedStep { order, control, h }) = self.step else { return Ok(()) };
        let control = format!("ControlKind::{control:?}");
        writeln!(
            to,
            "\nconst TRAINED: TrainedStep = TrainedStep {{ order: Order::{order:?}, h: STEP, control: {control} }};"
        )?;
        let Some(actuator) = self.actuator() else { return Ok(()) };
        // This was checked before, when the number of commands kept was computed.
        let (whole, rest) = actuator.delay_at_step(h).unwrap_or_default();
        let pairs = actuator.pairs().collect::<Vec<_>>();
        let [gain, offset] = [0, 1].map(|k| pairs.iter().map(|pair| pair[k]).collect::<Vec<_>>());
        let (actuation, indent) = (self.actuation(), if self.has_lag() { "        " } else { "    " });
        writeln!(to, "\n#[rustfmt::skip]\nconst ACTUATOR: {actuation}<N> = {actuation} {{")?;
        if self.has_lag() {
            write_lag(to, &Lag::new(actuator.lag() / h, rest))?;
            writeln!(to, "    actuated: Actuated {{")?;
        }
        writeln!(to, "{indent}whole: {whole},")?;
        writeln!(
            to,
            "{indent}actuator: Actuator {{ gain: {gain:?}, offset: {offset:?}, delay: {rest:?} }},"
        )?;
        writeln!(to, "{}}};", if self.has_lag() { "    },\n" } else { "" })
    }
}

/// Writes the numbers of a lag.
fn write_lag(to: &mut impl Write, Lag { delay, whole, late }: &Lag<f32>) -> fmt::Result {
    writeln!(to, "    lag: Lag {{\n        delay: {delay:?},")?;
    for (name, rise) in [("whole", whole), ("late", late)] {
        writeln!(to, "        {name}: Rise {{ integrals: {:?} }},", rise.integrals)?;
    }
    writeln!(to, "    }},")
}

/// Sentence in the doc comments of all functions that make a stepper.
const VALIDATES: &str = "Validates the model, once; the weights stay where they are.";
