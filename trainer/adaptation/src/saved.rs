//! Files for a controller and from it: settings of its adapter, and numbers that it found.

use crate::names::labels;
use crate::{AdaptationError, Choice, Followed, Label, with_distances};
use leastaction_core::adapt::{Following, Number, Patch, Saved, SettingsFile};
use leastaction_core::model::Layout;
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
    /// Reads a patch of a model, of whose file this is the [fingerprint](leastaction_core::model::fingerprint).
    ///
    /// # Errors
    /// [`AdaptationError::Patch`] for a patch that is damaged, or of another model.
    pub fn read((model, fingerprint): (&Model, u32), patch: &[u8]) -> Result<Self, AdaptationError> {
        let patch = Patch::<PLACES>::read(patch, fingerprint)?;
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
    /// Reads the settings for a control loop of N coordinates with ticks of h seconds, over the model of a file with this
    /// [fingerprint](leastaction_core::model::fingerprint).
    ///
    /// # Errors
    /// [`AdaptationError::Settings`] for settings that are damaged, or of another model or loop.
    pub fn read<const N: usize>(settings: &[u8], fingerprint: u32, h: f32) -> Result<Self, AdaptationError> {
        let file = SettingsFile::<Vec<f32>, Vec<Following>>::open::<N, PLACES>(settings, fingerprint)?;
        file.check_tick(h)?;
        let SettingsFile { block, settings, announcement, .. } = file;
        Ok(Self { settings, announcement, block })
    }

    /// The settings as a file for a control loop over the model of a file with this [fingerprint](leastaction_core::model::fingerprint).
    ///
    /// # Errors
    /// [`AdaptationError::Encoding`] if there are more numbers than places.
    pub fn settings_file(&self, fingerprint: u32) -> Result<Vec<u8>, AdaptationError> {
        let (settings, announcement) = (self.settings.clone(), self.announcement);
        let file = SettingsFile { model: fingerprint, block: self.block, settings, announcement };
        let mut memory = vec![0; SETTINGS_BYTES];
        let bytes = file.write(&mut memory).map_err(|error| AdaptationError::Encoding(error.to_string()))?;
        Ok(bytes.to_vec())
    }
}

impl Followed {
    /// The numbers in use at the end of the log, as a patch of the model of a file with this
    /// [fingerprint](leastaction_core::model::fingerprint).
    ///
    /// # Errors
    /// [`AdaptationError::Encoding`] if there are more numbers than places.
    pub fn patch(&self, fingerprint: u32) -> Result<Vec<u8>, AdaptationError> {
        let mut patch = Patch::<PLACES> { model: fingerprint, numbers: Default::default() };
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
