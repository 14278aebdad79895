use leastaction::cli::Failure;
use leastaction::models::fingerprint_of;
use leastaction_adaptation::{Patched, PatchedNumber};
use leastaction_models::Model;
use serde::Serialize;
use std::fmt;
use std::path::Path;

/// Patch of a model.
#[derive(Serialize)]
pub struct PatchReport {
    bytes: usize,
    numbers: Vec<NumberReport>,
}

/// A number of the patch.
#[derive(Serialize)]
struct NumberReport {
    name: String,
    unit: &'static str,
    /// Value in the model; `None` for a number of the drives.
    model: Option<f32>,
    distance: f32,
    standard_error: f32,
}

impl From<PatchedNumber> for NumberReport {
    fn from(PatchedNumber { label, model, distance, error }: PatchedNumber) -> Self {
        Self { name: label.name(), unit: label.unit, model, distance, standard_error: error }
    }
}

impl PatchReport {
    /// Reads the patch of the model in a file.
    pub fn read((model, of): (&Model, &Path), file: &Path) -> Result<Self, Failure> {
        let bytes = std::fs::read(file).map_err(|error| Failure::input(file, error))?;
        let patched = Patched::read((model, fingerprint_of(of)?), &bytes);
        let patched = patched.map_err(|error| Failure::input(file, error))?;
        Ok(Self { bytes: bytes.len(), numbers: patched.numbers.into_iter().map(Into::into).collect() })
    }
}

impl fmt::Display for PatchReport {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(
            f,
            "\npatch of {} bytes{:>21} {:>12} {:>12}",
            self.bytes, "model", "distance", "std. error"
        )?;
        self.numbers.iter().try_for_each(|NumberReport { name, unit, model, distance, standard_error }| {
            let model = model.map_or("–".to_owned(), |model| format!("{model:.5}"));
            writeln!(f, "{name:<26} {model:>12} {distance:>12.5} {standard_error:>12.5} {unit}")
        })
    }
}
