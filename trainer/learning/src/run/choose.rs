//! Choice of the configuration that predicts held-back logs best, among several.

use super::held_back::{Learned, Trial};
use super::lengths::{self, Lengths};
use super::plan::{Plan, PlanError};
use super::tried::{self, Tried};
use crate::config::{Config, TrainingLoss};
use crate::data::{DataError, Dataset, Note};
use leastaction_models::config::{ModelConfig, Source};
use std::path::PathBuf;
use thiserror::Error;

/// The configuration that predicts held-back logs best, among several, with its data.
#[derive(Clone, Debug, PartialEq)]
pub struct Chosen {
    /// The configuration, with one choice of columns.
    pub config: Config,
    /// Data that the configuration reads.
    pub data: Dataset,
    /// Decisions of the reader, each with its file.
    pub notes: Vec<(PathBuf, Note)>,
    /// Further decisions, made by means of held-back logs.
    pub choices: Choices,
}

/// Decisions with the position errors on held-back logs that they are based on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Choices {
    /// Names of the u columns of each alternative with their error, m or rad; empty if there was no choice.
    pub columns: Vec<(Vec<String>, f64)>,
    /// Window lengths, if the configuration names none.
    pub lengths: Option<Lengths>,
    /// Effect of the correcting networks, if they were tried.
    pub networks: Option<Tried>,
}

impl Choices {
    /// The decisions as sentences.
    pub fn sentences(&self) -> Vec<String> {
        let of_columns = |(columns, error): &(Vec<String>, f64)| {
            format!(
                "with u = {} positions of held-back logs are {error:.2e} off (m, rad)",
                columns.join(", ")
            )
        };
        let columns = self.columns.iter().map(of_columns);
        let lengths = self.lengths.iter().map(Lengths::to_string);
        columns.chain(lengths).chain(self.networks.iter().map(Tried::to_string)).collect()
    }
}

/// The reason why nothing could be chosen.
#[derive(Debug, Error)]
pub enum ChoiceError {
    /// A log cannot be read.
    #[error(transparent)]
    Data(#[from] DataError),
    /// A run cannot begin.
    #[error(transparent)]
    Plan(#[from] PlanError),
}

/// Reads the log of a configuration and decides what the configuration leaves open: the columns of u, the length of
/// windows, and whether to keep networks. Each alternative learns from some parts of the logs and predicts the other
/// parts; the best is taken. Columns and lengths are chosen with the simple physics, without correcting networks.
///
/// # Errors
/// [`ChoiceError`] if a log cannot be read, or a run with it cannot begin.
pub fn choose(config: Config) -> Result<Chosen, ChoiceError> {
    let (mut chosen, learned) = choose_columns(config)?;
    let Chosen { config, data, choices, .. } = &mut chosen;
    let wants_length = config.training.window.is_none() && takes_lengths(config, data)?;
    if !wants_length && !config.training.try_networks {
        return Ok(chosen);
    }
    let (trial, simple) = (Trial::new(config, data), simple(config));
    let mut learned = match learned {
        None => trial.learn(&simple, None)?,
        learned => learned,
    };
    if let Some(before) = learned.take_if(|_| wants_length) {
        learned = match lengths::chosen(&simple, &trial, &before)? {
            Some((lengths, learned)) => {
                config.training.window = Some(lengths.chosen);
                choices.lengths = Some(lengths);
                Some(learned)
            }
            None => Some(before),
        };
    }
    if config.training.try_networks {
        let (model, tried) = tried::networks(config, &trial, learned)?;
        (config.model, choices.networks) = (model, Some(tried));
    }
    Ok(chosen)
}

/// The configuration without correcting networks, unless the weights come from an earlier training.
fn simple(config: &Config) -> Config {
    let alone = config.model.with_networks(false, false).filter(|_| config.model.source() != Source::Weights);
    Config { model: alone.unwrap_or_else(|| config.model.clone()), ..config.clone() }
}

/// Whether training is over windows and several window lengths can be tried. An arm is excluded: its training begins
/// with a fit to torques, which would take longer than everything else.
fn takes_lengths(config: &Config, data: &Dataset) -> Result<bool, PlanError> {
    Ok(Plan::loss(config, data)? == TrainingLoss::Windows && !matches!(config.model, ModelConfig::Arm(_)))
}

/// The choice with the best columns of u and, if there were several, the result learned with them.
fn choose_columns(config: Config) -> Result<(Chosen, Option<Learned>), ChoiceError> {
    config.data.check_left_out()?;
    let candidates = config.data.alternatives();
    if candidates.len() < 2 {
        let (data, notes) = config.data.read()?;
        return Ok((Chosen { config, data, notes, choices: Choices::default() }, None));
    }
    let (mut best, mut columns) = (None::<(f64, Chosen, Option<Learned>)>, Vec::new());
    for data in candidates {
        let config = Config { data, ..config.clone() };
        let (data, notes) = config.data.read()?;
        let learned = Trial::new(&config, &data).learn(&simple(&config), None)?;
        let error = learned.as_ref().map_or(f64::INFINITY, |learned| learned.held_back.error());
        let own = config.data.columns.iter().flat_map(|columns| &columns.columns.u);
        columns.push((own.map(|column| column.name.clone()).collect(), error));
        if best.as_ref().is_none_or(|(least, ..)| error < *least) {
            best = Some((error, Chosen { config, data, notes, choices: Choices::default() }, learned));
        }
    }
    let (_, mut chosen, learned) = best.ok_or(PlanError::NoColumns)?;
    chosen.choices.columns = columns;
    Ok((chosen, learned))
}
