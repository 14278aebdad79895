//! The description of a unit: `modelDescription.xml`, and a page for people.

mod fmi2;
mod fmi3;
mod page;
mod structure;

use crate::{FmuError, Kind, Unit, Variable};
use std::fmt;

/// Version of the standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Version {
    /// FMI 2.0.
    Two,
    /// FMI 3.0.
    Three,
}

impl fmt::Display for Version {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Two => "2.0",
            Self::Three => "3.0",
        })
    }
}

/// Facts about a model that its unit states.
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    /// Name of the model.
    pub name: String,
    /// Family of the model.
    pub family: String,
    /// Whether each coordinate is a translation (m) rather than an angle (rad).
    pub translations: Vec<bool>,
    /// Name of every coordinate in its model, such as that of a joint; empty if it has none.
    pub coordinates: Vec<String>,
    /// Origin of the model.
    pub provenance: String,
    /// Whether the model has gains, offsets, a delay or a lag of drives, which the unit leaves out.
    pub has_actuator: bool,
    token: String,
    /// Step that the model was trained with, s.
    h: Option<f64>,
    order: u8,
}

impl Description {
    /// Creates the description of a model file, named so.
    ///
    /// # Errors
    /// See [`Unit::new`].
    pub fn new(model: &[u8], name: &str, translations: Vec<bool>) -> Result<Self, FmuError> {
        let unit = Unit::new(model)?;
        FmuError::check_length("the list of kinds of coordinates", unit.n(), translations.len())?;
        Ok(Self {
            name: name.to_owned(),
            family: String::new(),
            translations,
            coordinates: Vec::new(),
            provenance: String::new(),
            has_actuator: false,
            token: unit.token(),
            h: unit.h(),
            order: unit.order().number(),
        })
    }

    /// Number of coordinates n.
    pub fn n(&self) -> usize {
        self.translations.len()
    }

    /// Number of variables.
    pub fn variables(&self) -> usize {
        Variable::all(self.n()).len()
    }

    /// The text of `modelDescription.xml`.
    pub fn xml(&self, version: Version) -> String {
        match version {
            Version::Two => self.fmi2().document(),
            Version::Three => self.fmi3().document(),
        }
    }

    fn h(&self) -> f64 {
        self.h.unwrap_or(Unit::DEFAULT_H)
    }

    /// Unit of a variable.
    fn unit(&self, variable: Variable) -> &'static str {
        let is_translation = self.translations.get(variable.index).copied().unwrap_or_default();
        match (variable.kind, is_translation) {
            (Kind::Time | Kind::Step, _) => "s",
            (Kind::Force, true) => "N",
            (Kind::Force, false) => "N.m",
            (Kind::Position | Kind::StartPosition, true) => "m",
            (Kind::Position | Kind::StartPosition, false) => "rad",
            (Kind::Velocity | Kind::StartVelocity, true) => "m/s",
            (Kind::Velocity | Kind::StartVelocity, false) => "rad/s",
            (Kind::Acceleration, true) => "m/s2",
            (Kind::Acceleration, false) => "rad/s2",
            (Kind::KineticEnergy | Kind::PotentialEnergy | Kind::Energy, _) => "J",
        }
    }

    /// Description of a variable in words.
    fn says(&self, variable: Variable) -> String {
        let text = match variable.kind {
            Kind::Time => "Time",
            Kind::Step if self.h.is_some() => "Step of co-simulation, with which the model was trained",
            Kind::Step => "Step of co-simulation",
            Kind::Force => "Force at the actuator's output",
            Kind::Position => "Position",
            Kind::Velocity => "Velocity",
            Kind::Acceleration => "Acceleration",
            Kind::StartPosition => "Position at the start",
            Kind::StartVelocity => "Velocity at the start",
            Kind::KineticEnergy => "Kinetic energy",
            Kind::PotentialEnergy => "Potential energy",
            Kind::Energy => "Kinetic and potential energy",
        };
        let name = self.coordinates.get(variable.index).filter(|_| variable.kind.is_of_coordinates());
        name.map_or(text.to_owned(), |name| format!("{text} of {name}"))
    }

    /// Start value of a variable that has one.
    fn start(&self, kind: Kind) -> Option<f64> {
        match kind {
            Kind::Step => Some(self.h()),
            Kind::Force | Kind::StartPosition | Kind::StartVelocity => Some(0.0),
            _ => None,
        }
    }

    /// Causality, variability and initial value's kind of a variable, in the words of both versions.
    fn role(&self, kind: Kind) -> [Option<&'static str>; 3] {
        match kind {
            Kind::Time => [Some("independent"), Some("continuous"), None],
            Kind::Step if self.h.is_some() => [Some("local"), Some("constant"), Some("exact")],
            Kind::Step | Kind::StartPosition | Kind::StartVelocity => {
                [Some("parameter"), Some("fixed"), Some("exact")]
            }
            Kind::Force => [Some("input"), Some("continuous"), None],
            _ => [Some("output"), Some("continuous"), Some("calculated")],
        }
    }

    /// Name of the program.
    fn tool() -> String {
        format!("leastaction {}", env!("CARGO_PKG_VERSION"))
    }

    /// One sentence about the unit.
    fn summary(&self) -> String {
        let n = self.n();
        format!(
            "Lagrangian mechanics in {n} coordinate{}, learned from motion",
            if n == 1 { "" } else { "s" }
        )
    }
}

/// Units, with the exponents of SI that make them up.
const UNITS: [(&str, &[(&str, i8)]); 10] = [
    ("s", &[("s", 1)]),
    ("m", &[("m", 1)]),
    ("rad", &[("rad", 1)]),
    ("m/s", &[("m", 1), ("s", -1)]),
    ("rad/s", &[("rad", 1), ("s", -1)]),
    ("m/s2", &[("m", 1), ("s", -2)]),
    ("rad/s2", &[("rad", 1), ("s", -2)]),
    ("N", &[("kg", 1), ("m", 1), ("s", -2)]),
    ("N.m", &[("kg", 1), ("m", 2), ("s", -2)]),
    ("J", &[("kg", 1), ("m", 2), ("s", -2)]),
];
