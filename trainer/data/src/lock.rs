//! Folders that one process at a time writes to.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

/// The file that is locked. It stays in the folder when the lock is gone: whoever removes it while another process is about to
/// lock it lets in a third.
pub const FILE: &str = ".lock";

/// The right to write to a folder; gone with the value, and with the process however it ends.
#[derive(Debug)]
pub struct Lock {
    _file: File,
}

impl Lock {
    /// Makes the folder where there is none, and locks it. On a disk that has no locks nothing is locked.
    ///
    /// # Errors
    /// [`io::ErrorKind::ResourceBusy`] where another process has the lock; else what the file system reports.
    pub fn new(folder: &Path) -> io::Result<Self> {
        fs::create_dir_all(folder)?;
        let file = File::options().write(true).create(true).truncate(false).open(file(folder))?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => {
                Err(io::Error::new(io::ErrorKind::ResourceBusy, "another process is writing to this folder"))
            }
            Err(TryLockError::Error(error)) if error.kind() != io::ErrorKind::Unsupported => Err(error),
            Err(TryLockError::Error(_)) | Ok(()) => Ok(Self { _file: file }),
        }
    }
}

/// The file that [`Lock::new`] locks in a folder.
#[must_use]
pub fn file(folder: &Path) -> PathBuf {
    folder.join(FILE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_locked_until_the_lock_is_dropped() {
        let parent = tempfile::tempdir().unwrap();
        let folder = parent.path().join("a/b");
        let lock = Lock::new(&folder).unwrap();
        let error = Lock::new(&folder).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::ResourceBusy);
        assert!(error.to_string().contains("another process"), "{error}");
        drop(lock);
        Lock::new(&folder).unwrap();
    }

    #[test]
    fn a_file_in_its_place_is_an_error() {
        let parent = tempfile::tempdir().unwrap();
        let path = parent.path().join("file");
        fs::write(&path, "mine").unwrap();
        assert!(Lock::new(&path).is_err());
        assert_eq!(fs::read(&path).unwrap(), b"mine");
    }
}
