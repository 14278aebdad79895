//! From the text of a file to a configuration.

use super::arm::ArmConfig;
use super::bodies::BodiesConfig;
use super::graph::GraphConfig;
use super::modular::ModularConfig;
use super::problem::{ShapeError, Step};
use super::{
    CalibrationConfig, Config, ConfigError, DataConfig, InertiaNetworkConfig, ModelConfig, TrainingConfig,
};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue, Deserializer, ValueDeserializer};

/// What stands in `family`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Family {
    /// It was called `rigid` once.
    #[serde(alias = "rigid")]
    InertiaNetwork,
    Modular,
    Graph,
    Bodies,
    Arm,
}

/// A file with a model of a known family.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File<M> {
    data: DataConfig,
    model: M,
    #[serde(default)]
    calibration: CalibrationConfig,
    #[serde(default)]
    training: TrainingConfig,
}

impl<M: Into<ModelConfig>> From<File<M>> for Config {
    fn from(file: File<M>) -> Self {
        Self {
            data: file.data,
            model: file.model.into(),
            calibration: file.calibration,
            training: file.training,
        }
    }
}

/// The configuration, without a look at whether its trees or graphs can be.
pub(super) fn parse(text: &str) -> Result<Config, toml::de::Error> {
    let mut document = DeTable::parse(text)?;
    match take_family(document.get_mut())? {
        Family::InertiaNetwork => read::<InertiaNetworkConfig>(document),
        Family::Modular => read::<ModularConfig>(document),
        Family::Graph => read::<GraphConfig>(document),
        Family::Bodies => read::<BodiesConfig>(document),
        Family::Arm => read::<ArmConfig>(document),
    }
}

fn read<M: DeserializeOwned + Into<ModelConfig>>(
    document: Spanned<DeTable<'_>>,
) -> Result<Config, toml::de::Error> {
    File::<M>::deserialize(Deserializer::from(document)).map(Into::into)
}

/// Takes `family` out of `[model]`: so every family has only keys of its own. A model to go on from is of the modular family.
fn take_family(document: &mut DeTable) -> Result<Family, toml::de::Error> {
    let Some(model) = document.get_mut("model") else { return Ok(Family::InertiaNetwork) };
    let DeValue::Table(model) = model.get_mut() else { return Ok(Family::InertiaNetwork) };
    let default = if model.contains_key("from") { Family::Modular } else { Family::InertiaNetwork };
    let Some(family) = model.remove("family") else { return Ok(default) };
    Family::deserialize(ValueDeserializer::from(family))
}

/// The error with the line of what is wrong.
pub(super) fn located(file: &Path, text: &str, error: &ShapeError) -> ConfigError {
    let document = DeTable::parse(text).ok();
    let start = document.map_or(0, |document| start(&document, &error.place));
    ConfigError::at(file, text, start, error.problem.to_string())
}

/// An error at the value of these keys, one in the table of the other.
pub(super) fn at_key(file: &Path, text: &str, keys: &[&str], message: String) -> ConfigError {
    let place: Vec<Step> = keys.iter().map(|key| Step::from(*key)).collect();
    let document = DeTable::parse(text).ok();
    let start = document.map_or(0, |document| start(&document, &place));
    ConfigError::at(file, text, start, message)
}

/// Where the innermost part of the place begins that the text has.
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
