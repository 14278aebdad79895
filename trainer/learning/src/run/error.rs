//! Errors that keep a run from beginning or going on.

use super::notice;
use super::plan::Plan;
use super::resume::ResumeError;
use crate::atomic::remedy;
use std::io;
use std::path::PathBuf;
use thiserror::Error;

/// A run that cannot begin or go on.
#[derive(Debug, Error)]
pub enum RunError {
    /// The folder is already in use.
    #[error("{} already exists; go on with --resume, start anew with --force, or choose another folder", folder.display())]
    Exists {
        /// The folder.
        folder: PathBuf,
    },
    /// The folder holds no run, but a file that a run would overwrite.
    #[error("{}: there is no run to replace, but a file {name} that training would overwrite; choose another folder", folder.display())]
    NoRun {
        /// The folder.
        folder: PathBuf,
        /// The file.
        name: &'static str,
    },
    /// The checkpoint does not allow the run to go on.
    #[error("cannot resume: {0}")]
    Resume(#[from] ResumeError),
    /// The folder cannot be written to.
    #[error("{}: {error}; {}, or choose another folder", folder.display(), remedy(error))]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// Error of the operating system.
        error: io::Error,
    },
    /// The last state could not be saved.
    #[error(
        "{}: cannot save iteration {iteration}: {error}; the checkpoint of iteration {saved} is intact: {} and go on from there \
         with --resume", folder.display(), remedy(error)
    )]
    Save {
        /// The folder.
        folder: PathBuf,
        /// Iteration that could not be saved.
        iteration: u64,
        /// Iteration that was saved last.
        saved: u64,
        /// Error of the operating system.
        error: io::Error,
    },
    /// The loss cannot be evaluated.
    #[error(
        "the {stage} loss cannot be evaluated at the weights of iteration {iteration}: the step cannot be solved there; {advice}"
    )]
    Stuck {
        /// Name of the stage.
        stage: &'static str,
        /// Iteration at whose weights the loss failed.
        iteration: u64,
        /// Advice on what to check.
        advice: String,
    },
    /// The threads could not be started.
    #[error("[training] threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

/// The error for a stage whose loss cannot be evaluated.
pub(super) fn stuck(plan: &Plan, stage: &'static str, iteration: u64) -> RunError {
    RunError::Stuck { stage, iteration, advice: notice::advice(plan.notices()) }
}
