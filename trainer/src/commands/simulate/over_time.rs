//! Values that change with time.

use leastaction_firmware_sim::Timeline;

/// A value from the beginning, and others, each from its time on, s, in the order of their times.
pub struct OverTime<T> {
    pub(super) first: T,
    pub(super) later: Vec<(f32, T)>,
}

impl<T> OverTime<T> {
    /// A value from the beginning, and others from their times on, which ascend.
    pub const fn new(first: T, later: Vec<(f32, T)>) -> Self {
        Self { first, later }
    }

    /// The values as functions of these.
    ///
    /// # Errors
    /// The first error of a function.
    pub fn map<'t, U, E>(&'t self, of: impl Fn(&'t T) -> Result<U, E>) -> Result<OverTime<U>, E> {
        let later = self.later.iter().map(|(since, value)| Ok((*since, of(value)?)));
        Ok(OverTime { first: of(&self.first)?, later: later.collect::<Result<_, E>>()? })
    }

    /// References to the values.
    pub fn each(&self) -> OverTime<&T> {
        OverTime {
            first: &self.first,
            later: self.later.iter().map(|(since, value)| (*since, value)).collect(),
        }
    }
}

impl<M> OverTime<&M> {
    /// The mechanism as a function of time.
    pub fn timeline(&self) -> Timeline<'_, M> {
        Timeline::new(self.first, &self.later)
    }
}
