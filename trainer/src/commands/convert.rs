//! `leastaction convert`.

use clap::Args;
use leastaction::cli::{Done, Failure, FileKind, Output, replaceable};
use leastaction::models::fingerprint_of;
use leastaction_adaptation::Patched;
use leastaction_learning::atomic;
use leastaction_models::Model;
use leastaction_models::file::{self, decode};
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};

/// Rewrite a model file of an older format version in the current one, or with the numbers of a patch.
///
/// Shape, weights (to the last bit), step and text are kept. Facts that version 1 does not hold remain absent: the range of the training
/// data, and the actuator. A version-1 control counts as linear between samples, as training took it then.
///
/// Example: leastaction convert old.postcard -o new.postcard
///
/// Example: leastaction convert arm.postcard --patch arm.patch -o loaded.postcard
#[derive(Args)]
pub struct Convert {
    /// The model file to read.
    model: PathBuf,
    /// The model file to write; it may be the same.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// A patch of the model, whose distances are added to the numbers of the file.
    #[arg(long, value_name = "PATCH")]
    patch: Option<PathBuf>,
}

/// Report on the written file.
#[derive(Serialize)]
struct Report {
    model: PathBuf,
    /// Format version of the file that was read.
    from_version: u8,
    format_version: u8,
    parameters: usize,
    bytes: usize,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { model, from_version, format_version, parameters, bytes } = self;
        writeln!(
            f,
            "{}: {bytes} bytes, {parameters} parameters, format version {format_version} (from {from_version})",
            model.display()
        )
    }
}

impl Convert {
    /// Reads the file and writes it anew.
    pub fn run(self, output: Output) -> Done {
        replaceable(&self.output, FileKind::Model)?;
        let bytes = std::fs::read(&self.model).map_err(|error| Failure::input(&self.model, error))?;
        let model = decode(&bytes).map_err(|error| Failure::input(&self.model, error))?;
        let model = match &self.patch {
            Some(patch) => patched((&model, &self.model), patch)?,
            None => model,
        };
        let encoded = file::encode_in(model.precision, &model.architecture, &model.weights, &model.facts);
        let written = encoded.map_err(|error| Failure::file(&self.model, error))?;
        atomic::write(&self.output, &written).map_err(|error| Failure::file(&self.output, error))?;
        output.report(&Report {
            from_version: model.version,
            format_version: leastaction_core::model::FORMAT_VERSION,
            parameters: model.weights.len(),
            bytes: written.len(),
            model: self.output,
        })
    }
}

/// The model with the numbers of a patch.
fn patched((model, of): (&Model, &Path), file: &Path) -> Result<Model, Failure> {
    let bytes = std::fs::read(file).map_err(|error| Failure::input(file, error))?;
    let patched = Patched::read((model, fingerprint_of(of)?), &bytes);
    Ok(patched.map_err(|error| Failure::input(file, error))?.model)
}
