//! The folder of a paper's results: one file per finished task, and the pictures.

use super::record::Finished;
use super::task::Task;
use leastaction_learning::atomic;
use leastaction_learning::checksummed::ReadError;
use leastaction_learning::lock::Lock;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::{fs, io};
use thiserror::Error;

/// Reason why results, or the state of training, cannot be read or written.
#[derive(Debug, Error)]
pub enum FolderError {
    /// A file cannot be read or written.
    #[error("{}: {error}", file.display())]
    File {
        /// The file.
        file: PathBuf,
        /// Reason given by the operating system.
        error: io::Error,
    },
    /// The content is not a result of this program.
    #[error("{}: {error}; remove the file to have the task done again", file.display())]
    Content {
        /// The file.
        file: PathBuf,
        /// Problem with the content.
        error: serde_json::Error,
    },
    /// Interrupted training that cannot be read.
    #[error("{0}; remove the file to begin anew")]
    Interrupted(#[from] ReadError),
    /// The file was made with other options.
    #[error("{}: made with other options; name another folder, or remove the file", file.display())]
    Settings {
        /// The file.
        file: PathBuf,
    },
    /// Two folders have the same task with different results.
    #[error("{} and {} are results of one task and differ; keep one", one.display(), other.display())]
    Twice {
        /// The file read first.
        one: PathBuf,
        /// The file read second.
        other: PathBuf,
    },
}

impl FolderError {
    /// Converts an error of the operating system.
    pub(crate) fn file(file: &Path) -> impl FnOnce(io::Error) -> Self {
        let file = file.to_owned();
        move |error| Self::File { file, error }
    }
}

/// Results of one paper.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Results {
    folder: PathBuf,
}

impl Results {
    /// Opens the results in `output`/`paper`, a folder that is created if it does not exist.
    ///
    /// # Errors
    /// [`FolderError::File`].
    pub fn open(output: &Path, paper: &str) -> Result<Self, FolderError> {
        let folder = output.join(paper);
        fs::create_dir_all(&folder).map_err(FolderError::file(&folder))?;
        Ok(Self { folder })
    }

    /// Keeps other processes from writing to the folder.
    ///
    /// # Errors
    /// [`FolderError::File`] if another process holds the lock.
    pub fn lock(&self) -> Result<Lock, FolderError> {
        Lock::new(&self.folder).map_err(FolderError::file(&self.folder))
    }

    /// Folder of the files.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// File of a task.
    pub fn file(&self, task: &str) -> PathBuf {
        self.folder.join(format!("{task}.json"))
    }

    /// Reads the results of a task; `None` if it has not been done yet.
    ///
    /// # Errors
    /// [`FolderError::File`], [`FolderError::Content`].
    pub fn read(&self, task: &str) -> Result<Option<Finished>, FolderError> {
        read(&self.file(task))
    }

    /// Writes the results of a task.
    ///
    /// # Errors
    /// [`FolderError::File`].
    pub fn write(&self, finished: &Finished) -> Result<(), FolderError> {
        let file = self.file(&finished.task);
        let text = serde_json::to_vec_pretty(finished)
            .map_err(|error| FolderError::Content { file: file.clone(), error })?;
        atomic::write(&file, &text).map_err(FolderError::file(&file))
    }

    /// Reads all results, in the order of the names of the tasks.
    ///
    /// # Errors
    /// [`FolderError::File`], [`FolderError::Content`].
    pub fn all(&self) -> Result<Vec<Finished>, FolderError> {
        let files = self.files(|file| file.extension().is_some_and(|extension| extension == "json"))?;
        let read = files.iter().map(|file| read(file)).collect::<Result<Vec<_>, _>>()?;
        Ok(read.into_iter().flatten().collect())
    }

    /// Results that belong on one page: those of these tasks, and all others in the folder from runs with the same
    /// options. They are in the order of these tasks, then ordered by name. Also returns the number of results with
    /// other options.
    ///
    /// # Errors
    /// [`FolderError::File`], [`FolderError::Content`].
    pub fn page(&self, tasks: &[Task]) -> Result<(Vec<Finished>, usize), FolderError> {
        let place: HashMap<&str, usize> =
            tasks.iter().enumerate().map(|(k, task)| (task.name.as_str(), k)).collect();
        let belongs = |finished: &Finished| {
            let is_it = |task: &Task| task.name == finished.task && task.settings == finished.settings;
            tasks.iter().any(|task| task.options == finished.options || is_it(task))
        };
        let (mut page, others): (Vec<_>, Vec<_>) = self.all()?.into_iter().partition(belongs);
        page.sort_by_key(|finished| place.get(finished.task.as_str()).copied().unwrap_or(tasks.len()));
        Ok((page, others.len()))
    }

    /// Copies the results and the other files of another folder; results in both folders must be equal.
    ///
    /// # Errors
    /// [`FolderError`].
    pub fn join(&self, other: &Self) -> Result<(), FolderError> {
        for file in other.files(|_| true)? {
            let Some(name) = file.file_name() else { continue };
            let target = self.folder.join(name);
            if let (Some(ours), Some(theirs)) = (done(&target)?, done(&file)?) {
                if ours.settings != theirs.settings || ours.records != theirs.records {
                    return Err(FolderError::Twice { one: target, other: file });
                }
                continue;
            }
            fs::copy(&file, &target).map_err(FolderError::file(&target))?;
        }
        Ok(())
    }

    fn files(&self, is_wanted: impl Fn(&Path) -> bool) -> Result<Vec<PathBuf>, FolderError> {
        let failed = || FolderError::file(&self.folder);
        let mut files = Vec::new();
        for entry in fs::read_dir(&self.folder).map_err(failed())? {
            files.push(entry.map_err(failed())?.path());
        }
        // Hidden files are the lock, and files that a killed process was writing.
        let is_hidden =
            |file: &Path| file.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"."));
        files.retain(|file| file.is_file() && !is_hidden(file) && is_wanted(file));
        files.sort();
        Ok(files)
    }
}

/// Reads the results in a file, unless the task failed.
fn done(file: &Path) -> Result<Option<Finished>, FolderError> {
    if file.extension().is_none_or(|extension| extension != "json") {
        return Ok(None);
    }
    Ok(read(file)?.filter(|finished| finished.failure.is_none()))
}

fn read(file: &Path) -> Result<Option<Finished>, FolderError> {
    let text = match fs::read(file) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        text => text.map_err(FolderError::file(file))?,
    };
    serde_json::from_slice(&text)
        .map(Some)
        .map_err(|error| FolderError::Content { file: file.to_owned(), error })
}
