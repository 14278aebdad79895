//! Models of `firmware-sim/chip/shapes.toml`.

use leastaction_learning::config::Config;
use leastaction_models::file::{EncodeError, encode};
use std::error::Error;
use std::path::Path;
use toml::{Table, Value};

/// A model with random weights.
pub struct RandomModel {
    /// Name of the model.
    pub name: String,
    /// Whether predictions are fitted to it.
    #[allow(dead_code, reason = "not every user asks")]
    pub fitted: bool,
    /// Model file.
    pub file: Vec<u8>,
}

/// Returns the models of all shapes.
pub fn all() -> Result<Vec<RandomModel>, Box<dyn Error>> {
    let text = include_str!("../../firmware-sim/chip/shapes.toml");
    let mut shapes = Vec::new();
    for (set, models) in text.parse::<Table>()? {
        for (name, model) in models.as_table().ok_or("a list of models")? {
            shapes.push(RandomModel { name: name.clone(), fitted: set == "fitted", file: file(model)? });
        }
    }
    Ok(shapes)
}

fn file(model: &Value) -> Result<Vec<u8>, Box<dyn Error>> {
    let data: Table = [("file".to_owned(), Value::from("none"))].into_iter().collect();
    let document: Table =
        [("data".to_owned(), Value::Table(data)), ("model".to_owned(), model.clone())].into_iter().collect();
    let config = Config::parse(&toml::to_string(&document)?, Path::new("shapes.toml"))?;
    let (architecture, weights) = config.beginning()?;
    Ok(encode(&architecture, &weights, None, "").map_err(|error: EncodeError| error.to_string())?)
}

/// A line of `firmware-sim/chip/shapes.jsonl`.
#[derive(serde::Deserialize)]
#[allow(dead_code, reason = "not every user asks for all")]
pub struct Measured {
    /// Name of the processor.
    pub board: String,
    /// Name of the shape.
    pub model: String,
    /// Order of the steps.
    pub order: u8,
    /// Size of the code of the whole image, in bytes.
    pub text_bytes: f64,
    /// Stack use of an acceleration, in bytes.
    pub acceleration_stack_bytes: f64,
    /// Stack use of a step, in bytes.
    pub stack_bytes: f64,
    /// Number of instructions of an acceleration.
    pub acceleration_instructions: f64,
    /// Median number of instructions of a step.
    pub step_instructions: f64,
}

#[allow(dead_code, reason = "not every user asks")]
impl Measured {
    /// Whether the measurement belongs to this processor and shape.
    pub fn is(&self, processor: &str, shape: &str) -> bool {
        self.board == processor && self.model == shape
    }
}

/// Returns all measurements.
#[allow(dead_code, reason = "not every user asks")]
pub fn measured() -> Result<Vec<Measured>, Box<dyn Error>> {
    let text = include_str!("../../firmware-sim/chip/shapes.jsonl");
    let lines = text.lines().filter(|line| line.starts_with('{'));
    Ok(lines.map(serde_json::from_str).collect::<Result<_, _>>()?)
}
