//! Models ready for the solvers: the system of a family over the weights of a file, and what else the file says.

use super::load_forces::load_forces;
use super::parse::parse_knowing;
use super::{
    ActuatorBytes, Law, LawNumbers, Laws, LoadForces, ModelError, ParsedAs, Sections, ShapeHeader,
    TrainedStep, TrainingRange,
};
use crate::discrete::{Del, Path};
use crate::scalar::{FileWeightFormat, Real, Scalar, WeightFormat};

/// A loaded model: the system, and what the file says about its use.
///
/// Loading validates everything that the program reads, once; evaluation cannot fail afterwards except numerically.
#[derive(Clone, Copy, Debug)]
pub struct Model<'a, M> {
    /// The system that the solvers step.
    pub system: M,
    /// The step that the model was trained with, if any.
    pub trained_step: Option<TrainedStep>,
    /// The sections of the file.
    pub sections: Sections<'a>,
    /// Whether the range of the training data applies to this system: the file gives it for the first tree or graph only.
    covered: bool,
}

impl<'a, M> Model<'a, M> {
    /// Loads a file of any family. `system` builds the family's system from the file, and says whether that system is
    /// the file's first.
    pub(super) fn read<H: ShapeHeader<'a>, W: FileWeightFormat>(
        bytes: &'a [u8],
        knows: impl Fn(Law) -> bool,
        system: impl FnOnce(&ParsedAs<'a, H, W>) -> Result<(M, bool), ModelError>,
    ) -> Result<Self, ModelError> {
        let parsed = parse_knowing::<H, W>(bytes, knows)?;
        let (system, covered) = system(&parsed)?;
        let ParsedAs { trained_step, sections, .. } = parsed;
        Ok(Self { system, trained_step, sections, covered })
    }

    /// A model made of the program's constants, without a file behind it.
    pub const fn constant(system: M, trained_step: Option<TrainedStep>) -> Self {
        Self { system, trained_step, sections: Sections::NONE, covered: false }
    }

    /// Replaces the system by one made from it; all else stays.
    ///
    /// # Errors
    /// The errors of `make`.
    pub fn try_map<T, E>(self, make: impl FnOnce(M) -> Result<T, E>) -> Result<Model<'a, T>, E> {
        let Self { system, trained_step, sections, covered } = self;
        Ok(Model { system: make(system)?, trained_step, sections, covered })
    }

    /// The step that the model was trained with.
    ///
    /// # Errors
    /// [`ModelError::NoStep`] if the model was trained for none.
    pub fn step(&self) -> Result<TrainedStep, ModelError> {
        self.trained_step.ok_or(ModelError::NoStep)
    }

    /// The integrator that the model was trained with, along paths of type `P`.
    ///
    /// # Errors
    /// [`ModelError::NoStep`] if the model was trained for none, [`ModelError::Order`] if `P` has another order.
    pub fn del<R: Real, P: Path>(&self) -> Result<Del<R, P>, ModelError> {
        self.step()?.del()
    }

    /// Actuator between command and force; `None`: the command is the force.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] if one of the actuator's numbers is out of range.
    pub fn actuator(&self) -> Result<Option<ActuatorBytes<'a>>, ModelError> {
        self.sections.actuator()
    }

    /// Range of this system's training data, if the file has it.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] if one of the range's numbers is out of range.
    pub fn range(&self) -> Result<Option<TrainingRange<'a>>, ModelError> {
        if self.covered { self.sections.range() } else { Ok(None) }
    }
}

/// Loads the forces of a file's laws if every coordinate is a group of its own.
pub(super) fn forces_of_coordinates<'w, W, S, F, const N: usize>(
    laws: Laws,
    numbers: &'w [W],
) -> Result<F, ModelError>
where
    W: WeightFormat<Wide = S::Weight>,
    S: Scalar,
    F: LoadForces<'w, W, S, N>,
{
    load_forces(LawNumbers::new(laws, numbers, N), &core::array::from_fn(|i| i as u8))
}
