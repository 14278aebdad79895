//! Files for a controller and from it: settings of its adapter, and numbers that it found.

use crate::names::labels;
use crate::{AdaptationError, Choice, Followed, Label, with_distances};
use leastaction_core::adapt::{Following, Number, Patch, Saved, SettingsFile};
use leastaction_core::model::{Layout, fingerprint};
use leastaction_models::Model;
use leastaction_replica::PLACES;

/// A patch of a model.
#[derive(Clone, Debug)]
pub struct Patched {
    /// The numbers with their distances from the model's.
    pub numbers: Vec<PatchedNumber>,
    /// The model with these distances. Gains and offsets of drives stay those of the file.
    pub model: Model,
}

/// A number of a patch.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchedNumber {
    /// Label of the number.
    pub label: Label,
    /// Value in the model; `None` for a number that the model's weights do not have.
    pub model: Option<f32>,
    /// Distance from it.
    pub distance: f32,
    /// Standard error of the distance.
    pub error: f32,
}

impl Patched {
    /// Reads a patch of a model.
    ///
    /// # Errors
    /// [`AdaptationError::Patch`] for a patch that is damaged, or of another model.
    pub fn read(model: &Model, patch: &[u8]) -> Result<Self, AdaptationError> {
        let patch = Patch::<PLACES>::read(patch, fingerprint_of(model)?)?;
        let numbers: Vec<Number> = patch.numbers.iter().map(|saved| saved.number).collect();
        let distances: Vec<f32> = patch.numbers.iter().map(|saved| saved.distance).collect();
        let (weights, laws) = (model.weights_f32(), model.architecture.laws());
        let layout = model.architecture.with_header(|family| Layout::of(&family, laws))?;
        let labels = labels(&numbers, &model.architecture.coordinates());
        let of = |(label, saved): (Label, &Saved)| PatchedNumber {
            label,
            model: layout.value(&weights, saved.number),
            distance: saved.distance,
            error: saved.error,
        };
        Ok(Self {
            numbers: labels.into_iter().zip(&patch.numbers).map(of).collect(),
            model: with_distances(model, (&numbers, &distances))?,
        })
    }
}

/// Bytes that hold the settings of as many numbers as there are places.
const SETTINGS_BYTES: usize = 8192;

impl Choice {
    /// Reads the settings for a control loop over a model of N coordinates, with ticks of h seconds.
    ///
    /// # Errors
    /// [`AdaptationError::Settings`] for settings that are damaged, or of another model or loop.
    pub fn read<const N: usize>(model: &Model, settings: &[u8], h: f32) -> Result<Self, AdaptationError> {
        let file =
            SettingsFile::<Vec<f32>, Vec<Following>>::open::<N, PLACES>(settings, fingerprint_of(model)?)?;
        file.check_tick(h)?;
        let SettingsFile { block, settings, announcement, .. } = file;
        Ok(Self { settings, announcement, block })
    }

    /// The settings as a file for a control loop over a model.
    ///
    /// # Errors
    /// [`AdaptationError::Encoding`] and [`AdaptationError::Model`] for a model that cannot be written as a file.
    pub fn settings_file(&self, model: &Model) -> Result<Vec<u8>, AdaptationError> {
        let (settings, announcement) = (self.settings.clone(), self.announcement);
        let file = SettingsFile { model: fingerprint_of(model)?, block: self.block, settings, announcement };
        let mut memory = vec![0; SETTINGS_BYTES];
        let bytes = file.write(&mut memory).map_err(|error| AdaptationError::Encoding(error.to_string()))?;
        Ok(bytes.to_vec())
    }
}

impl Followed {
    /// The numbers in use at the end of the log, as a patch of the model that they followed from.
    ///
    /// # Errors
    /// [`AdaptationError::Encoding`] and [`AdaptationError::Model`] for a model that cannot be written as a file.
    pub fn patch(&self, model: &Model) -> Result<Vec<u8>, AdaptationError> {
        let mut patch = Patch::<PLACES> { model: fingerprint_of(model)?, numbers: Default::default() };
        if let Some(last) = self.course.entries.last() {
            let found = last.estimates.iter().zip(&last.applied);
            let all = self.choice.settings.numbers.iter().zip(found);
            patch.numbers.extend(all.map(|(following, (found, distance))| Saved {
                number: following.number,
                distance: *distance,
                error: found.error,
            }));
        }
        patch_file(&patch)
    }
}

/// A patch as a file.
///
/// # Errors
/// [`AdaptationError::Encoding`] if it is longer than its own bound.
pub fn patch_file(patch: &Patch<PLACES>) -> Result<Vec<u8>, AdaptationError> {
    let mut memory = vec![0; Patch::<PLACES>::MAX_BYTES];
    let bytes = patch.write(&mut memory).map_err(|error| AdaptationError::Encoding(error.to_string()))?;
    Ok(bytes.to_vec())
}

/// Fingerprint of a model's file.
///
/// # Errors
/// [`AdaptationError::Encoding`] and [`AdaptationError::Model`] for a model that cannot be written as a file.
pub fn fingerprint_of(model: &Model) -> Result<u32, AdaptationError> {
    let bytes = model.to_bytes().map_err(|error| AdaptationError::Encoding(error.to_string()))?;
    Ok(fingerprint(&bytes)?)
}
