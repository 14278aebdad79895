//! Which of several configurations predicts logs best that it has not seen.

use super::plan::{Plan, PlanError};
use crate::config::Config;
use crate::data::Dataset;

/// Parts that the logs are divided into: each is held back once.
const FOLDS: usize = 4;

/// The error of a configuration on logs that it did not learn from: every [`FOLDS`]-th is held back, then the ones after them, and so
/// on; the geometric mean of the held-back losses. `None` where nothing is learned, or there is one log alone.
///
/// # Errors
/// As [`Plan::new`].
pub fn held_back_error(config: &Config, data: &Dataset) -> Result<Option<f64>, PlanError> {
    let logs = data.trajectories.len();
    let folds = FOLDS.min(logs);
    if folds < 2 {
        return Ok(None);
    }
    let mut logarithms = 0.0;
    for fold in 0..folds {
        let mut own = config.clone();
        let of = |held_back: bool| (0..logs).filter(move |k| (k % folds == fold) == held_back);
        let order = of(false).chain(of(true)).map(|k| data.trajectories[k].clone());
        let parted = Dataset { trajectories: order.collect(), ..data.clone() };
        let held_back = of(true).count();
        own.data.validation = held_back as f64 / logs as f64;
        let Some(loss) = Plan::new(own, &parted)?.train().and_then(|trained| trained.best.validation) else {
            return Ok(None);
        };
        logarithms += loss.ln() / folds as f64;
    }
    Ok(Some(logarithms.exp()))
}
