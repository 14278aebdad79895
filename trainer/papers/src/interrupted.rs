//! Training that takes hours, and continues where it was interrupted.

use super::folder::FolderError;
use super::task::TaskError;
use leastaction_learning::checksummed;
use leastaction_learning::training::Adam;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::time::Duration;
use std::{fs, io};

/// First bytes of the file: a signature, and the version of its layout.
const MAGIC: &[u8] = b"LABASE\x01";

/// File in which a task stores the state of its training.
#[derive(Clone, Debug)]
pub struct Interrupted {
    file: PathBuf,
    settings: String,
}

/// State of a training.
#[derive(Serialize, Deserialize)]
pub(super) struct Course {
    pub adam: Adam,
    /// Last weights that had a finite loss.
    pub good: Vec<f64>,
    /// Time spent on training.
    pub spent: Duration,
}

#[derive(Serialize, Deserialize)]
struct Content<S, C> {
    settings: S,
    course: C,
}

impl Interrupted {
    /// Creates the file of a task in a folder; `settings` is everything on which the weights depend.
    pub fn new(folder: &Path, task: &str, settings: String) -> Self {
        Self { file: folder.join(format!("{task}.interrupted")), settings }
    }

    /// Runs a task that stores its state in a folder, if one is given, and continues where it was interrupted.
    pub(super) fn resume<T, E: Into<TaskError>>(
        folder: Option<&Path>,
        task: &str,
        settings: String,
        run: impl FnOnce(Option<&Self>) -> Result<T, E>,
    ) -> Result<T, TaskError> {
        let interrupted = folder.map(|folder| Self::new(folder, task, settings));
        let done = run(interrupted.as_ref()).map_err(Into::into)?;
        interrupted.map_or(Ok(()), |interrupted| interrupted.done())?;
        Ok(done)
    }

    /// Reads the state at which training was interrupted; `None` if there is none.
    pub(super) fn read(&self) -> Result<Option<Course>, FolderError> {
        let content: Content<String, Course> = match checksummed::read(&self.file, MAGIC) {
            Err(error) if error.is_missing() => return Ok(None),
            content => content?,
        };
        let is_this = content.settings == self.settings;
        let file = self.file.clone();
        if is_this { Ok(Some(content.course)) } else { Err(FolderError::Settings { file }) }
    }

    pub(super) fn write(&self, course: &Course) -> Result<(), FolderError> {
        let content = Content { settings: &self.settings, course };
        checksummed::write(&self.file, MAGIC, &content).map_err(FolderError::file(&self.file))
    }

    /// Removes the file.
    fn done(&self) -> Result<(), FolderError> {
        match fs::remove_file(&self.file) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
            done => done.map_err(FolderError::file(&self.file)),
        }
    }
}
