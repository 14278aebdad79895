use super::Refusal;
use crate::control::{Plans, collected};
use crate::error::SetupError;
use leastaction_core::adapt::{SETTINGS_MAGIC, StoredSettings};
use leastaction_core::model::fingerprint;
use leastaction_core::plan::{Plan, PlanFile};

/// Files in a board's flash, one after the other, read in place: each begins at a word, after a word with its length in bytes. A length of 0,
/// one beyond the flash, and the end of the flash end the list.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Files<'a>(pub &'a [u32]);

impl<'a> Files<'a> {
    /// Puts files into the words of a memory, as they are in flash; `None` if they do not fit. Words beyond them stay as they are.
    pub fn put(memory: &'a mut [u32], files: &[&[u8]]) -> Option<Self> {
        let mut free = &mut *memory;
        for file in files {
            let (length, words) = free.split_first_mut()?;
            *length = u32::try_from(file.len()).ok()?;
            let (words, rest) = words.split_at_mut_checked(file.len().div_ceil(size_of::<u32>()))?;
            bytemuck::cast_slice_mut(words).get_mut(..file.len())?.copy_from_slice(file);
            free = rest;
        }
        let left = free.len();
        memory.get(..memory.len() - left).map(Self)
    }
}

impl<'a> Iterator for Files<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let (length, words) = self.0.split_first()?;
        let length = usize::try_from(*length).ok().filter(|length| *length > 0)?;
        let file = bytemuck::cast_slice(words).get(..length)?;
        self.0 = words.get(length.div_ceil(size_of::<u32>())..)?;
        Some(file)
    }
}

/// The files that programs use: a model, then plans for it, which the tasks [`Follow`](crate::Task::Follow) and [`Mpc`](crate::Task::Mpc) read,
/// and settings of an adapter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flash<'a>(pub Files<'a>);

impl<'a> Flash<'a> {
    /// The model; `None` if there is none.
    pub fn model(mut self) -> Option<&'a [u8]> {
        self.0.next()
    }

    /// The plans, checked against the model.
    pub(super) fn plans<const N: usize>(self) -> Result<Plans<'a, N>, Refusal> {
        let model = fingerprint(self.model().ok_or(Refusal::NoModel)?)?;
        let plans = self.0.skip(1).filter(|file| !are_settings(file));
        collected(plans.map(|file| read_plan(file, model)))
    }

    /// The plan to follow, checked against the model.
    pub(super) fn plan<const N: usize>(self) -> Result<Plan<'a, N, N>, Refusal> {
        self.plans()?.first().copied().ok_or(Refusal::NoPlan)
    }
}

impl Flash<'_> {
    /// The settings of an adapter for a loop with ticks of h seconds, checked against the model.
    pub(super) fn settings<const N: usize, const P: usize>(
        self,
        h: f32,
    ) -> Result<StoredSettings<N, P>, Refusal> {
        let model = fingerprint(self.model().ok_or(Refusal::NoModel)?)?;
        let file = self.0.skip(1).find(|file| are_settings(file)).ok_or(Refusal::NoSettings)?;
        let settings = StoredSettings::read(file, model)?;
        settings.check_tick(h)?;
        Ok(settings)
    }
}

fn are_settings(file: &[u8]) -> bool {
    file.starts_with(&SETTINGS_MAGIC)
}

/// Reads and validates a plan of N coordinates, of which any are driven, for the model with this fingerprint.
fn read_plan<const N: usize>(file: &[u8], model: u32) -> Result<Plan<'_, N, N>, Refusal> {
    let file = PlanFile::parse(file).map_err(SetupError::from)?;
    file.check_model(model).map_err(SetupError::from)?;
    Ok(Plan::at_most(file).map_err(SetupError::from)?)
}
