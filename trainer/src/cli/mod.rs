//! Common parts of the project's commands: output, exit codes, and option values. This module is independent of any command-line parser.

pub mod arguments;
mod output;
mod replaced;

pub use output::{Failure, Output, folder, object, print, refuse, written};
pub use replaced::{CONFIGURATION_HEAD, FileKind, MOTION_HEAD, replaceable};

/// The result of a command.
pub type Done = Result<(), Failure>;
