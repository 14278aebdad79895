//! `leastaction import`.

use super::Done;
use super::arguments::positive_f32;
use super::output::{Failure, Output};
use clap::{Args, Subcommand};
use leastaction::ground_truth::Mechanism;
use leastaction::{atomic, import, model_file};
use leastaction_core::energy::rigid::Coordinate;
use leastaction_core::model::Discretisation;
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;

/// Make a model file of a network that was trained elsewhere.
#[derive(Args)]
pub struct Import {
    #[command(subcommand)]
    source: Source,
}

#[derive(Subcommand)]
enum Source {
    Symo(Symo),
}

/// A network of the SyMo authors' program (SyMo, E2E-SyMo or L-NODE): safetensors with their tensor names.
///
/// Weights are rounded to single precision, which is what that program trains in.
///
/// Example: leastaction import symo cartpole.safetensors --system cartpole -o m.postcard
#[derive(Args)]
struct Symo {
    /// The safetensors file.
    file: PathBuf,
    /// Takes coordinates and step from this mechanism of the paper.
    #[arg(long, required_unless_present = "coordinates")]
    system: Option<Mechanism>,
    /// One letter a coordinate, in the order of q: t translation, a angle.
    #[arg(long, value_name = "LETTERS", conflicts_with = "system")]
    coordinates: Option<String>,
    /// The step that the network was trained with, s [default: that of --system; none for L-NODE].
    #[arg(long, value_name = "SECONDS", value_parser = positive_f32, allow_negative_numbers = true)]
    h: Option<f32>,
    /// The model file to write.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

/// What was written.
#[derive(Serialize)]
struct Report {
    model: PathBuf,
    bytes: usize,
    parameters: usize,
    coordinates: String,
    h: Option<f32>,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let (model, bytes, parameters) = (self.model.display(), self.bytes, self.parameters);
        let step = self.h.map_or("no step".to_owned(), |h| format!("order 2, step {h} s"));
        writeln!(
            f,
            "{model}: {bytes} bytes, {parameters} parameters, coordinates {}, {step}",
            self.coordinates
        )
    }
}

impl Import {
    /// Reads, converts and writes.
    pub fn run(self, output: Output) -> Done {
        match self.source {
            Source::Symo(symo) => symo.run(output),
        }
    }
}

impl Symo {
    fn run(self, output: Output) -> Done {
        let bytes = std::fs::read(&self.file).map_err(|error| Failure::input(&self.file, error))?;
        let coordinates = self.coordinates()?;
        let imported =
            import::symo(&bytes, &coordinates).map_err(|error| Failure::input(&self.file, error))?;
        let step = self.h.or(self.system.map(|system| system.step() as f32)).filter(|_| imported.discrete);
        let discretisation = step.map(|h| Discretisation { order: 2, h });
        let name = self.file.file_name().unwrap_or_default().to_string_lossy();
        let provenance = format!("imported from {name} (SyMo)");
        let model =
            model_file::encode(&imported.architecture, &imported.weights, discretisation, &provenance)
                .map_err(|error| Failure::input(&self.file, error))?;
        atomic::write(&self.output, &model).map_err(|error| Failure::file(&self.output, error))?;
        output.report(&Report {
            model: self.output,
            bytes: model.len(),
            parameters: imported.weights.len(),
            coordinates: imported.architecture.coordinates(),
            h: step,
        })
    }

    fn coordinates(&self) -> Result<Vec<Coordinate>, Failure> {
        let Some(letters) = &self.coordinates else {
            return Ok(self.system.map(|system| system.coordinates().to_vec()).unwrap_or_default());
        };
        let wrong = || Failure::Input(format!("--coordinates {letters}: one letter a coordinate, t or a"));
        let kinds: Option<Vec<_>> = letters.chars().map(Coordinate::from_letter).collect();
        kinds.filter(|kinds| !kinds.is_empty()).ok_or_else(wrong)
    }
}
