//! Models ready for the solvers: a family's system over the weights of a file, with what else the file says.

use super::laws::load_forces;
use super::parse::parse_knowing;
use super::{
    ActuatorBytes, Law, LawNumbers, Laws, LoadForces, ModelError, ParsedAs, Sections, ShapeHeader,
    TrainedStep, TrainingRange,
};
use crate::discrete::{Del, Path};
use crate::scalar::{FileWeightFormat, Real, Scalar, WeightFormat};

/// A loaded model: the system, and what the file says of its use.
///
/// Loading validates everything that the program reads, once; evaluation cannot fail afterwards except numerically.
#[derive(Clone, Copy, Debug)]
pub struct Model<'a, M> {
    /// What the solvers step.
    pub system: M,
    /// The step that the model was trained with, where it was.
    pub trained_step: Option<TrainedStep>,
    /// The sections of the file.
    pub sections: Sections<'a>,
    /// Whether the range of the training data is that of this system: of several trees or graphs, of the first.
    covered: bool,
}

impl<'a, M> Model<'a, M> {
    /// The one way to load: the file, then the system that a family makes of it, and whether that is the first of the file.
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

    /// A model that is constants of the program: there is no file that says more of it.
    pub const fn constant(system: M, trained_step: Option<TrainedStep>) -> Self {
        Self { system, trained_step, sections: Sections::NONE, covered: false }
    }

    /// The same file with another system, made of this one.
    ///
    /// # Errors
    /// Those of `make`.
    pub fn try_map<T, E>(self, make: impl FnOnce(M) -> Result<T, E>) -> Result<Model<'a, T>, E> {
        let Self { system, trained_step, sections, covered } = self;
        Ok(Model { system: make(system)?, trained_step, sections, covered })
    }

    /// The step that the model was trained with.
    ///
    /// # Errors
    /// [`ModelError::NoStep`] where it was trained for none.
    pub fn step(&self) -> Result<TrainedStep, ModelError> {
        self.trained_step.ok_or(ModelError::NoStep)
    }

    /// The integrator that the model was trained with, along paths of type `P`.
    ///
    /// # Errors
    /// [`ModelError::NoStep`] where it was trained for none, [`ModelError::Order`] where `P` has another order.
    pub fn del<R: Real, P: Path>(&self) -> Result<Del<R, P>, ModelError> {
        self.step()?.del()
    }

    /// Between command and force; `None`: the command is the force.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] where a number is.
    pub fn actuator(&self) -> Result<Option<ActuatorBytes<'a>>, ModelError> {
        self.sections.actuator()
    }

    /// What the training data of this system covered, where the file says it.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] where a number is.
    pub fn range(&self) -> Result<Option<TrainingRange<'a>>, ModelError> {
        if self.covered { self.sections.range() } else { Ok(None) }
    }
}

/// The forces of a file's laws where a coordinate is a group of its own.
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
