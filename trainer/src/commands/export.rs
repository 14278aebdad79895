//! `leastaction export`.

use super::Done;
use super::output::{Failure, Output};
use clap::Args;
use leastaction::run::Trained;
use leastaction::{atomic, model_file};
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};

/// Make a model file of a training run.
///
/// The best weights of the run, in single precision, with what a chip needs to know about them. With --rust also a Rust
/// module that holds the file as a constant and needs `leastaction-core` alone.
///
/// Example: leastaction export run -o model.postcard --rust model.rs
#[derive(Args)]
pub struct Export {
    /// The folder of the run.
    run: PathBuf,
    /// The model file to write.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// A Rust source file to write as well.
    #[arg(long, value_name = "FILE")]
    rust: Option<PathBuf>,
}

/// What was written.
#[derive(Serialize)]
struct Report {
    model: PathBuf,
    bytes: usize,
    parameters: usize,
    provenance: String,
    rust: Option<PathBuf>,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(f, "{}: {} bytes, {} parameters", self.model.display(), self.bytes, self.parameters)?;
        writeln!(f, "{}", self.provenance)?;
        self.rust.iter().try_for_each(|file| writeln!(f, "{}: the same as Rust source", file.display()))
    }
}

impl Export {
    /// Writes the files.
    pub fn run(self, output: Output) -> Done {
        let (trained, bytes) = export(&self.run, &self.output)?;
        if let Some(file) = &self.rust {
            let source = model_file::rust_source(&bytes).map_err(|error| Failure::file(file, error))?;
            atomic::write(file, source.as_bytes()).map_err(|error| Failure::file(file, error))?;
        }
        output.report(&Report {
            model: self.output,
            bytes: bytes.len(),
            parameters: trained.best.weights.len(),
            provenance: trained.provenance,
            rust: self.rust,
        })
    }
}

/// Writes the model file of a run.
pub fn export(run: &Path, file: &Path) -> Result<(Trained, Vec<u8>), Failure> {
    let trained = Trained::read(run).map_err(|error| Failure::Input(error.to_string()))?;
    let Trained { architecture, discretisation, best, provenance, .. } = &trained;
    let bytes = model_file::encode(architecture, &best.weights, *discretisation, provenance)
        .map_err(|error| Failure::file(run, error))?;
    atomic::write(file, &bytes).map_err(|error| Failure::file(file, error))?;
    Ok((trained, bytes))
}
