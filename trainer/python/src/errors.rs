//! The package's exceptions, with the command's error messages.

use leastaction::cli::Failure;
use pyo3::prelude::*;
use std::fmt::Display;

/// An exception of `leastaction._errors`.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// Wrong use or unreadable input.
    Input,
    /// The work failed.
    Work,
    /// An equation has no solution.
    Solve,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Input => "InputError",
            Self::Work => "WorkError",
            Self::Solve => "SolveError",
        }
    }

    /// The exception with this message.
    pub fn says(self, message: impl Display) -> PyErr {
        let message = message.to_string();
        Python::attach(|py| {
            let made = py.import("leastaction._errors").and_then(|errors| errors.getattr(self.name()));
            made.and_then(|class| class.call1((message,))).map_or_else(|error| error, PyErr::from_value)
        })
    }
}

/// The exception for wrong use or unreadable input.
pub fn input(message: impl Display) -> PyErr {
    Kind::Input.says(message)
}

/// The exception for a command that failed.
pub fn failure(failure: Failure) -> PyErr {
    match failure {
        Failure::Input(message) => Kind::Input.says(message),
        Failure::Work(message) => Kind::Work.says(message),
        Failure::Interrupted(message) => pyo3::exceptions::PyKeyboardInterrupt::new_err(message),
        Failure::ClosedPipe => Kind::Work.says("nobody reads the output any more"),
    }
}
