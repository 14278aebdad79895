//! Conversion of a configuration into the shape of a model.

use super::{BodiesConfig, BodyConfig, BodyNumber, LEARNED, ZERO};
use crate::architecture::Architecture;
use crate::bodies::plane::BodiesArchitecture;
use crate::config::origin::{Open, Origin};
use crate::config::parts::Range;
use crate::config::place::ShapeError;
use crate::config::problem::Problem;
use crate::family::Family;
use crate::laws::corrections::config::{Known, assemble};
use crate::laws::servo::ServoConfig;
use crate::laws::stops::StopsConfig;
use crate::limits::MAX_TREE_COORDINATES;
use crate::number::Number;
use leastaction_core::energy::bodies::{BodyParameters, TreeBody};

/// Gear ratio assumed for an unknown drive. Motion shows the ratio and the rotor only together, as J(g² − g).
const GEAR: f64 = 10.0;

/// Initial values of learned numbers without a given start: an arm of 0.3 m and 1 kg. The inertia of another mass is in
/// proportion.
const USUAL: BodyParameters<f64> = BodyParameters {
    place: [0.3, 0.0],
    angle: 0.0,
    mass: 1.0,
    centre: [0.15, 0.0],
    inertia: 0.01,
    rotor: 1e-4,
    gear: GEAR,
};
/// Initial value of a learned γ without a given start, m/s².
const USUAL_GRAVITY: [f64; 2] = [9.81, 0.0];

impl BodyNumber {
    /// Returns the number at `key`. A known number must lie within `known`. A learned number must lie within `learned`,
    /// and starts at `usual` unless a start is given.
    fn number(self, key: &'static str, usual: f64, [known, learned]: [&Range; 2]) -> Result<Number, Problem> {
        match self {
            Self::Known(value) => known.number(key, value, false),
            Self::Learned(start) => learned.number(key, start.unwrap_or(usual), true),
        }
    }

    fn any(self, key: &'static str, usual: f64) -> Result<Number, Problem> {
        self.number(key, usual, [&Range::ANY; 2])
    }

    fn positive(self, key: &'static str, usual: f64) -> Result<Number, Problem> {
        self.number(key, usual, [&Range::ABOVE; 2])
    }
}

/// Two numbers under one key.
fn pair(key: &'static str, numbers: [BodyNumber; 2], usual: [f64; 2]) -> Result<[Number; 2], Problem> {
    Ok([numbers[0].any(key, usual[0])?, numbers[1].any(key, usual[1])?])
}

impl BodyConfig {
    /// Returns a link of a chain: the first, or one on another link. The rotor of a drive on the ground acts like a part of the body, so
    /// the first link has none.
    fn link(on: Option<u64>, gear: f64) -> Self {
        let own = Self { on, gear: BodyNumber::Known(gear), ..Self::default() };
        match on {
            None => own,
            Some(_) => Self { at: [LEARNED, ZERO], rotor: LEARNED, ..own },
        }
    }

    fn numbers(&self) -> Result<BodyParameters<Number>, Problem> {
        let mass = self.mass.positive("mass", USUAL.mass)?;
        let usual_inertia = USUAL.inertia / USUAL.mass * mass.value;
        Ok(BodyParameters {
            place: pair("at", self.at, USUAL.place)?,
            angle: self.angle.any("angle", USUAL.angle)?,
            mass,
            centre: pair("centre", self.centre, USUAL.centre)?,
            inertia: self.inertia.positive("inertia", usual_inertia)?,
            rotor: self.rotor.number("rotor", USUAL.rotor, [&Range::NOT_BELOW, &Range::ABOVE])?,
            gear: self.gear.any("gear", USUAL.gear)?,
        })
    }

    /// Returns this body as number i of a tree.
    fn body(&self, i: usize) -> Result<TreeBody, Problem> {
        let parent = match self.on {
            None => None,
            Some(on) if on < i as u64 => u8::try_from(on).ok(),
            Some(on) => return Err(Problem::OnBody { body: i, on }),
        };
        Ok(TreeBody { joint: self.joint.into(), parent })
    }
}

impl BodiesConfig {
    /// Shape of the model, with friction and correction networks.
    ///
    /// # Errors
    /// [`ShapeError`]: what is invalid, and where.
    pub(super) fn assemble(&self) -> Result<Architecture, ShapeError> {
        let family = self.tree()?;
        let friction = self.friction.assemble(family.n(), "body")?;
        let group_laws = ServoConfig::assemble(self.servo.as_ref(), (family.n(), "body"), friction)?;
        let group_laws = StopsConfig::assemble(self.stops.as_ref(), (family.n(), "body"), None, group_laws)?;
        let letters = family.coordinates();
        let known = Known { letters: &letters, common: letters.len() };
        let corrections = assemble(self.dissipation.as_ref(), self.potential.as_ref(), &known)?;
        Ok(Architecture { family: family.into(), group_laws, corrections })
    }

    /// Returns the shape, its learned numbers being those of the model to start from, and this model.
    pub(super) fn begun(&self, open: Open) -> Result<(Architecture, Option<Origin>), ShapeError> {
        let mut own = self.assemble()?;
        let Some(origin) = Origin::start_from(self.start_from.as_ref(), &own.coordinates(), open)? else {
            return Ok((own, None));
        };
        let same = own.family.bodies().zip(origin.0.architecture.family.bodies());
        let Some((tree, _)) = same.filter(|(own, other)| own.bodies().eq(other.bodies())) else {
            let file = self.start_from.clone().unwrap_or_default();
            return Err(Problem::OtherBodies { file }.at(["start_from".into()]));
        };
        own.family = tree.with_learned_of(&origin.0.weights).into();
        origin.set_laws(&mut own.group_laws);
        Ok((own, Some(origin)))
    }

    /// Returns the tree of these bodies.
    ///
    /// # Errors
    /// See [`BodiesConfig::architecture`].
    fn tree(&self) -> Result<BodiesArchitecture, ShapeError> {
        let gravity = pair("gravity", self.gravity, USUAL_GRAVITY);
        let gravity = gravity.map_err(|problem| problem.at(["gravity".into()]))?;
        let each = self.every()?;
        let key = if self.chain.is_some() { "chain" } else { "bodies" };
        if !(1..=MAX_TREE_COORDINATES).contains(&each.len()) {
            let (found, most) = (each.len(), format!("1 to {MAX_TREE_COORDINATES}"));
            return Err(Problem::Size { found, most }.at([key.into()]));
        }
        let mut bodies = Vec::new();
        for (i, body) in each.iter().enumerate() {
            let at = |problem: Problem| match &problem {
                Problem::OutOfRange { key, .. } => {
                    let place = ["bodies".into(), i.into(), (*key).into()];
                    problem.at(place)
                }
                _ => problem.at(["bodies".into(), i.into(), "on".into()]),
            };
            bodies.push((body.body(i).map_err(at)?, body.numbers().map_err(at)?));
        }
        // A body that precedes another one has a number that fits in a byte.
        BodiesArchitecture::new(gravity, bodies).ok_or_else(|| Problem::NoBodies.at([key.into()]))
    }

    /// All bodies; for a chain, the bodies that it stands for.
    fn every(&self) -> Result<Vec<BodyConfig>, ShapeError> {
        match (self.chain, self.gear, self.bodies.is_empty()) {
            (Some(_), _, false) => Err(Problem::ChainAndBodies.at(["chain".into()])),
            (None, _, true) => Err(Problem::NoBodies.at([])),
            (None, Some(_), _) => Err(Problem::GearWithoutChain.at(["gear".into()])),
            (None, None, false) => Ok(self.bodies.clone()),
            (Some(n), gear, true) => {
                let gear = gear.unwrap_or(GEAR);
                Range::ANY.number("gear", gear, false).map_err(|problem| problem.at(["gear".into()]))?;
                // One link too many suffices to cause the error.
                let links = 0..n.min(MAX_TREE_COORDINATES + 1) as u64;
                Ok(links.map(|i| BodyConfig::link(i.checked_sub(1), gear)).collect())
            }
        }
    }
}
