//! Errors of `[model]` with their place in the configuration.

use super::problem::Problem;
use std::fmt;
use thiserror::Error;

/// One step of the path to a value of the configuration.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Step {
    /// Key of a table.
    Key(String),
    /// Position in an array, from 0.
    Index(usize),
}

impl Step {
    /// Returns the key; empty for a position.
    pub fn key(&self) -> &str {
        match self {
            Self::Key(key) => key,
            Self::Index(_) => "",
        }
    }

    /// Returns the position, if the step is one.
    pub fn index(&self) -> Option<usize> {
        match self {
            Self::Key(_) => None,
            Self::Index(index) => Some(*index),
        }
    }
}

impl From<&str> for Step {
    fn from(key: &str) -> Self {
        Self::Key(key.to_owned())
    }
}

impl From<usize> for Step {
    fn from(index: usize) -> Self {
        Self::Index(index)
    }
}

/// An invalid `[model]`, of any family.
#[derive(Clone, Debug, PartialEq, Error)]
pub struct ShapeError {
    /// Path from the top of the file to the value.
    pub place: Vec<Step>,
    /// Problem with the value.
    pub problem: Problem,
}

impl fmt::Display for ShapeError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        for (i, step) in self.place.iter().enumerate() {
            match step {
                Step::Key(key) if i == 0 => write!(f, "{key}")?,
                Step::Key(key) => write!(f, ".{key}")?,
                Step::Index(index) => write!(f, "[{index}]")?,
            }
        }
        write!(f, ": {}", self.problem)
    }
}

impl Problem {
    /// Returns this problem with its place in the configuration.
    pub(crate) fn at<const N: usize>(self, place: [Step; N]) -> ShapeError {
        let place = std::iter::once(Step::from("model")).chain(place).collect();
        ShapeError { place, problem: self }
    }
}
