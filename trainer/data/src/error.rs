//! Errors in a file of logged motion, with their place.

use crate::place::Place;
use crate::problem::Problem;
use std::path::PathBuf;
use thiserror::Error;

/// A file that could not be read or written as logged motion.
#[derive(Debug, Error)]
#[error("{}{place}: {problem}", file.display())]
pub struct DataError {
    /// The file.
    pub file: PathBuf,
    /// Place in the file.
    pub place: Place,
    /// Problem at this place.
    pub problem: Problem,
}

/// A problem with its place, before the file is known.
pub(crate) type Fault = (Place, Problem);
