//! The shape of a tree of rigid bodies on the host.

use super::{Number, known_positions, letters_of_joints};
use crate::training::Range;
use leastaction_core::energy::bodies::{BODY_PARAMETERS, BodyParameters, GRAVITY_PARAMETERS, TreeBody};
use leastaction_core::model::{BodiesHeader, ModelError};
use leastaction_programs::energies::BodiesEnergies;
use serde::{Deserialize, Serialize};

/// The numbers of a body, in the order of [`BodyParameters`].
pub type BodyNumbers = [Number; BODY_PARAMETERS];

/// The shape of a tree of rigid bodies on joints in the plane, with the numbers that are known and those that are learned.
///
/// A number that is known to be 0 is no part of the programs of training, which are shorter for it.
///
/// Motion does not show all numbers. Of a chain of revolute joints it shows, of each body, ml of what it carries, mc and I + mc² in
/// sums over bodies, and J and g of a drive on a moving body as J(g² − g) alone. What it does not show stays near where it begins.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BodiesArchitecture {
    /// As in [`BodiesHeader::bodies`].
    pub tree: Vec<u8>,
    /// γ, m/s².
    pub gravity: [Number; GRAVITY_PARAMETERS],
    /// Of every body.
    pub numbers: Vec<BodyNumbers>,
}

impl BodiesArchitecture {
    /// A tree of these bodies with their numbers; `None` where a body sits on body 255 or beyond.
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

    /// The shape in the words of the model file.
    pub fn header(&self) -> BodiesHeader<'_> {
        BodiesHeader::planar(&self.tree)
    }

    /// The shape that a model file has; all numbers are known, as in the file.
    pub fn from_header(header: &BodiesHeader, weights: &[f64]) -> Self {
        let known = weights.iter().map(|weight| Number::known(*weight)).collect::<Vec<_>>();
        let (gravity, numbers) = known.split_at(known.len().min(GRAVITY_PARAMETERS));
        Self {
            tree: header.bodies.to_vec(),
            gravity: gravity.try_into().unwrap_or([Number::known(0.0); GRAVITY_PARAMETERS]),
            numbers: numbers.as_chunks().0.iter().take(header.n()).copied().collect(),
        }
    }

    /// The bodies in order; none that a model file cannot hold.
    pub fn bodies(&self) -> impl Iterator<Item = TreeBody> {
        self.header().bodies().flatten()
    }

    /// Number of coordinates n, one a body.
    pub fn n(&self) -> usize {
        self.header().n()
    }

    /// One letter a coordinate: `t` translation, `a` angle.
    pub fn coordinates(&self) -> String {
        letters_of_joints(self.bodies().map(|body| body.joint))
    }

    /// All numbers, in the order of the weight block.
    pub fn all_numbers(&self) -> impl Iterator<Item = Number> {
        self.gravity.iter().chain(self.numbers.iter().flatten()).copied()
    }

    /// The numbers as they are given, where training begins.
    pub fn initial_weights(&self) -> Vec<f64> {
        self.all_numbers().map(|number| number.value).collect()
    }

    /// The positions of the known numbers.
    pub fn fixed_positions(&self) -> Vec<usize> {
        known_positions(0, self.all_numbers())
    }

    /// The ranges of learned numbers: masses and inertias are above 0.
    pub fn ranges(&self) -> Vec<(usize, Range)> {
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

    /// Whether the scale of L is known without a force: a mass is, or an inertia.
    pub fn shows_scale(&self) -> bool {
        let bodies = self.numbers.iter().map(|numbers| BodyParameters::from_array(*numbers));
        let known = |number: Number| !number.learned && number.value > 0.0;
        bodies.into_iter().any(|body| [body.mass, body.inertia, body.rotor].into_iter().any(known))
    }

    /// Its energies, written down.
    ///
    /// # Errors
    /// [`ModelError`] where the bodies form no tree, or have not as many numbers.
    pub fn energies(&self) -> Result<BodiesEnergies, ModelError> {
        self.header().parameters()?;
        let energies = BodiesEnergies::new(self.bodies().collect()).map_err(ModelError::Tree)?;
        let zero = |number: Number| (!number.learned && number.value == 0.0).then_some(0.0);
        let known = energies.with_known(self.all_numbers().map(zero).collect());
        known.ok_or(ModelError::OutOfRange { what: "numbers of bodies" })
    }
}
