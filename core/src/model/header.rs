use super::{ActuatorBytes, Family, Laws, ModelError, TrainedStep, TrainingRange};

/// The first four bytes of every model file.
pub const MAGIC: [u8; 4] = *b"LACT";
/// Format version that this build reads and writes.
pub const FORMAT_VERSION: u8 = 2;
/// Maximum number of coordinates.
pub(super) const MAX_COORDINATES: usize = 16;
/// Maximum number of coordinates of a tree.
pub(super) const MAX_TREE_COORDINATES: usize = 64;

/// Description of a model: everything except its weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Header<'a> {
    /// The family of the energies and its shape.
    pub family: Family<'a>,
    /// The laws of force in addition to the energies.
    pub laws: Laws<'a>,
    /// Actuator between command and force; `None`: the command is the force.
    pub actuator: Option<ActuatorBytes<'a>>,
    /// The step that the model was trained with, if any.
    pub trained_step: Option<TrainedStep>,
    /// Unit of every coordinate, `m` or `rad`, separated by commas. A single unit holds for all; an empty text states none.
    pub units: &'a str,
    /// Range of the training data; for several trees, the range of the first.
    pub range: Option<TrainingRange<'a>>,
    /// Provenance of the model: free text for people.
    pub provenance: &'a str,
}

impl<'a> Header<'a> {
    /// Header of a family alone: no laws, an ideal actuator, no step, no range, no text.
    pub const fn new(family: Family<'a>) -> Self {
        Self {
            family,
            laws: Laws::NONE,
            actuator: None,
            trained_step: None,
            units: "",
            range: None,
            provenance: "",
        }
    }

    /// Length of the weight block in numbers: the numbers of the energies, then those of the laws.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] for a shape that the format does not allow.
    pub fn parameters(&self) -> Result<usize, ModelError> {
        let (energies, laws) = (self.family.parameters()?, self.laws.parameters(self.family.groups()));
        sum(energies, laws)
    }
}

/// Adds the numbers of the energies and of the laws.
pub(super) fn sum(energies: usize, laws: Option<usize>) -> Result<usize, ModelError> {
    laws.and_then(|laws| energies.checked_add(laws))
        .ok_or(ModelError::OutOfRange { what: "number of weights" })
}

/// Whether all names are non-empty and distinct.
pub(super) fn are_names<'a>(names: impl Iterator<Item = &'a [u8]> + Clone) -> bool {
    let mut others = names.clone().enumerate();
    others.all(|(i, name)| !name.is_empty() && names.clone().take(i).all(|other| other != name))
}

/// Checks names that are separated by commas.
pub(super) fn check_names(names: &str, count: usize, of: &'static str) -> Result<(), ModelError> {
    // Splits bytes: splitting a str contains a panic that the compiler cannot exclude.
    let each = names.as_bytes().split(|byte| *byte == b',');
    let none = count == 0 && names.is_empty();
    if none || (each.clone().count() == count && are_names(each)) {
        return Ok(());
    }
    Err(ModelError::Names { of })
}

pub(super) fn require(condition: bool, what: &'static str) -> Result<(), ModelError> {
    if condition { Ok(()) } else { Err(ModelError::OutOfRange { what }) }
}
