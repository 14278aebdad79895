//! `[model]` of the bodies family: rigid bodies on joints.

mod assemble;
mod values;

pub use values::{BodyNumber, JointKind};

use crate::architecture::Architecture;
use crate::config::family::{FamilyConfig, NetworksBeside, Source};
use crate::config::origin::Open;
use crate::config::place::ShapeError;
use crate::laws::corrections::config::{DissipationConfig, PotentialConfig};
use crate::laws::friction::config::FrictionConfig;
use crate::laws::servo::ServoConfig;
use crate::laws::stops::StopsConfig;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A tree of rigid bodies on joints, or a chain as a shorthand.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, tag = "family", rename = "bodies")]
pub struct BodiesConfig {
    /// γ, m/s², along the axes of the ground.
    #[serde(default = "gravity")]
    pub gravity: [BodyNumber; 2],
    /// Number of bodies of a chain on revolute joints, in place of `bodies`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chain: Option<usize>,
    /// Gear ratio of the drives in that chain. (Default: 10.)
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gear: Option<f64>,
    /// Bodies in the order of q, parents first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bodies: Vec<BodyConfig>,
    /// Run or model file of the same bodies, with whose numbers training begins in place of those given here.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_from: Option<PathBuf>,
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

fn gravity() -> [BodyNumber; 2] {
    [BodyNumber::Known(9.81), ZERO]
}

const ZERO: BodyNumber = BodyNumber::Known(0.0);
const LEARNED: BodyNumber = BodyNumber::Learned(None);

/// A body and its joint; keys left out have their defaults.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct BodyConfig {
    /// Kind of joint between the body and its parent.
    pub joint: JointKind,
    /// Number of the body that carries the joint, from 0; without it, the ground.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub on: Option<u64>,
    /// Position of the joint in the parent's frame, m. (Default: 0.)
    pub at: [BodyNumber; 2],
    /// Angle of the joint's frame relative to the parent's, rad. (Default: 0.)
    pub angle: BodyNumber,
    /// Mass m > 0, kg. (Default: learned.)
    pub mass: BodyNumber,
    /// Centre of mass in the body's frame, m. (Default: learned along x, 0 along y.)
    pub centre: [BodyNumber; 2],
    /// Moment of inertia I > 0 about the centre of mass, kg m². (Default: learned.)
    pub inertia: BodyNumber,
    /// Inertia J ≥ 0 of the drive's rotor, which sits on the parent, kg m². (Default: 0.)
    pub rotor: BodyNumber,
    /// Gear ratio: rotor speed over joint speed. (Default: 1.)
    pub gear: BodyNumber,
}

impl Default for BodyConfig {
    fn default() -> Self {
        Self {
            joint: JointKind::Revolute,
            on: None,
            at: [ZERO; 2],
            angle: ZERO,
            mass: LEARNED,
            centre: [LEARNED, ZERO],
            inertia: LEARNED,
            rotor: ZERO,
            gear: BodyNumber::Known(1.0),
        }
    }
}

impl BodiesConfig {
    /// Returns a chain of `n` bodies on revolute joints.
    pub fn chain(n: usize) -> Self {
        Self {
            gravity: gravity(),
            chain: Some(n),
            gear: None,
            bodies: Vec::new(),
            start_from: None,
            friction: FrictionConfig::default(),
            servo: None,
            stops: None,
            dissipation: None,
            potential: None,
        }
    }
}

impl FamilyConfig for BodiesConfig {
    fn defaults() -> &'static str {
        include_str!("../config.toml")
    }

    fn networks(&mut self) -> Option<NetworksBeside<'_>> {
        Some((&mut self.dissipation, &mut self.potential))
    }

    fn files(&mut self) -> Vec<&mut PathBuf> {
        self.start_from.iter_mut().collect()
    }

    fn source(&self) -> Source {
        if self.start_from.is_some() { Source::Weights } else { Source::Nothing }
    }

    fn architecture(&self, open: Open) -> Result<Architecture, ShapeError> {
        Ok(self.begun(open)?.0)
    }

    /// Learned numbers and networks are those of the model to start from.
    fn beginning(&self, seed: u64, open: Open) -> Result<(Architecture, Vec<f64>), ShapeError> {
        let (architecture, origin) = self.begun(open)?;
        let mut weights = architecture.initial_weights(seed);
        if let Some(origin) = origin {
            weights.splice(architecture.corrections_place(), origin.corrections(&architecture));
        }
        Ok((architecture, weights))
    }
}
