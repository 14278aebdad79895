//! Locks on folders that only one process at a time may write to.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

/// Name of the locked file. The file stays in the folder after the lock is released: if it were removed while another
/// process is about to lock it, a third process could lock a new file.
pub const FILE: &str = ".lock";

/// The right to write to a folder; released when dropped, and when the process ends in any way.
#[derive(Debug)]
pub struct Lock {
    _file: File,
}

impl Lock {
    /// Creates the folder if needed, and locks it. On a file system without locks nothing is locked.
    ///
    /// # Errors
    /// [`io::ErrorKind::ResourceBusy`] if another process has the lock; otherwise the error of the file system.
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
