//! Protection of existing files: a command only replaces files of the kind that it writes. A mistyped name must not
//! destroy a log, a configuration or a run.

use super::Failure;
use leastaction_adaptation::SETTINGS_HEAD;
use leastaction_core::model::MAGIC;
use leastaction_learning::data;
use leastaction_models::file::{C_HEAD, RUST_HEAD};
use leastaction_models::urdf::MARK;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Kind of a file that a command writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// A model file.
    Model,
    /// A plan.
    Plan,
    /// Numbers that a machine found.
    Patch,
    /// Settings of an adapter.
    Settings,
    /// Settings of an adapter, as a Rust module.
    SettingsSource,
    /// A Rust module with a model.
    RustModule,
    /// A C header with a model.
    CHeader,
    /// A log of motion, recognised by its name.
    Log,
    /// A configuration that `leastaction look` wrote.
    Configuration,
    /// A motion that `leastaction excite` wrote.
    Motion,
    /// A table whose header begins with these names.
    Table(&'static str),
    /// A robot description that `leastaction export` wrote.
    Description,
    /// A picture.
    Picture,
    /// A page of HTML.
    Page,
    /// A bag of ROS 2.
    Bag,
    /// A functional mock-up unit, recognised as an archive that begins with a description.
    Unit,
}

/// First words of a configuration from `leastaction look`.
pub const CONFIGURATION_HEAD: &str = "# Guessed by names";

/// First words of a motion from `leastaction excite`.
pub const MOTION_HEAD: &str = "# A motion of `leastaction excite`";

/// Number of bytes of a zip archive up to the end of its first file's name, if that is `modelDescription.xml`.
const ARCHIVE_HEAD: usize = 30 + "modelDescription.xml".len();

impl FileKind {
    fn name(self) -> &'static str {
        match self {
            Self::Model => "model file",
            Self::Plan => "plan",
            Self::Patch => "patch of a model",
            Self::Settings => "file of settings of `leastaction adapt`",
            Self::SettingsSource => "Rust module of `leastaction adapt`",
            Self::RustModule => "Rust module of `leastaction export`",
            Self::CHeader => "C header with a model",
            Self::Log => "log of motion",
            Self::Configuration => "configuration of `leastaction look`",
            Self::Motion => "motion of `leastaction excite`",
            Self::Table(_) => "table of this command",
            Self::Description => "description of `leastaction export`",
            Self::Picture => "picture (SVG)",
            Self::Page => "page (HTML)",
            Self::Bag => "bag (MCAP)",
            Self::Unit => "functional mock-up unit",
        }
    }

    /// First bytes of a file of this kind; `None` if the whole file must be read to recognise it.
    fn head(self, path: &Path) -> Option<&'static [u8]> {
        match self {
            Self::Model => Some(&MAGIC),
            Self::Plan => Some(&leastaction_core::plan::MAGIC),
            Self::Patch => Some(&leastaction_core::adapt::PATCH_MAGIC),
            Self::Settings => Some(&leastaction_core::adapt::SETTINGS_MAGIC),
            Self::SettingsSource => Some(SETTINGS_HEAD.as_bytes()),
            Self::RustModule => Some(RUST_HEAD.as_bytes()),
            Self::CHeader => Some(C_HEAD.as_bytes()),
            Self::Configuration => Some(CONFIGURATION_HEAD.as_bytes()),
            Self::Motion => Some(MOTION_HEAD.as_bytes()),
            Self::Log if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("npz")) => {
                Some(b"PK\x03\x04")
            }
            Self::Log | Self::Description | Self::Unit => None,
            Self::Table(head) => Some(head.as_bytes()),
            Self::Picture => Some(b"<svg"),
            Self::Page => Some(b"<!DOCTYPE html>"),
            Self::Bag => Some(b"\x89MCAP0\r\n"),
        }
    }

    /// Whether a file is of this kind, or empty.
    fn is_of(self, path: &Path) -> io::Result<bool> {
        if self == Self::Description {
            return Ok(std::fs::read(path)?.windows(MARK.len()).any(|part| part == MARK.as_bytes()));
        }
        if self == Self::Unit {
            let mut begin = Vec::new();
            File::open(path)?.take(ARCHIVE_HEAD as u64).read_to_end(&mut begin)?;
            return Ok(begin.ends_with(b"modelDescription.xml"));
        }
        let Some(head) = self.head(path) else { return Ok(data::read(path).is_ok()) };
        let mut begin = Vec::new();
        File::open(path)?.take(head.len() as u64).read_to_end(&mut begin)?;
        Ok(begin == head)
    }
}

/// Refuses an existing file of another kind; any other path (no file, or a device) may be written.
///
/// # Errors
/// [`Failure::Input`] for a file of another kind, or one that cannot be read.
pub fn replaceable(path: &Path, kind: FileKind) -> Result<(), Failure> {
    let is_free = path.metadata().map_or(true, |file| !file.is_file() || file.len() == 0);
    if is_free || kind.is_of(path).map_err(|error| Failure::input(path, error))? {
        return Ok(());
    }
    let what = kind.name();
    Err(Failure::input(
        path,
        format!(
            "there is a file of this name that is no {what}, and would be lost; remove it, or name another file"
        ),
    ))
}
