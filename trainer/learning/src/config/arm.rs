//! `[model]` of the family of arms: rigid bodies in space, from a robot description.

use super::corrections::{DissipationConfig, Known, PotentialConfig, assemble};
use super::friction::FrictionConfig;
use super::problem::{Problem, ShapeError};
use crate::architecture::{Architecture, ArmArchitecture, MAX_TREE_COORDINATES, Number};
use leastaction_arms::urdf::{self, Inertias};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Whether numbers are learned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Learning {
    /// From the logs.
    #[default]
    Learned,
    /// They are those of the description.
    Known,
}

/// An arm from its robot description (URDF).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, tag = "family", rename = "arm")]
pub struct ArmConfig {
    /// The description; relative to the configuration file.
    pub urdf: PathBuf,
    /// γ in the frame of the base, m/s².
    #[serde(default = "gravity")]
    pub gravity: [f64; 3],
    /// Of all links together that have no mass in the description, kg: their bodies are guessed from it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mass: Option<f64>,
    /// Of guessed bodies about their lines, m.
    #[serde(default = "radius")]
    pub radius: f64,
    /// Whether bodies are learned; the description is where training begins, and where it stays in what the log does not show.
    #[serde(default)]
    pub bodies: Learning,
    /// Whether inertias of rotors are learned; a known one is 0.
    #[serde(default)]
    pub rotors: Learning,
    /// Friction of the joints.
    #[serde(default, skip_serializing_if = "FrictionConfig::is_none")]
    pub friction: FrictionConfig,
    /// A network that dissipates.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dissipation: Option<DissipationConfig>,
    /// A network that is added to the potential.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub potential: Option<PotentialConfig>,
}

fn gravity() -> [f64; 3] {
    [0.0, 0.0, -9.81]
}

fn radius() -> f64 {
    0.1
}

/// Where a learned rotor begins, kg m².
const FIRST_ROTOR: f64 = 1e-3;

impl ArmConfig {
    /// An arm of this description with the usual gravity, everything learned.
    pub fn new(urdf: impl Into<PathBuf>) -> Self {
        Self {
            urdf: urdf.into(),
            gravity: gravity(),
            mass: None,
            radius: radius(),
            bodies: Learning::Learned,
            rotors: Learning::Learned,
            friction: FrictionConfig::default(),
            dissipation: None,
            potential: None,
        }
    }

    /// The shape of the model.
    ///
    /// # Errors
    /// [`ShapeError`]: what cannot be read or be, and where.
    pub fn architecture(&self) -> Result<Architecture, ShapeError> {
        let family = self.arm()?;
        let friction = self.friction.assemble(family.n(), "joint")?;
        let letters = family.coordinates();
        let known = Known { letters: &letters, common: letters.len() };
        let corrections = assemble(self.dissipation.as_ref(), self.potential.as_ref(), &known)?;
        Ok(Architecture { family: family.into(), friction, corrections })
    }

    fn arm(&self) -> Result<ArmArchitecture, ShapeError> {
        let positive = |x: &f64| x.is_finite() && *x > 0.0;
        let out_of_range = |key, value| {
            let range = "finite and above 0";
            Problem::OutOfRange { key, value, range }.at([key.into()])
        };
        if let Some(mass) = self.mass.filter(|mass| !positive(mass)) {
            return Err(out_of_range("mass", mass));
        }
        if !positive(&self.radius) {
            return Err(out_of_range("radius", self.radius));
        }
        if let Some(value) = self.gravity.into_iter().find(|x| !x.is_finite()) {
            return Err(Problem::OutOfRange { key: "gravity", value, range: "finite" }.at(["gravity".into()]));
        }
        let inertias = if self.mass.is_some() { Inertias::Optional } else { Inertias::Required };
        let at = |problem: Problem| problem.at(["urdf".into()]);
        let tree = urdf::read(&self.urdf, inertias).map_err(|error| {
            at(Problem::Description { file: self.urdf.clone(), message: error.to_string() })
        })?;
        let mut tree =
            self.mass.map_or_else(|| tree.clone(), |mass| tree.with_guessed_inertias(mass, self.radius));
        tree.gravity = self.gravity.into();
        let found = tree.coordinates();
        if found > MAX_TREE_COORDINATES {
            return Err(at(Problem::Size { found, most: MAX_TREE_COORDINATES.to_string() }));
        }
        let learns_bodies = self.bodies == Learning::Learned;
        let cannot_be = |body: &&leastaction_arms::Body| {
            learns_bodies && leastaction_arms::LogCholesky::around(&body.inertia).is_none()
        };
        if let Some(body) = tree.bodies().iter().find(cannot_be) {
            return Err(at(Problem::NoBodyThatCanBe { link: body.name.clone() }));
        }
        let rotor = match self.rotors {
            Learning::Learned => Number::learned(FIRST_ROTOR),
            Learning::Known => Number::known(0.0),
        };
        ArmArchitecture::new(&tree, learns_bodies, rotor)
            .ok_or_else(|| at(Problem::Follows { file: self.urdf.clone() }))
    }
}
