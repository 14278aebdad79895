//! Host-side shape of a tree of rigid bodies in space.

pub mod config;
pub mod describe;
mod described;
mod dynamics;
#[cfg(test)]
mod dynamics_tests;

pub use dynamics::ArmDynamics;

use super::{letters_of_joints, tree_type};
use crate::bounds::Range;
use crate::family::{Family, OpenGauge};
use crate::names::{NumberName, named};
use crate::number::{Number, known_positions};
use crate::source::{ConstantType, LoadedType};
use crate::tree::{Body, INERTIAL, Inertia, Joint as HostJoint, LogCholesky, Tree};
use leastaction_core::energy::arm::{
    ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS, ArmParameters, BodyInertia, Joint, TreeBody,
};
use leastaction_core::model::{ArmHeader, Laws, ModelError};
use leastaction_programs::energies::{ArmEnergies, ArmJoint, Energies};
use serde::{Deserialize, Serialize};

/// Number of parameters of a body that describe its joint's frame and axis.
const FRAME: usize = ARM_PARAMETERS - INERTIAL - 1;

/// Names and units of the numbers of a body that can be learned, and of its rotor.
const NUMBERS_OF_BODY: [(&str, &str); 11] = [
    ("mass", "kg"),
    ("mass times centre x", "kg m"),
    ("mass times centre y", "kg m"),
    ("mass times centre z", "kg m"),
    ("inertia xx about the joint", "kg m²"),
    ("inertia xy about the joint", "kg m²"),
    ("inertia yy about the joint", "kg m²"),
    ("inertia xz about the joint", "kg m²"),
    ("inertia yz about the joint", "kg m²"),
    ("inertia zz about the joint", "kg m²"),
    ("inertia of the rotor", "kg m²"),
];

/// A body of an arm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ArmBody {
    /// Name of its joint; empty if the arm comes from a model file, which has no names.
    pub name: String,
    /// R, p and axis of its joint, as in a model file.
    pub frame: Vec<f64>,
    /// Ten inertial numbers of the body: its known values, or the values at which training begins. In the latter case
    /// they are also the prior, relative to which the learned numbers are expressed.
    pub inertia: [f64; INERTIAL],
    /// Whether the inertial numbers are learned.
    pub is_learned: bool,
    /// Inertia J of its rotor, kg m² or kg.
    pub rotor: Number,
}

/// Shape of a tree of rigid bodies on joints in space: its kinematics are known, its bodies and rotors known or learned.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ArmArchitecture {
    /// Encoded tree, see [`ArmHeader::bodies`].
    pub tree: Vec<u8>,
    /// γ, m/s².
    pub gravity: [f64; ARM_GRAVITY_PARAMETERS],
    /// One body per coordinate.
    pub bodies: Vec<ArmBody>,
}

impl ArmArchitecture {
    /// Returns the shape of a tree in which every coordinate moves one body, in the same order. `None` for any other
    /// tree (if a joint follows another one), or if a body sits on body 255 or beyond.
    pub fn new(
        tree: &Tree,
        learned: impl Fn(usize) -> bool,
        rotor: impl Fn(usize) -> Number,
    ) -> Option<Self> {
        let (mut bytes, mut bodies) = (Vec::new(), Vec::new());
        for (k, body) in tree.bodies().iter().enumerate() {
            if body.coordinate != k || body.ratio != 1.0 || body.offset != 0.0 {
                return None;
            }
            let (joint, axis) = match body.joint {
                HostJoint::Revolute(axis) => (Joint::Revolute, axis),
                HostJoint::Prismatic(axis) => (Joint::Prismatic, axis),
            };
            let parent = body.parent.map(u8::try_from).transpose().ok()?;
            bytes.extend(TreeBody { joint, parent }.to_bytes()?);
            let rows = body.pose.rotation.transpose();
            let frame = rows.iter().chain(&body.pose.translation).chain(axis.iter()).copied().collect();
            let (name, inertia) = (body.joint_name.clone(), body.inertia.0);
            bodies.push(ArmBody { name, frame, inertia, is_learned: learned(k), rotor: rotor(k) });
        }
        Some(Self { tree: bytes, gravity: tree.gravity.into(), bodies })
    }

    /// Calls `read` with the shape as the model file states it.
    pub(crate) fn with_header<T>(&self, read: impl FnOnce(ArmHeader) -> T) -> T {
        read(self.header())
    }

    /// Shape as the model file states it.
    pub fn header(&self) -> ArmHeader<'_> {
        ArmHeader { bodies: &self.tree }
    }

    /// Returns the shape described by a model file; all numbers are known, as in the file.
    pub(crate) fn from_header(header: &ArmHeader, _: Laws, weights: &[f64]) -> Self {
        let (gravity, numbers) = weights.split_at(weights.len().min(ARM_GRAVITY_PARAMETERS));
        let of = |numbers: &[f64; ARM_PARAMETERS]| ArmBody {
            name: String::new(),
            frame: numbers[..FRAME].to_vec(),
            inertia: *numbers[FRAME..].first_chunk().unwrap_or(&[0.0; INERTIAL]),
            is_learned: false,
            rotor: Number::known(numbers[ARM_PARAMETERS - 1]),
        };
        Self {
            tree: header.bodies.to_vec(),
            gravity: gravity.try_into().unwrap_or_default(),
            bodies: numbers.as_chunks().0.iter().take(header.n()).map(of).collect(),
        }
    }

    /// Joints and their parents in order; any that a model file cannot hold is left out.
    pub fn tree_bodies(&self) -> impl Iterator<Item = TreeBody> {
        self.header().bodies().flatten()
    }

    /// All numbers, in the order of the weight block.
    fn all_numbers(&self) -> impl Iterator<Item = Number> {
        let of_body = |body: &ArmBody| {
            let frame = body.frame.iter().map(|x| Number::known(*x)).collect::<Vec<_>>();
            let number = |value| Number::new(value, body.is_learned);
            frame.into_iter().chain(body.inertia.map(number)).chain([body.rotor])
        };
        self.gravity.iter().map(|x| Number::known(*x)).chain(self.bodies.iter().flat_map(of_body))
    }

    /// Position of the first number of a body in the weight block.
    fn start(body: usize) -> usize {
        ARM_GRAVITY_PARAMETERS + ARM_PARAMETERS * body
    }

    /// Position of the first of the ten inertial numbers of a body in the weight block.
    pub fn inertia_position(body: usize) -> usize {
        Self::start(body) + FRAME
    }

    /// Position of the rotor of a coordinate in the weight block.
    pub fn rotor_position(coordinate: usize) -> usize {
        Self::start(coordinate + 1) - 1
    }

    /// Numbers of the k-th body in a weight block; `None` if the block is too short.
    pub fn body_of(weights: &[f64], k: usize) -> Option<ArmParameters<f64>> {
        Some(ArmParameters::from_array(*weights.get(Self::start(k)..)?.first_chunk()?))
    }

    /// Writes the learned bodies and rotors of this shape into a weight block, with their values in `tree`.
    pub fn put(&self, tree: &Tree, weights: &mut [f64]) {
        for (k, ((own, body), rotor)) in self.bodies.iter().zip(tree.bodies()).zip(&tree.rotors).enumerate() {
            let Some(numbers) = weights.get_mut(Self::start(k)..Self::start(k + 1)) else { continue };
            if own.is_learned {
                numbers[FRAME..FRAME + INERTIAL].copy_from_slice(&body.inertia.0);
            }
            if own.rotor.learned {
                numbers[ARM_PARAMETERS - 1] = *rotor;
            }
        }
    }

    /// Returns the tree of this shape on the host, with the bodies and rotors of a weight block.
    pub fn host_tree(&self, weights: &[f64]) -> Option<Tree> {
        let body = |(k, (body, own)): (usize, (TreeBody, &ArmBody))| {
            let numbers = Self::body_of(weights, k)?;
            Some(host_body(k, body, own, &numbers))
        };
        let bodies = self.tree_bodies().zip(&self.bodies).enumerate().map(body).collect::<Option<_>>()?;
        let mut tree = Tree::new(bodies).ok()?;
        tree.rotors = (0..self.n()).filter_map(|k| Some(Self::body_of(weights, k)?.rotor)).collect();
        tree.gravity = self.gravity.into();
        Some(tree)
    }
}

impl Family for ArmArchitecture {
    fn n(&self) -> usize {
        self.header().n()
    }

    fn coordinates(&self) -> String {
        letters_of_joints(self.tree_bodies().map(|body| body.joint))
    }

    fn initial_weights(&self, _: u64) -> Vec<f64> {
        self.all_numbers().map(|number| number.value).collect()
    }

    fn fixed_positions(&self) -> Vec<usize> {
        known_positions(0, self.all_numbers())
    }

    fn ranges(&self) -> Vec<(usize, Range)> {
        let learned = self.bodies.iter().enumerate().filter(|(_, body)| body.rotor.learned);
        learned.map(|(k, _)| (Self::rotor_position(k), Range::Positive)).collect()
    }

    fn learned_bodies(&self) -> Vec<(usize, LogCholesky)> {
        let learned = self.bodies.iter().enumerate().filter(|(_, body)| body.is_learned);
        let chart = |(k, body): (usize, &ArmBody)| {
            Some((Self::inertia_position(k), LogCholesky::around(&Inertia(body.inertia))?))
        };
        learned.filter_map(chart).collect()
    }

    fn masses(&self) -> Vec<Vec<usize>> {
        let of_body = |k: usize| (Self::inertia_position(k)..).take(INERTIAL + 1).collect();
        (0..self.bodies.len()).map(of_body).collect()
    }

    fn number_names(&self) -> Vec<Option<NumberName>> {
        let gravity =
            ["x", "y", "z"].map(|axis| NumberName { name: format!("gravity along {axis}"), unit: "m/s²" });
        let of_body = |(k, body): (usize, &ArmBody)| {
            let whose = if body.name.is_empty() { format!("joint {k}") } else { body.name.clone() };
            let frame = vec![None; body.frame.len()];
            frame.into_iter().chain(NUMBERS_OF_BODY.map(|(name, unit)| Some(named(&whose, name, unit))))
        };
        let of_bodies = self.bodies.iter().enumerate().flat_map(of_body);
        gravity.into_iter().map(Some).chain(of_bodies).collect()
    }

    fn mismatch(&self, data: usize) -> String {
        let model = self.n();
        let joints = self.bodies.iter().map(|body| body.name.as_str()).collect::<Vec<_>>().join(", ");
        format!(
            "[model] urdf has {model} joints, in this order: {joints}; but the data has {data} coordinates; name the columns of all \
             joints in that order, or the joints that the log has, as [model] joints = [\"…\"] (others are held still)"
        )
    }

    fn open_gauge(&self) -> Option<OpenGauge> {
        (!self.shows_scale()).then_some(OpenGauge::Torques)
    }

    fn shows_scale(&self) -> bool {
        let is_known = |body: &ArmBody| {
            !body.is_learned && body.inertia[0] > 0.0 || !body.rotor.learned && body.rotor.value > 0.0
        };
        self.bodies.iter().any(is_known)
    }

    fn energies(&self) -> Result<Box<dyn Energies>, ModelError> {
        self.header().parameters()?;
        let joint = |(body, own): (TreeBody, &ArmBody)| {
            let mut numbers = [0.0; ARM_PARAMETERS];
            let places = numbers.iter_mut().zip(&own.frame);
            places.for_each(|(place, number)| *place = *number);
            let ArmParameters { rotation, place, axis, .. } = ArmParameters::from_array(numbers);
            ArmJoint { body, rotation, place, axis }
        };
        if self.bodies.len() != self.n() || self.bodies.iter().any(|body| body.frame.len() != FRAME) {
            return Err(ModelError::OutOfRange { what: "numbers of bodies" });
        }
        let energies = ArmEnergies::new(self.tree_bodies().zip(&self.bodies).map(joint).collect());
        Ok(Box::new(energies.map_err(ModelError::Tree)?))
    }

    fn loaded_type(&self) -> LoadedType {
        LoadedType::new("ArmModel", "N")
    }

    fn constant_type(&self) -> Result<ConstantType, &'static str> {
        Ok(tree_type(
            ["ArmBodies", "arm::ArmBodies", "ArmHeader"],
            self.with_header(|header| format!("{header:?}")),
        ))
    }
}

fn host_body(k: usize, body: TreeBody, own: &ArmBody, numbers: &ArmParameters<f64>) -> Body {
    use crate::tree::{Limits, Pose};
    use nalgebra::{Matrix3, Unit};
    let axis = Unit::new_normalize(numbers.axis.into());
    Body {
        name: format!("body {k}"),
        joint_name: own.name.clone(),
        parent: body.parent.map(usize::from),
        joint: match body.joint {
            Joint::Revolute => HostJoint::Revolute(axis),
            Joint::Prismatic => HostJoint::Prismatic(axis),
        },
        pose: Pose {
            rotation: Matrix3::from_row_iterator(numbers.rotation.iter().flatten().copied()),
            translation: numbers.place.into(),
        },
        coordinate: k,
        ratio: 1.0,
        offset: 0.0,
        inertia: Inertia(BodyInertia::into_array(numbers.inertia)),
        limits: Limits::none(),
    }
}
