//! Which of several configurations predicts logs best that it has not seen.

use super::plan::{Plan, PlanError};
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

/// Reads the log of a configuration. Where several columns may be u, what is learned with each from parts of the logs predicts the others:
/// the best is taken.
///
/// # Errors
/// [`ChoiceError`]: a log cannot be read, or a run with it cannot begin.
pub fn choose(config: Config) -> Result<Chosen, ChoiceError> {
    config.data.check_left_out()?;
    let candidates = config.data.alternatives();
    if candidates.len() < 2 {
        let (data, notes) = config.data.read()?;
        return Ok(Chosen { config, data, notes, errors: Vec::new() });
    }
    let (mut best, mut errors) = (None::<(f64, Chosen)>, Vec::new());
    for data in candidates {
        let config = Config { data, ..config.clone() };
        let (data, notes) = config.data.read()?;
        let error = held_back_error(&config, &data)?.map_or(f64::INFINITY, f64::sqrt);
        let columns = config.data.columns.iter().flat_map(|columns| &columns.columns.u);
        errors.push((columns.map(|column| column.name.clone()).collect(), error));
        if best.as_ref().is_none_or(|(least, _)| error < *least) {
            best = Some((error, Chosen { config, data, notes, errors: Vec::new() }));
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
    let logs = data.trajectories.len();
    let folds = FOLDS.min(logs);
    if folds < 2 {
        return Ok(None);
    }
    let mut logarithms = 0.0;
    for fold in 0..folds {
        let mut own = config.clone();
        own.training.overlap = Some(0.0);
        let of = |held_back: bool| (0..logs).filter(move |k| (k % folds == fold) == held_back);
        let order = of(false).chain(of(true)).map(|k| data.trajectories[k].clone());
        let parted = Dataset { trajectories: order.collect(), ..data.clone() };
        let held_back = of(true).count();
        own.data.validation = held_back as f64 / logs as f64;
        let mut plan = Plan::new(own, &parted)?;
        // What comes after the held-back logs have judged.
        plan.stages.retain(|stage| stage.validation.is_some());
        plan.stages.iter_mut().for_each(|stage| stage.iterations = stage.iterations.min(ITERATIONS));
        let Some(loss) = plan.train().and_then(|trained| trained.best.validation) else {
            return Ok(None);
        };
        logarithms += loss.ln() / folds as f64;
    }
    Ok(Some(logarithms.exp()))
}
