//! Changes of the machine that a model describes: a load on a body, and other friction.

use crate::bodies::ArmArchitecture;
use crate::tree::{Inertia, reach};
use crate::{AnyFamily, Model, NumberKind, Precision};
use leastaction_core::energy::bodies::{
    BODY_PARAMETERS, BodyParameters, GRAVITY_PARAMETERS, Joint, PlanarInertia,
};
use leastaction_core::model::Law;
use nalgebra::{Matrix3, Vector3};
use thiserror::Error;

/// A load without extent that moves with a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointMass {
    /// The body, from 0; `None`: the last one.
    pub body: Option<usize>,
    /// Mass m, kg; negative for a part that the body loses.
    pub mass: f64,
    /// Place in the body's frame, m, with z = 0 for bodies in the plane; `None`: the body's end, twice as far from its joint as its centre of
    /// mass, or the centre itself of one that slides.
    pub place: Option<[f64; 3]>,
}

/// Reason why a machine cannot change like that.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ChangeError {
    /// A family without bodies.
    #[error("a model of the family {0} has no bodies that could carry a load")]
    NoBodies(&'static str),
    /// A body that does not exist.
    #[error("there is no body {body}: there are {bodies}, counted from 0")]
    NoBody {
        /// Number of the body.
        body: usize,
        /// Number of bodies.
        bodies: usize,
    },
    /// A load beside the plane or the line in which it must be.
    #[error("the load must be {0}")]
    Place(&'static str),
    /// A body without positive density.
    #[error("no body has the mass and inertia that would be left of body {0}: it loses too much")]
    Impossible(usize),
    /// A model without friction.
    #[error("the mechanism has no friction that could grow")]
    NoFriction,
    /// Friction that would hold whatever drives it.
    #[error("dry friction would grow to {0:.3} times the load, and must stay below 1 of it")]
    Load(f64),
    /// Friction that is not in proportion to numbers.
    #[error("the mechanism's friction is a network's, which cannot grow")]
    FrictionNetwork,
}

impl PointMass {
    /// Number of the load's body, of a machine with this number of bodies.
    ///
    /// # Errors
    /// [`ChangeError::NoBody`].
    pub fn body_of(&self, bodies: usize) -> Result<usize, ChangeError> {
        let body = self.body.unwrap_or(bodies.saturating_sub(1));
        if body < bodies { Ok(body) } else { Err(ChangeError::NoBody { body, bodies }) }
    }
}

impl Model {
    /// Place of a load in its body's frame, m.
    ///
    /// # Errors
    /// [`ChangeError::NoBodies`], [`ChangeError::NoBody`].
    pub fn place_of(&self, load: &PointMass) -> Result<[f64; 3], ChangeError> {
        let family = &self.architecture.family;
        let joints: Vec<_> = match (family.arm(), family.bodies()) {
            (Some(arm), _) => arm.tree_bodies().map(|body| body.joint).collect(),
            (_, Some(bodies)) => bodies.bodies().map(|body| body.joint).collect(),
            _ => return Err(ChangeError::NoBodies(family.name())),
        };
        let body = load.body_of(joints.len())?;
        let turns = joints.get(body) == Some(&Joint::Revolute);
        let end = || Some(reach(self.mass_and_moment(body)?, turns).into());
        Ok(load.place.or_else(end).unwrap_or_default())
    }

    /// Model with a load on one of its bodies, its numbers in single precision.
    ///
    /// # Errors
    /// [`ChangeError`] for a model without bodies, a load beside the plane of the bodies, and a negative mass that leaves no possible body.
    pub fn with_load(&self, load: &PointMass) -> Result<Self, ChangeError> {
        let place = self.place_of(load)?;
        let body = load.body_of(self.n())?;
        let mut loaded = Self { precision: Precision::Single, ..self.clone() };
        let is_possible = match self.architecture.family.arm() {
            Some(_) => loaded.load_in_space(body, load.mass, place),
            None => loaded.load_in_plane(body, load.mass, place)?,
        };
        if is_possible || load.mass >= 0.0 { Ok(loaded) } else { Err(ChangeError::Impossible(body)) }
    }

    /// Model with all friction multiplied by a factor, its numbers in single precision: damping, and dry friction with its part that
    /// grows with the load.
    ///
    /// # Errors
    /// [`ChangeError::NoFriction`], [`ChangeError::Load`], [`ChangeError::FrictionNetwork`].
    pub fn with_friction(&self, factor: f64) -> Result<Self, ChangeError> {
        if self.architecture.laws().contains(Law::Dissipation) {
            return Err(ChangeError::FrictionNetwork);
        }
        let mut changed = Self { precision: Precision::Single, ..self.clone() };
        let mut acts = false;
        for position in self.architecture.friction_positions() {
            if let Some(number) = changed.weights.get_mut(position) {
                acts |= *number != 0.0;
                *number *= factor;
            }
        }
        let loads = self.architecture.law_entries().filter(|entry| entry.kind == NumberKind::Load);
        let mut loads = loads.filter_map(|entry| changed.weights.get(entry.position));
        match loads.find(|load| **load >= 1.0) {
            Some(load) => Err(ChangeError::Load(*load)),
            None if acts => Ok(changed),
            None => Err(ChangeError::NoFriction),
        }
    }

    /// Mass and first moment of a body about its joint, kg and kg m.
    fn mass_and_moment(&self, body: usize) -> Option<(f64, Vector3<f64>)> {
        if self.architecture.family.arm().is_some() {
            let own = ArmArchitecture::body_of(&self.weights, body)?.inertia;
            return Some((own.mass, own.moment.into()));
        }
        let PlanarInertia { mass, moment: [x, y], .. } = PlanarInertia::of_body(&self.planar(body)?);
        Some((mass, Vector3::new(x, y, 0.0)))
    }

    fn planar(&self, body: usize) -> Option<BodyParameters<f64>> {
        let numbers = self.weights.get(GRAVITY_PARAMETERS + BODY_PARAMETERS * body..)?;
        Some(BodyParameters::from_array(*numbers.first_chunk()?))
    }

    /// Adds a point mass to a body in space; returns whether its density can be positive.
    fn load_in_space(&mut self, body: usize, mass: f64, place: [f64; 3]) -> bool {
        let start = ArmArchitecture::inertia_position(body);
        let Some(numbers) = self.weights.get_mut(start..).and_then(<[f64]>::first_chunk_mut) else {
            return false;
        };
        let load = Inertia::of_centre(mass, Vector3::from(place), Matrix3::zeros());
        let sum = Inertia(*numbers).with(&load);
        *numbers = sum.0;
        if let AnyFamily::Arm(arm) = &mut self.architecture.family
            && let Some(own) = arm.bodies.get_mut(body)
        {
            own.inertia = sum.0;
        }
        sum.consistency() > 0.0
    }

    /// Adds a point mass to a body in the plane; returns whether its density can be positive.
    fn load_in_plane(&mut self, body: usize, mass: f64, [x, y, z]: [f64; 3]) -> Result<bool, ChangeError> {
        if z != 0.0 {
            return Err(ChangeError::Place("in the plane of the bodies, with z = 0"));
        }
        let Some(own) = self.planar(body) else { return Ok(false) };
        let [m, mx, my, inertia] = PlanarInertia::of_body(&own).into_array();
        let sum = [m + mass, mx + mass * x, my + mass * y, inertia + mass * (x * x + y * y)];
        let loaded = PlanarInertia::from_array(sum).given_to(&own);
        let start = GRAVITY_PARAMETERS + BODY_PARAMETERS * body;
        if let Some(numbers) = self.weights.get_mut(start..).and_then(<[f64]>::first_chunk_mut) {
            *numbers = loaded.into_array();
        }
        if let AnyFamily::Bodies(bodies) = &mut self.architecture.family
            && let Some(own) = bodies.numbers.get_mut(body)
        {
            let numbers = own.iter_mut().zip(loaded.into_array());
            numbers.for_each(|(number, value)| number.value = value);
        }
        Ok(loaded.mass > 0.0 && loaded.inertia > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::file::decode;
    use crate::{Architecture, BodiesArchitecture, GroupLaws, Number};
    use leastaction_core::energy::bodies::TreeBody;

    /// A link in the plane with damping.
    fn link() -> Model {
        let body = BodyParameters {
            place: [0.0; 2],
            angle: 0.0,
            mass: 1.0,
            centre: [0.5, 0.0],
            inertia: 0.25,
            rotor: 0.0,
            gear: 1.0,
        };
        let body = BodyParameters::from_array(body.into_array().map(Number::known));
        let tree = TreeBody { joint: Joint::Revolute, parent: None };
        let bodies =
            BodiesArchitecture::new([Number::known(9.75), Number::known(0.0)], [(tree, body)]).unwrap();
        let group_laws = GroupLaws::of_friction(vec![Number::known(0.5)], Vec::new());
        let architecture = Architecture { group_laws, ..bodies.into() };
        let weights = architecture.initial_weights(0);
        Model::new(architecture, weights)
    }

    /// The shape has the load too, so that programs, which leave out numbers that are known to be 0, are those of a file with it.
    #[test]
    fn a_loaded_link_is_that_of_its_file() {
        let load = |mass, place| PointMass { body: None, mass, place };
        let loaded = link().with_load(&load(1.0, Some([0.5, 0.25, 0.0]))).unwrap();
        assert_eq!(loaded.planar(0).unwrap().centre, [0.5, 0.125]);
        let read = decode(&loaded.to_bytes().unwrap()).unwrap();
        assert_eq!(
            (&read.weights, &read.architecture.family),
            (&loaded.weights, &loaded.architecture.family)
        );
        assert_eq!(loaded.with_load(&load(-1.0, Some([0.5, 0.25, 0.0]))).unwrap().weights, link().weights);
        assert_eq!(link().place_of(&load(1.0, None)), Ok([1.0, 0.0, 0.0]));
        assert_eq!(link().with_load(&load(-0.9, None)), Err(ChangeError::Impossible(0)));
        assert!(matches!(link().with_load(&load(1.0, Some([0.0, 0.0, 0.1]))), Err(ChangeError::Place(_))));
    }

    #[test]
    fn friction_is_multiplied_and_nothing_else() {
        let mut expected = link().weights;
        *expected.last_mut().unwrap() = 1.0;
        assert_eq!(link().with_friction(2.0).unwrap().weights, expected);
        let smooth = Model {
            architecture: Architecture { group_laws: GroupLaws::default(), ..link().architecture },
            ..link()
        };
        assert_eq!(smooth.with_friction(2.0), Err(ChangeError::NoFriction));
    }
}
