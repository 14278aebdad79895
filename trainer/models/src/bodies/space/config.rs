//! `[model]` of the arm family: rigid bodies in space, from a robot description.

use crate::architecture::Architecture;
use crate::bodies::letters_of_joints;
use crate::bodies::space::ArmArchitecture;
use crate::config::checks::list;
use crate::config::family::{FamilyConfig, NetworksBeside};
use crate::config::origin::Open;
use crate::config::origin::Origin;
use crate::config::place::ShapeError;
use crate::config::problem::Problem;
use crate::family::Family;
use crate::laws::corrections::config::{DissipationConfig, Known, PotentialConfig, assemble};
use crate::laws::friction::config::FrictionConfig;
use crate::laws::servo::ServoConfig;
use crate::laws::stops::StopsConfig;
use crate::limits::MAX_TREE_COORDINATES;
use crate::number::Number;
use crate::tree::{Body, Joint, LogCholesky, Tree};
use crate::urdf::{Described, DescriptionNote};
use leastaction_core::energy::arm::Joint as JointKind;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Whether a group of numbers is learned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Learning {
    /// Learned from the logs.
    #[default]
    Learned,
    /// Known: the values of the description.
    Known,
}

/// Choice of the bodies that are learned.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "\"learned\", \"known\", or the names of the joints whose bodies are learned, as [\"joint7\"]"
)]
pub enum LearnedBodies {
    /// All bodies or none.
    All(Learning),
    /// Bodies on the joints with these names; all others are known.
    On(Vec<String>),
}

impl Default for LearnedBodies {
    fn default() -> Self {
        Self::All(Learning::Learned)
    }
}

/// An arm from its robot description (URDF or MJCF).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, tag = "family", rename = "arm")]
pub struct ArmConfig {
    /// Robot description, URDF or MJCF; the path is relative to the configuration file.
    pub urdf: PathBuf,
    /// Gravity γ in the frame of the base, m/s²; by default that of an MJCF file, and (0, 0, −9.81) with a URDF file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gravity: Option<[f64; 3]>,
    /// Names of the joints that are coordinates; all others are held still. By default all joints that are not locked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joints: Option<Vec<String>>,
    /// Joints that are held still, with their positions, rad or m.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub lock: BTreeMap<String, f64>,
    /// Total mass of all links that have none in the description, kg; their bodies are guessed from it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mass: Option<f64>,
    /// Width of the guessed bodies around the line along which they are spread, m.
    #[serde(default = "radius")]
    pub radius: f64,
    /// Run or model file of the same arm whose bodies, rotors and friction replace the description's at the start of training.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_from: Option<PathBuf>,
    /// Choice of the learned bodies. Training begins at the description, and whatever the log does not determine stays
    /// there.
    #[serde(default)]
    pub bodies: LearnedBodies,
    /// Whether the inertias of the rotors are learned; a known inertia is that of `start_from`, or else of the description
    /// (`armature` of MJCF), or else 0.
    #[serde(default)]
    pub rotors: Learning,
    /// Friction of the joints.
    #[serde(default, skip_serializing_if = "FrictionConfig::is_none")]
    pub friction: FrictionConfig,
    /// Servos, whose commands are positions. By default commands are forces.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub servo: Option<ServoConfig>,
    /// End stops, which no coordinate passes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stops: Option<StopsConfig>,
    /// Network that dissipates energy.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dissipation: Option<DissipationConfig>,
    /// Network that is added to the potential.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub potential: Option<PotentialConfig>,
}

fn radius() -> f64 {
    0.1
}

/// Initial inertia of a learned rotor, kg m².
pub(super) const FIRST_ROTOR: f64 = 1e-3;

impl ArmConfig {
    /// Returns an arm with this description, the usual gravity, and everything learned.
    pub fn new(urdf: impl Into<PathBuf>) -> Self {
        Self {
            urdf: urdf.into(),
            gravity: None,
            joints: None,
            lock: BTreeMap::new(),
            mass: None,
            radius: radius(),
            start_from: None,
            bodies: LearnedBodies::default(),
            rotors: Learning::Learned,
            friction: FrictionConfig::default(),
            servo: None,
            stops: None,
            dissipation: None,
            potential: None,
        }
    }

    /// Refuses numbers outside their range.
    pub(super) fn check_numbers(&self) -> Result<(), ShapeError> {
        let range = "finite and above 0";
        for (key, value) in [("mass", self.mass), ("radius", Some(self.radius))] {
            if let Some(value) = value.filter(|x| !(x.is_finite() && *x > 0.0)) {
                return Err(Problem::OutOfRange { key, value, range }.at([key.into()]));
            }
        }
        if let Some(value) = self.gravity.into_iter().flatten().find(|x| !x.is_finite()) {
            return Err(Problem::OutOfRange { key: "gravity", value, range: "finite" }.at(["gravity".into()]));
        }
        Ok(())
    }

    pub(super) fn at_urdf(&self, problem: Problem) -> ShapeError {
        problem.at(["urdf".into()])
    }

    /// Returns the shape, with its learned and known numbers.
    fn family(&self, tree: &Tree, learned: &[bool]) -> Result<ArmArchitecture, ShapeError> {
        let cannot_be =
            |(body, learned): &(&Body, &bool)| **learned && LogCholesky::around(&body.inertia).is_none();
        if let Some((body, _)) = tree.bodies().iter().zip(learned).find(cannot_be) {
            return Err(self.at_urdf(Problem::NoBodyThatCanBe { link: body.name.clone() }));
        }
        let rotor = |k: usize| match (self.rotors, tree.rotors[k]) {
            (Learning::Learned, rotor) => Number::learned(if rotor > 0.0 { rotor } else { FIRST_ROTOR }),
            (Learning::Known, rotor) => Number::known(rotor),
        };
        let found = tree.coordinates();
        ArmArchitecture::new(tree, |k| learned[k], rotor)
            .ok_or_else(|| self.at_urdf(Problem::Size { found, most: MAX_TREE_COORDINATES.to_string() }))
    }

    /// Whether each body is learned.
    fn learned_bodies(&self, tree: &Tree) -> Result<Vec<bool>, ShapeError> {
        let names = || tree.bodies().iter().map(|body| body.joint_name.as_str());
        let joints = match &self.bodies {
            LearnedBodies::All(learning) => {
                return Ok(names().map(|_| *learning == Learning::Learned).collect());
            }
            LearnedBodies::On(joints) => joints,
        };
        if let Some(name) = joints.iter().find(|joint| !names().any(|name| name == *joint)) {
            let (what, known) = ("joint", list(names()));
            return Err(Problem::UnknownType { what, name: name.clone(), known }.at(["bodies".into()]));
        }
        Ok(names().map(|name| joints.iter().any(|joint| joint == name)).collect())
    }

    /// Returns the tree with the bodies and rotors of a model; the model must have the same joints.
    fn begun(&self, tree: &Tree, origin: &Origin) -> Result<Tree, ShapeError> {
        let other = || {
            let file = self.start_from.clone().unwrap_or_default();
            Problem::OtherArm { file, urdf: self.urdf.clone() }.at(["start_from".into()])
        };
        let arm = origin.0.architecture.family.arm().ok_or_else(other)?;
        let own = arm.host_tree(&origin.0.weights).ok_or_else(other)?;
        let is_same = own.bodies().iter().zip(tree.bodies()).all(|(a, b)| a.has_joint_of(b));
        if !is_same {
            return Err(other());
        }
        Ok(tree.with_parameters(&own.parameters()))
    }
}

impl FamilyConfig for ArmConfig {
    fn defaults() -> &'static str {
        include_str!("config.toml")
    }

    fn files(&mut self) -> Vec<&mut PathBuf> {
        std::iter::once(&mut self.urdf).chain(&mut self.start_from).collect()
    }

    fn networks(&mut self) -> Option<NetworksBeside<'_>> {
        Some((&mut self.dissipation, &mut self.potential))
    }

    fn architecture(&self, open: Open) -> Result<Architecture, ShapeError> {
        self.noted(open).map(|(architecture, _)| architecture)
    }

    fn notes(&self, open: Open) -> Result<Vec<DescriptionNote>, ShapeError> {
        self.noted(open).map(|(_, notes)| notes)
    }
}

impl ArmConfig {
    /// Returns the shape of the model, and notes on its description.
    fn noted(&self, open: Open) -> Result<(Architecture, Vec<DescriptionNote>), ShapeError> {
        let Described { tree, mut notes } = self.described()?;
        let letters = letters_of_joints(tree.bodies().iter().map(kind));
        let origin = Origin::start_from(self.start_from.as_ref(), &letters, open)?;
        let tree = origin.as_ref().map(|origin| self.begun(&tree, origin)).transpose()?.unwrap_or(tree);
        let mut learned = self.learned_bodies(&tree)?;
        let (tree, thickened) = self.with_extents(&tree, &mut learned)?;
        notes.extend(thickened);
        let family = self.family(&tree, &learned)?;
        let friction = self.friction.assemble(family.n(), "joint")?;
        let mut group_laws = ServoConfig::assemble(self.servo.as_ref(), (family.n(), "joint"), friction)?;
        let limits: Vec<[f64; 2]> = (0..family.n()).map(|i| tree.limits(i).position).collect();
        group_laws =
            StopsConfig::assemble(self.stops.as_ref(), (family.n(), "joint"), Some(&limits), group_laws)?;
        origin.iter().for_each(|origin| origin.set_laws(&mut group_laws));
        let known = Known { letters: &letters, common: letters.len() };
        let corrections = assemble(self.dissipation.as_ref(), self.potential.as_ref(), &known)?;
        Ok((Architecture { family: family.into(), group_laws, corrections }, notes))
    }
}

/// Kind of a body's joint.
fn kind(body: &Body) -> JointKind {
    match body.joint {
        Joint::Revolute(_) => JointKind::Revolute,
        Joint::Prismatic(_) => JointKind::Prismatic,
    }
}
