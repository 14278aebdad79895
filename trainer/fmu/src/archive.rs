use crate::{Description, IDENTIFIER, RESOURCE, Version};
use std::env::consts::{ARCH, DLL_SUFFIX, OS};
use std::io::{Cursor, Write};
use thiserror::Error;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// Reason why an archive cannot be made.
#[derive(Debug, Error)]
pub enum ArchiveError {
    /// The standard has no name for this machine.
    #[error("FMI {version} has no name for libraries of {OS} on {ARCH}")]
    Platform {
        /// Version of the standard.
        version: Version,
    },
    /// Bytes are not the library.
    #[error(
        "this is not the library of units: it does not contain {missing}; `cargo build --release -p leastaction-fmu` builds it"
    )]
    Library {
        /// Function that the library lacks.
        missing: &'static str,
    },
    /// The archive cannot be written.
    #[error("the archive cannot be written: {0}")]
    Zip(#[from] zip::result::ZipError),
    /// A file of the archive cannot be written.
    #[error("the archive cannot be written: {0}")]
    Write(#[from] std::io::Error),
}

/// Packs a unit: its description, the library for this machine, and the model file. The same contents give the same bytes.
///
/// # Errors
/// [`ArchiveError`].
pub fn archive(
    description: &Description,
    version: Version,
    library: &[u8],
    model: &[u8],
) -> Result<Vec<u8>, ArchiveError> {
    check(library)?;
    let folder = platform(version).ok_or(ArchiveError::Platform { version })?;
    let files: [(String, Vec<u8>); 4] = [
        ("modelDescription.xml".to_owned(), description.xml(version).into_bytes()),
        (format!("binaries/{folder}/{IDENTIFIER}{DLL_SUFFIX}"), library.to_vec()),
        (format!("resources/{RESOURCE}"), model.to_vec()),
        ("documentation/index.html".to_owned(), description.page(version).into_bytes()),
    ];
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default());
    for (name, bytes) in files {
        zip.start_file(name, options.unix_permissions(0o644))?;
        zip.write_all(&bytes)?;
    }
    Ok(zip.finish()?.into_inner())
}

/// Refuses a file that is not the library.
fn check(library: &[u8]) -> Result<(), ArchiveError> {
    for missing in ["fmi3DoStep", "fmi2DoStep"] {
        if !library.windows(missing.len()).any(|part| part == missing.as_bytes()) {
            return Err(ArchiveError::Library { missing });
        }
    }
    Ok(())
}

/// Folder of the libraries for this machine.
fn platform(version: Version) -> Option<&'static str> {
    Some(match (version, OS, ARCH) {
        (Version::Three, "linux", "x86_64") => "x86_64-linux",
        (Version::Three, "linux", "aarch64") => "aarch64-linux",
        (Version::Three, "macos", "x86_64") => "x86_64-darwin",
        (Version::Three, "macos", "aarch64") => "aarch64-darwin",
        (Version::Three, "windows", "x86_64") => "x86_64-windows",
        (Version::Two, "linux", "x86_64") => "linux64",
        (Version::Two, "macos", _) => "darwin64",
        (Version::Two, "windows", "x86_64") => "win64",
        _ => return None,
    })
}
