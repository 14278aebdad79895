//! Host-side shape of a tree of planar rigid bodies.

pub mod config;
pub mod describe;
mod host;

use super::{letters_of_joints, tree_type};
use crate::bounds::Range;
use crate::family::{Family, OpenGauge};
use crate::names::{NumberName, named};
use crate::number::{Number, known_positions};
use crate::source::{ConstantType, LoadedType};
use leastaction_core::energy::bodies::{BODY_PARAMETERS, BodyParameters, GRAVITY_PARAMETERS, TreeBody};
use leastaction_core::model::{BodiesHeader, Laws, ModelError};
use leastaction_programs::energies::{BodiesEnergies, Energies};
use serde::{Deserialize, Serialize};

/// Numbers of a body, in the order of [`BodyParameters`].
pub type BodyNumbers = [Number; BODY_PARAMETERS];

/// Shape of a tree of rigid bodies on joints in the plane, with its known and its learned numbers.
///
/// Numbers that are known to be 0 are left out of the training programs, which makes them shorter.
///
/// Motion does not determine all numbers. For a chain of revolute joints it determines only sums over bodies: for each
/// body, m l of the bodies that it carries, m c and I + m c². For a drive on a moving body, J and g appear only as J(g²
/// − g). A number that motion does not determine stays near its initial value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BodiesArchitecture {
    /// Encoded tree, see [`BodiesHeader::bodies`].
    pub tree: Vec<u8>,
    /// γ, m/s².
    pub gravity: [Number; GRAVITY_PARAMETERS],
    /// Numbers of every body.
    pub numbers: Vec<BodyNumbers>,
}

impl BodiesArchitecture {
    /// Returns a tree of these bodies with their numbers; `None` if a body sits on body 255 or beyond.
    pub fn new(
        gravity: [Number; GRAVITY_PARAMETERS],
        bodies: impl IntoIterator<Item = (TreeBody, BodyParameters<Number>)>,
    ) -> Option<Self> {
        let (mut tree, mut numbers) = (Vec::new(), Vec::new());
        for (body, own) in bodies {
            tree.extend(body.to_bytes()?);
            numbers.push(own.into_array());
        }
        Some(Self { tree, gravity, numbers })
    }

    /// Calls `read` with the shape as the model file states it.
    pub(crate) fn with_header<T>(&self, read: impl FnOnce(BodiesHeader) -> T) -> T {
        read(self.header())
    }

    /// Shape as the model file states it.
    pub fn header(&self) -> BodiesHeader<'_> {
        BodiesHeader::planar(&self.tree)
    }

    /// Returns the shape described by a model file; all numbers are known, as in the file.
    pub(crate) fn from_header(header: &BodiesHeader, _: Laws, weights: &[f64]) -> Self {
        let known = weights.iter().map(|weight| Number::known(*weight)).collect::<Vec<_>>();
        let (gravity, numbers) = known.split_at(known.len().min(GRAVITY_PARAMETERS));
        Self {
            tree: header.bodies.to_vec(),
            gravity: gravity.try_into().unwrap_or([Number::known(0.0); GRAVITY_PARAMETERS]),
            numbers: numbers.as_chunks().0.iter().take(header.n()).copied().collect(),
        }
    }

    /// Bodies in order; any body that a model file cannot hold is left out.
    pub fn bodies(&self) -> impl Iterator<Item = TreeBody> {
        self.header().bodies().flatten()
    }

    /// The shape with learned numbers taken from a weight block of the same bodies.
    #[must_use]
    pub fn with_learned_of(&self, weights: &[f64]) -> Self {
        let mut own = self.clone();
        let numbers = own.gravity.iter_mut().chain(own.numbers.iter_mut().flatten());
        for (number, value) in numbers.zip(weights).filter(|(number, _)| number.learned) {
            number.value = *value;
        }
        own
    }

    /// All numbers, in the order of the weight block.
    pub fn all_numbers(&self) -> impl Iterator<Item = Number> {
        self.gravity.iter().chain(self.numbers.iter().flatten()).copied()
    }
}

impl Family for BodiesArchitecture {
    fn n(&self) -> usize {
        self.header().n()
    }

    fn coordinates(&self) -> String {
        letters_of_joints(self.bodies().map(|body| body.joint))
    }

    fn initial_weights(&self, _: u64) -> Vec<f64> {
        self.all_numbers().map(|number| number.value).collect()
    }

    fn fixed_positions(&self) -> Vec<usize> {
        known_positions(0, self.all_numbers())
    }

    fn ranges(&self) -> Vec<(usize, Range)> {
        let of_body = BodyParameters {
            place: [Range::Any; 2],
            angle: Range::Any,
            mass: Range::Positive,
            centre: [Range::Any; 2],
            inertia: Range::Positive,
            rotor: Range::Positive,
            gear: Range::Any,
        };
        let of_bodies = self.numbers.iter().flat_map(|_| of_body.into_array());
        let ranges = [Range::Any; GRAVITY_PARAMETERS].into_iter().chain(of_bodies);
        let each = self.all_numbers().zip(ranges).enumerate();
        each.filter(|(_, (number, _))| number.learned).map(|(at, (_, range))| (at, range)).collect()
    }

    fn masses(&self) -> Vec<Vec<usize>> {
        // Mass, inertia and rotor of every body.
        let of_body = |k: usize| [3, 6, 7].map(|i| GRAVITY_PARAMETERS + BODY_PARAMETERS * k + i).to_vec();
        (0..self.numbers.len()).map(of_body).collect()
    }

    fn number_names(&self) -> Vec<Option<NumberName>> {
        let gravity =
            ["x", "y"].map(|axis| NumberName { name: format!("gravity along {axis}"), unit: "m/s²" });
        let of_bodies = (0..self.n()).flat_map(|k| names_of_body(&format!("body {k}")));
        gravity.into_iter().chain(of_bodies).map(Some).collect()
    }

    fn mismatch(&self, data: usize) -> String {
        let model = self.n();
        format!(
            "[model] has {model} bodies, one a coordinate, but the data has {data} coordinates; name the bodies in the order of q, \
             or set chain = {data}"
        )
    }

    fn open_gauge(&self) -> Option<OpenGauge> {
        (!self.shows_scale()).then_some(OpenGauge::Masses { types: "bodies", of: "tree" })
    }

    fn shows_scale(&self) -> bool {
        let bodies = self.numbers.iter().map(|numbers| BodyParameters::from_array(*numbers));
        let known = |number: Number| !number.learned && number.value > 0.0;
        bodies.into_iter().any(|body| [body.mass, body.inertia, body.rotor].into_iter().any(known))
    }

    fn energies(&self) -> Result<Box<dyn Energies>, ModelError> {
        self.header().parameters()?;
        let energies = BodiesEnergies::new(self.bodies().collect()).map_err(ModelError::Tree)?;
        let zero = |number: Number| (!number.learned && number.value == 0.0).then_some(0.0);
        let known = energies.with_known(self.all_numbers().map(zero).collect());
        Ok(Box::new(known.ok_or(ModelError::OutOfRange { what: "numbers of bodies" })?))
    }

    fn loaded_type(&self) -> LoadedType {
        LoadedType::new("BodiesModel", "N")
    }

    fn constant_type(&self) -> Result<ConstantType, &'static str> {
        Ok(tree_type(
            ["PlanarBodies", "bodies::PlanarBodies", "BodiesHeader"],
            self.with_header(|header| format!("{header:?}")),
        ))
    }
}

/// Names of the numbers of a body, in the order of the weight block.
fn names_of_body(whose: &str) -> [NumberName; BODY_PARAMETERS] {
    let number = |name, unit| named(whose, name, unit);
    let numbers = BodyParameters {
        place: [number("joint x in the parent", "m"), number("joint y in the parent", "m")],
        angle: number("angle in the parent", "rad"),
        mass: number("mass", "kg"),
        centre: [number("centre of mass x", "m"), number("centre of mass y", "m")],
        inertia: number("inertia about the centre of mass", "kg m²"),
        rotor: number("inertia of the rotor", "kg m²"),
        gear: number("gear ratio", ""),
    };
    numbers.into_array()
}
