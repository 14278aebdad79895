//! The functional mock-up unit of a model.

use super::{Export, Weights};
use clap::ValueEnum;
use leastaction::cli::{Failure, FileKind, Output, replaceable};
use leastaction::models::{Loaded, read};
use leastaction_core::model::FORMAT_VERSION;
use leastaction_fmu::{ArchiveError, Description, IDENTIFIER, Version, archive};
use leastaction_learning::atomic;
use leastaction_models::Model;
use serde::Serialize;
use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::fmt;
use std::path::{Path, PathBuf};

/// Version of FMI.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Fmi {
    /// FMI 2.0.
    #[value(name = "2")]
    Two,
    /// FMI 3.0.
    #[value(name = "3")]
    Three,
}

impl Fmi {
    fn version(self) -> Version {
        match self {
            Self::Two => Version::Two,
            Self::Three => Version::Three,
        }
    }
}

/// A unit that was written.
#[derive(Serialize)]
pub struct Fmu {
    /// The file.
    file: PathBuf,
    /// Version of FMI.
    fmi: String,
    /// Number of bytes of the file.
    bytes: usize,
    /// Number of variables.
    variables: usize,
    /// Library in the unit.
    library: PathBuf,
    #[serde(skip)]
    archive: Vec<u8>,
}

impl fmt::Display for Fmu {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { file, fmi, bytes, variables, .. } = self;
        writeln!(f, "{}: a unit of FMI {fmi}, {variables} variables, {bytes} bytes", file.display())
    }
}

impl Fmu {
    /// Writes the file.
    pub fn write(&self) -> Result<(), Failure> {
        atomic::write(&self.file, &self.archive).map_err(|error| Failure::file(&self.file, error))
    }
}

impl Export {
    /// Makes a unit of a model file instead of a run.
    pub(super) fn of_model_file(&self, output: Output) -> Result<(), Failure> {
        let others = [
            (self.output.is_some(), "--output"),
            (self.rust.is_some(), "--rust"),
            (self.urdf.is_some(), "--urdf"),
            (self.mjcf.is_some(), "--mjcf"),
            (self.data.is_some(), "--data"),
            (self.weights == Weights::F16, "--weights f16"),
        ];
        if let Some((_, option)) = others.iter().find(|(is_given, _)| *is_given) {
            let message =
                format!("this is no folder of a run; of a model file only --fmu can be made, not {option}");
            return Err(Failure::input(&self.run, message));
        }
        let Loaded { model, bytes } = read(&self.run)?;
        let encoded = |error| Failure::file(&self.run, error);
        let bytes =
            if model.version == FORMAT_VERSION { bytes } else { model.to_bytes().map_err(encoded)? };
        let Some(unit) = self.unit(&model, &bytes, output)? else {
            return Err(Failure::input(&self.run, "this is a model file already; --fmu makes a unit of it"));
        };
        unit.write()?;
        output.report(&unit)
    }

    /// The unit that the options name, of a model and its file.
    pub(super) fn unit(&self, model: &Model, bytes: &[u8], output: Output) -> Result<Option<Fmu>, Failure> {
        let Some(file) = self.fmu.clone() else { return Ok(None) };
        replaceable(&file, FileKind::Unit)?;
        let version = self.fmi.version();
        let refused = |error: &dyn fmt::Display| Failure::input(&self.run, error);
        let description = described(model, bytes, &file).map_err(|error| refused(&error))?;
        output.notes(&notes(model));
        let library = self.library()?;
        let code = std::fs::read(&library).map_err(|error| Failure::input(&library, error))?;
        let archive = archive(&description, version, &code, bytes).map_err(|error| match error {
            ArchiveError::Library { .. } => Failure::input(&library, error),
            error => Failure::file(&file, error),
        })?;
        let (fmi, variables) = (version.to_string(), description.variables());
        Ok(Some(Fmu { file, fmi, bytes: archive.len(), variables, library, archive }))
    }

    /// The library of units: the one that is named, or the one that came with this command.
    fn library(&self) -> Result<PathBuf, Failure> {
        if let Some(library) = &self.library {
            return Ok(library.clone());
        }
        let command = std::env::current_exe().map_err(|error| Failure::Input(error.to_string()))?;
        let folder = command.parent().unwrap_or(Path::new("."));
        let name = format!("{DLL_PREFIX}{IDENTIFIER}{DLL_SUFFIX}");
        let places = places(folder, &name);
        places.iter().find(|place| place.is_file()).cloned().ok_or_else(|| {
            Failure::Input(format!(
                "{name}, the library of units, is not in {}; name it with --library: it is in lib of a release archive, and in the \
                 repository `cargo build --release -p leastaction-fmu` builds target/release/{name}",
                folder.display()
            ))
        })
    }
}

/// Places of a library that came with the command in a folder. Cargo builds it into `deps` whenever it builds the command, and copies it only
/// if it is asked for; a release archive has folders `bin` and `lib`.
fn places(folder: &Path, name: &str) -> Vec<PathBuf> {
    let built = [folder.join("deps").join(name), folder.join(name)];
    let unpacked =
        folder.parent().filter(|_| folder.ends_with("bin")).map(|root| root.join("lib").join(name));
    built.into_iter().chain(unpacked).collect()
}

/// The description of a model, named after the file.
fn described(model: &Model, bytes: &[u8], file: &Path) -> Result<Description, leastaction_fmu::FmuError> {
    let translations = model.architecture.coordinates().chars().map(|kind| kind == 't').collect();
    let name = file.file_stem().map_or("model".into(), |stem| stem.to_string_lossy());
    let mut own = Description::new(bytes, &name, translations)?;
    own.family = model.architecture.name().to_owned();
    own.provenance = model.facts.provenance.clone();
    own.has_actuator = !model.facts.actuator.is_ideal();
    Ok(own)
}

/// Notes for the user about the unit.
fn notes(model: &Model) -> Vec<String> {
    let drives = !model.facts.actuator.is_ideal();
    let step = model.facts.trained_step.is_none();
    let part = model.architecture.part().filter(|_| model.architecture.parts().len() > 1);
    let own = [
        drives.then(|| {
            "u of the unit is the force itself: gain, offset, delay and lag of the drives are left out"
                .to_owned()
        }),
        step.then(|| {
            "the model was trained without a step, so h is a parameter of the unit: 0.001 s".to_owned()
        }),
        part.map(|(what, name)| format!("the unit is of the first {what} of the file, {name:?}")),
    ];
    own.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_library_is_beside_the_command_or_in_lib_of_an_archive() {
        let found = |folder: &str| places(Path::new(folder), "l.so");
        let unpacked = ["/opt/a/bin/deps/l.so", "/opt/a/bin/l.so", "/opt/a/lib/l.so"].map(PathBuf::from);
        assert_eq!(found("/opt/a/bin"), unpacked);
        assert_eq!(found("/a/target/release").len(), 2);
    }
}
