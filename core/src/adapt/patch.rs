use super::Number;
use super::adapter::{Adapter, Tuning};
use crate::frame::{FrameFault, Framed};
use crate::model::{File, WriteError};
use crate::scalar::Scalar;
use core::fmt;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// The first four bytes of every patch.
pub const PATCH_MAGIC: [u8; 4] = *b"LAPT";
/// Format version that this build reads and writes.
const FORMAT_VERSION: u8 = 1;

/// Distances of at most P numbers from those of a model's file, as they are saved: a mechanism is known better after it has run, and need not be
/// found anew after the power was off.
///
/// A patch is for one model, whose [fingerprint](crate::model::fingerprint) it holds. The byte table is in `core/FORMAT.md`: at most 11 bytes a
/// number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Patch<const P: usize> {
    /// Fingerprint of the model.
    #[serde(with = "postcard::fixint::le")]
    pub model: u32,
    /// The numbers.
    pub numbers: Vec<Saved, P>,
}

/// A number as it is saved.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Saved {
    /// The number.
    pub number: Number,
    /// Distance δ from the number of the model, as it was in use.
    pub distance: f32,
    /// Standard error of the estimate, at least 0.
    pub error: f32,
}

/// Largest number of bytes of a saved number, and of everything else in a patch.
const SAVED_BYTES: usize = 11;
const OTHER_BYTES: usize = 16;

impl<const P: usize> Patch<P> {
    /// Largest number of bytes of a patch.
    pub const MAX_BYTES: usize = OTHER_BYTES + SAVED_BYTES * P;

    /// Reads and validates a patch for the model with this [fingerprint](crate::model::fingerprint).
    ///
    /// # Errors
    /// See [`PatchError`].
    pub fn read(bytes: &[u8], fingerprint: u32) -> Result<Self, PatchError> {
        let patch = Self::of_any(bytes)?;
        let (saved, given) = (patch.model, fingerprint);
        if saved == given { Ok(patch) } else { Err(PatchError::OtherModel { saved, given }) }
    }

    /// Reads and validates a patch for any model.
    ///
    /// # Errors
    /// See [`PatchError`].
    pub fn of_any(bytes: &[u8]) -> Result<Self, PatchError> {
        let Framed { contents, .. } = Framed::open(bytes, PATCH_MAGIC, FORMAT_VERSION)?;
        let (patch, rest) = postcard::take_from_bytes::<Self>(contents).map_err(|_| PatchError::Malformed)?;
        if !rest.is_empty() {
            return Err(PatchError::Malformed);
        }
        let is_bad =
            |saved: &Saved| !(saved.distance.is_finite() && saved.error.is_finite() && saved.error >= 0.0);
        let bad = patch.numbers.iter().position(is_bad);
        bad.map_or(Ok(patch), |index| Err(PatchError::NotFinite { index: index as u8 }))
    }

    /// Writes the patch to the front of `memory`, which needs at most [`MAX_BYTES`](Self::MAX_BYTES), and returns that part.
    ///
    /// # Errors
    /// [`WriteError::TooShort`] if the memory is too short.
    pub fn write<'m>(&self, memory: &'m mut [u8]) -> Result<&'m [u8], WriteError> {
        let mut file = File::begin(memory, PATCH_MAGIC, FORMAT_VERSION)?;
        file.document(self)?;
        file.close()
    }

    /// Distance of a number; 0, the model's own, for one that the patch does not have.
    pub fn distance(&self, number: Number) -> f32 {
        let own = self.numbers.iter().find(|saved| saved.number == number);
        own.map_or(0.0, |saved| saved.distance)
    }
}

impl<const N: usize, const P: usize, const T: usize> Adapter<f32, N, P, T> {
    /// The distances in use, to be saved for the model with this [fingerprint](crate::model::fingerprint).
    pub fn patch(&self, tuning: &Tuning<f32, N, P>, model: u32) -> Patch<P> {
        let all = tuning.numbers.iter().zip(self.applied()).enumerate();
        let saved = all.map(|(j, (number, distance))| {
            let error = Scalar::sqrt(self.filter().variance(j));
            Saved { number: *number, distance: *distance, error }
        });
        let mut numbers = Vec::new();
        for saved in saved.filter(|saved| saved.number != Number::None) {
            // There are as many places as numbers.
            _ = numbers.push(saved);
        }
        Patch { model, numbers }
    }

    /// Begins with the distances of a patch, within the limits; what is known of them is what the prior says. Numbers that the patch does not
    /// have begin at those of the model, and numbers that do not follow here are left out.
    pub fn begin_with(&mut self, tuning: &Tuning<f32, N, P>, patch: &Patch<P>) {
        self.begin_at(tuning, tuning.numbers.map(|number| patch.distance(number)));
    }
}

/// Reason for refusing a patch.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PatchError {
    /// The file is no whole patch of this version.
    Frame(FrameFault),
    /// The patch is not a postcard document of this format, or has more numbers than the program has places.
    Malformed,
    /// A distance is infinite or not a number, or its standard error is none.
    NotFinite {
        /// Position of the number in the patch, from 0.
        index: u8,
    },
    /// The patch was saved for another model.
    OtherModel {
        /// Fingerprint of the model that the patch was saved for.
        saved: u32,
        /// Fingerprint of the model given.
        given: u32,
    },
}

impl From<FrameFault> for PatchError {
    fn from(fault: FrameFault) -> Self {
        Self::Frame(fault)
    }
}

impl fmt::Display for PatchError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Frame(fault) => fault.fmt(f),
            Self::Malformed => write!(f, "the patch is malformed, or has too many numbers"),
            Self::NotFinite { index } => {
                write!(
                    f,
                    "number {index} of the patch, or its standard error, is infinite, negative or not a number"
                )
            }
            Self::OtherModel { saved, given } => {
                write!(f, "saved for the model with fingerprint {saved:08x}, but the model has {given:08x}")
            }
        }
    }
}

impl core::error::Error for PatchError {}
