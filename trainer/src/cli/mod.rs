//! What the commands of this project share: where words go, exit codes, and values of options. It knows of no parser of command
//! lines.

pub mod arguments;
mod output;

pub use output::{Failure, Output, folder, object, print, refuse, written};

/// What every command gives back.
pub type Done = Result<(), Failure>;
