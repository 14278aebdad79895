//! What the commands of this project share: where words go, exit codes, and values of options. It knows of no parser of command
//! lines.

pub mod arguments;
mod output;
mod replaced;

pub use output::{Failure, Output, folder, object, print, refuse, written};
pub use replaced::{CONFIGURATION_HEAD, FileKind, MOTION_HEAD, replaceable};

/// What every command gives back.
pub type Done = Result<(), Failure>;
