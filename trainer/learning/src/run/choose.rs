//! Which of several configurations predicts logs best that it has not seen.

use super::plan::{Plan, PlanError};
use super::tried::{self, Tried};
use crate::config::Config;
use crate::data::{DataError, Dataset, Note};
use std::path::PathBuf;
use thiserror::Error;

/// Parts that the logs are divided into: each is held back once.
const FOLDS: usize = 4;

/// Iterations of a stage at most: enough to tell which is better.
const ITERATIONS: u64 = 12;

/// A configuration with its data, the one of several that predicts held-back logs best.
#[derive(Clone, Debug, PartialEq)]
pub struct Chosen {
    /// With one choice of columns.
    pub config: Config,
    /// What it reads.
    pub data: Dataset,
    /// What was decided on reading, with the file.
    pub notes: Vec<(PathBuf, Note)>,
    /// Where there were several: the columns of u of each, and how far off positions of held-back logs were, m or rad.
    pub errors: Vec<(Vec<String>, f64)>,
    /// What networks that correct the model were worth, where they were tried.
    pub tried: Option<Tried>,
}

/// Why nothing could be chosen.
#[derive(Debug, Error)]
pub enum ChoiceError {
    /// A log cannot be read.
    #[error(transparent)]
    Data(#[from] DataError),
    /// A run cannot begin.
    #[error(transparent)]
    Plan(#[from] PlanError),
}

/// Reads the log of a configuration. Where several columns may be u, or networks are tried, what is learned with each from parts of the
/// logs predicts the others: the best is taken.
///
/// # Errors
/// [`ChoiceError`]: a log cannot be read, or a run with it cannot begin.
pub fn choose(config: Config) -> Result<Chosen, ChoiceError> {
    let mut chosen = choose_columns(config)?;
    if chosen.config.training.try_networks {
        let (model, tried) = tried::networks(&chosen.config, &chosen.data)?;
        (chosen.config.model, chosen.tried) = (model, Some(tried));
    }
    Ok(chosen)
}

/// With the columns of u that are best.
fn choose_columns(config: Config) -> Result<Chosen, ChoiceError> {
    config.data.check_left_out()?;
    let candidates = config.data.alternatives();
    if candidates.len() < 2 {
        let (data, notes) = config.data.read()?;
        return Ok(Chosen { config, data, notes, errors: Vec::new(), tried: None });
    }
    let (mut best, mut errors) = (None::<(f64, Chosen)>, Vec::new());
    for data in candidates {
        let config = Config { data, ..config.clone() };
        let (data, notes) = config.data.read()?;
        let error = held_back_error(&config, &data)?.map_or(f64::INFINITY, f64::sqrt);
        let columns = config.data.columns.iter().flat_map(|columns| &columns.columns.u);
        errors.push((columns.map(|column| column.name.clone()).collect(), error));
        if best.as_ref().is_none_or(|(least, _)| error < *least) {
            best = Some((error, Chosen { config, data, notes, errors: Vec::new(), tried: None }));
        }
    }
    let (_, chosen) = best.ok_or(PlanError::NoColumns)?;
    Ok(Chosen { errors, ..chosen })
}

/// The error of a configuration on logs that it did not learn from: every [`FOLDS`]-th is held back, then the ones after them, and so
/// on; the geometric mean of the held-back losses. `None` where nothing is learned, or there is one log alone.
///
/// # Errors
/// As [`Plan::new`].
fn held_back_error(config: &Config, data: &Dataset) -> Result<Option<f64>, PlanError> {
    let mut logarithms = 0.0;
    let folds = folds(data);
    for fold in 0..folds {
        let plan = plan_of_fold(config, data, (fold, folds))?;
        let Some(loss) = plan.train().and_then(|trained| trained.best.validation) else {
            return Ok(None);
        };
        logarithms += loss.ln() / folds as f64;
    }
    Ok((folds > 0).then(|| logarithms.exp()))
}

/// Parts that logs are divided into; none of one log alone.
pub(super) fn folds(data: &Dataset) -> usize {
    let logs = data.trajectories.len();
    if logs < 2 { 0 } else { FOLDS.min(logs) }
}

/// A few iterations on the logs but for one part of them, which judges.
///
/// # Errors
/// As [`Plan::new`].
pub(super) fn plan_of_fold(
    config: &Config,
    data: &Dataset,
    (fold, folds): (usize, usize),
) -> Result<Plan, PlanError> {
    let (mut own, logs) = (config.clone(), data.trajectories.len());
    own.training.overlap = Some(0.0);
    let of = |held_back: bool| (0..logs).filter(move |k| (k % folds == fold) == held_back);
    let order = of(false).chain(of(true)).map(|k| data.trajectories[k].clone());
    let parted = Dataset { trajectories: order.collect(), ..data.clone() };
    own.data.validation = of(true).count() as f64 / logs as f64;
    let mut plan = Plan::new(own, &parted)?;
    // What comes after the held-back logs have judged.
    plan.stages.retain(|stage| stage.validation.is_some());
    plan.stages.iter_mut().for_each(|stage| stage.iterations = stage.iterations.min(ITERATIONS));
    Ok(plan)
}
