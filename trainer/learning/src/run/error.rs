//! Why a run cannot begin or go on.

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
    /// There is already something in the folder.
    #[error("{} already exists; go on with --resume, start anew with --force, or choose another folder", folder.display())]
    Exists {
        /// The folder.
        folder: PathBuf,
    },
    /// What is in the folder is no run, but files that a run would overwrite.
    #[error("{}: there is no run to replace, but a file {name} that training would overwrite; choose another folder", folder.display())]
    NoRun {
        /// The folder.
        folder: PathBuf,
        /// The file.
        name: &'static str,
    },
    /// The checkpoint does not allow to go on.
    #[error("cannot resume: {0}")]
    Resume(#[from] ResumeError),
    /// The folder cannot be written to.
    #[error("{}: {error}; {}, or choose another folder", folder.display(), remedy(error))]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// What the operating system said.
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
        /// That could not be saved.
        iteration: u64,
        /// That was saved last.
        saved: u64,
        /// What the operating system said.
        error: io::Error,
    },
    /// The loss cannot be evaluated.
    #[error(
        "the {stage} loss cannot be evaluated at the weights of iteration {iteration}: the step cannot be solved there; {advice}"
    )]
    Stuck {
        /// Name of the stage.
        stage: &'static str,
        /// Where.
        iteration: u64,
        /// What to look at.
        advice: String,
    },
    /// The threads could not be started.
    #[error("[training] threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

/// The loss of a stage cannot be evaluated.
pub(super) fn stuck(plan: &Plan, stage: &'static str, iteration: u64) -> RunError {
    RunError::Stuck { stage, iteration, advice: notice::advice(plan.notices()) }
}
