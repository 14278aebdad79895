//! Parsing of a configuration.

use super::{CalibrationConfig, Config, ConfigError, DataConfig, TrainingConfig};
use leastaction_models::config::{ModelConfig, ShapeError, Step};
use serde::Deserialize;
use serde::de::Error;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue, Deserializer, ValueDeserializer};

/// A configuration file without its `[model]` table.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    data: DataConfig,
    #[serde(default)]
    calibration: CalibrationConfig,
    #[serde(default)]
    training: TrainingConfig,
}

/// Parses the configuration; does not check that its trees and graphs are valid.
pub(super) fn parse(text: &str) -> Result<Config, toml::de::Error> {
    let mut document = DeTable::parse(text)?;
    let model = document.get_mut().remove("model");
    let File { data, calibration, training } = File::deserialize(Deserializer::from(document))?;
    let model = model_of(model.ok_or_else(|| Error::missing_field("model"))?)?;
    Ok(Config { data, model, calibration, training })
}

/// Removes `family` from `[model]`, so that the rest holds only that family's keys. A model with `from` is of the modular family.
fn model_of(mut model: Spanned<DeValue<'_>>) -> Result<ModelConfig, toml::de::Error> {
    let mut family = "inertia-network";
    if let DeValue::Table(table) = model.get_mut() {
        if table.contains_key("from") {
            family = "modular";
        }
        if let Some(name) = table.remove("family") {
            family = ModelConfig::read_family(ValueDeserializer::from(name))?;
        }
    }
    ModelConfig::read(family, ValueDeserializer::from(model))
}

/// The error with the line of its place.
pub(super) fn located(file: &Path, text: &str, error: &ShapeError) -> ConfigError {
    let document = DeTable::parse(text).ok();
    let start = document.map_or(0, |document| start(&document, &error.place));
    ConfigError::at(file, text, start, error.problem.to_string())
}

/// An error at the value under this path of keys.
pub(super) fn at_key(file: &Path, text: &str, keys: &[&str], message: String) -> ConfigError {
    let place: Vec<Step> = keys.iter().map(|key| Step::from(*key)).collect();
    let document = DeTable::parse(text).ok();
    let start = document.map_or(0, |document| start(&document, &place));
    ConfigError::at(file, text, start, message)
}

/// Start of the innermost part of the place that the text contains.
fn start(document: &Spanned<DeTable>, place: &[Step]) -> usize {
    let mut start = 0;
    let mut steps = place.iter();
    let Some((key, value)) = steps.next().and_then(|step| document.get_ref().get_key_value(step.key()))
    else {
        return start;
    };
    let mut value = value;
    start = key.span().start;
    for step in steps {
        let next = match value.get_ref() {
            DeValue::Table(table) => {
                table.get_key_value(step.key()).map(|(key, value)| (key.span().start, value))
            }
            DeValue::Array(array) => {
                step.index().and_then(|i| array.get(i)).map(|value| (value.span().start, value))
            }
            _ => None,
        };
        let Some((place, inner)) = next else { break };
        (start, value) = (place, inner);
    }
    start
}
