//! Collection of faults, so that one run reports all of them.

use super::error::{MOST_WRITTEN, UrdfError};

/// Faults found so far.
#[derive(Default)]
pub(super) struct Faults(Vec<UrdfError>);

impl Faults {
    pub fn push(&mut self, fault: UrdfError) {
        self.0.push(fault);
    }

    /// Whether more would not be written out.
    pub fn are_many(&self) -> bool {
        self.0.len() > MOST_WRITTEN
    }

    /// Returns the value, or keeps the fault.
    pub fn take<T>(&mut self, found: Result<T, UrdfError>) -> Option<T> {
        found.map_err(|fault| self.push(fault)).ok()
    }

    /// Fails if there is a fault.
    pub fn end(mut self) -> Result<(), UrdfError> {
        match self.0.len() {
            0 => Ok(()),
            1 => self.0.pop().map_or(Ok(()), Err),
            _ => Err(UrdfError::Several(self.0)),
        }
    }
}
