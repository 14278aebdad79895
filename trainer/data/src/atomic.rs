//! Atomic writing: a file holds either the old or the new content, never half of each.

use std::ffi::OsStr;
use std::fs::{self, File, OpenOptions, Permissions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Writes `bytes` to `path`, replacing an existing file in one step.
///
/// # Errors
/// See [`write_with`].
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    write_with(path, |file| file.write_all(bytes))
}

/// Lets `fill` write a new file and moves it to `path` in one step.
///
/// The content goes to a temporary file in the same folder, which is flushed to the disk and renamed to `path`; then the folder is flushed,
/// too. A crash, a full disk or an error of `fill` leaves the old content and no temporary file (a killed process may leave one, named
/// `.NAME.*.tmp`). A symbolic link is kept, and its target is replaced. A device or pipe (`/dev/stdout`) cannot be replaced and is written
/// to directly.
///
/// # Errors
/// Errors of the file system (no such folder, no permission, no space), or the error of `fill`.
pub fn write_with(path: &Path, fill: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<()> {
    let target = resolve(path);
    match fs::metadata(&target) {
        Ok(meta) if meta.is_dir() => Err(io::Error::from(io::ErrorKind::IsADirectory)),
        Ok(meta) if !meta.is_file() => fill(&mut OpenOptions::new().write(true).open(&target)?),
        _ => replace(&target, fill),
    }
}

/// Remedy for a failure to write, as part of a sentence: "free some space".
#[must_use]
pub fn remedy(error: &io::Error) -> &'static str {
    use io::ErrorKind as Kind;
    match error.kind() {
        Kind::StorageFull => "free some space",
        Kind::QuotaExceeded => "free some space, for your share of the disk is used up",
        Kind::FileTooLarge => "raise the limit of the size of files (ulimit -f)",
        Kind::PermissionDenied => "have the permissions of the folder and its files changed",
        Kind::ReadOnlyFilesystem => "have the disk made writable",
        Kind::NotFound => "make the folder",
        Kind::NotADirectory | Kind::IsADirectory | Kind::AlreadyExists => "remove what stands in its place",
        Kind::ResourceBusy => "wait until it has ended",
        Kind::InvalidFilename => "shorten the name",
        _ => "see to that",
    }
}

/// The file behind a symbolic link, or the path itself.
fn resolve(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf())
}

fn replace(target: &Path, fill: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<()> {
    let folder = folder_of(target);
    if !folder.is_dir() {
        return Err(io::Error::new(
            io::ErrorKind::NotFound,
            format!("there is no folder {}", folder.display()),
        ));
    }
    let mut prefix = OsStr::new(".").to_os_string();
    prefix.push(target.file_name().ok_or(io::ErrorKind::InvalidInput)?);
    prefix.push(".");
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(".tmp");
    if let Some(permissions) = permissions_for(target) {
        builder.permissions(permissions);
    }
    // The error would show the temporary name, which means nothing to the user.
    let mut temporary = builder.tempfile_in(folder).map_err(|error| io::Error::from(error.kind()))?;
    fill(temporary.as_file_mut())?;
    temporary.as_file().sync_all()?;
    temporary.persist(target).map_err(|failed| failed.error)?;
    sync_folder(folder)
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// Permissions of the file that is replaced; without one, those of a new file (temporary files are private by default).
#[cfg(unix)]
fn permissions_for(target: &Path) -> Option<Permissions> {
    use std::os::unix::fs::PermissionsExt;
    let existing = fs::metadata(target).map(|meta| meta.permissions());
    Some(existing.unwrap_or_else(|_| Permissions::from_mode(0o666)))
}

#[cfg(not(unix))]
fn permissions_for(_: &Path) -> Option<Permissions> {
    None
}

/// Flushes a folder to the disk: only then does a rename in it survive a power cut.
#[cfg(unix)]
fn sync_folder(folder: &Path) -> io::Result<()> {
    File::open(folder)?.sync_all()
}

#[cfg(not(unix))]
fn sync_folder(_: &Path) -> io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut all: Vec<_> =
            fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        all.sort();
        all
    }

    #[test]
    fn replaces_and_leaves_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        write(&path, b"old and long").unwrap();
        write(&path, b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(names(folder.path()), ["a.bin"]);
    }

    #[test]
    fn failure_half_way_keeps_the_old_content() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        write(&path, b"old").unwrap();
        let error = write_with(&path, |file| {
            file.write_all(b"half")?;
            Err(io::ErrorKind::StorageFull.into())
        })
        .unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::StorageFull);
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["a.bin"]);
    }

    #[test]
    fn missing_folder_and_folder_as_target_are_errors() {
        let folder = tempfile::tempdir().unwrap();
        let missing = write(&folder.path().join("no/such/a.bin"), b"x").unwrap_err();
        assert_eq!(missing.kind(), io::ErrorKind::NotFound);
        assert_eq!(write(folder.path(), b"x").unwrap_err().kind(), io::ErrorKind::IsADirectory);
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn space_is_asked_for_where_it_is_missing() {
        let asked = |kind: io::ErrorKind| remedy(&kind.into()).contains("space");
        assert!(asked(io::ErrorKind::StorageFull));
        assert!(!asked(io::ErrorKind::PermissionDenied) && !asked(io::ErrorKind::NotADirectory));
        assert!(!asked(io::ErrorKind::ReadOnlyFilesystem) && !asked(io::ErrorKind::Other));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn full_device_is_an_error_and_stays_a_device() {
        use std::os::unix::fs::FileTypeExt;
        let full = Path::new("/dev/full");
        assert_eq!(write(full, b"x").unwrap_err().kind(), io::ErrorKind::StorageFull);
        assert!(fs::metadata(full).unwrap().file_type().is_char_device());
    }

    #[cfg(unix)]
    #[test]
    fn links_and_permissions_survive() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let (path, link) = (folder.path().join("a.bin"), folder.path().join("link"));
        write(&path, b"old").unwrap();
        fs::set_permissions(&path, Permissions::from_mode(0o640)).unwrap();
        symlink(&path, &link).unwrap();
        write(&link, b"new").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
    }
}
