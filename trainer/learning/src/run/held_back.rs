//! Comparison of configurations by means of logs that they did not learn from.

use super::folds::{Fold, excerpt, folds};
use super::lengths;
use super::plan::{Plan, PlanError};
use crate::config::Config;
use crate::data::Dataset;

/// The logs on which configurations are compared.
pub(super) struct Trial {
    folds: Vec<Fold>,
    /// Window lengths over which held-back positions are compared, s, in ascending order.
    pub lengths: Vec<f64>,
}

/// Results of a configuration in every fold.
pub(super) struct Learned {
    pub fits: Vec<Fit>,
    pub held_back: HeldBack,
}

/// The parameters learned in a fold: those that all windows share, or all parameters for a loss over single samples.
pub(super) struct Fit {
    pub plan: Plan,
    pub weights: Vec<f64>,
}

/// Errors of held-back positions. For windows there is one entry per log: the sum over its windows of ln(mean square,
/// (m, rad)²), weighted by window length, and the sum of these weights. For a loss over single steps there is one entry
/// per fold: the logarithm of the held-back loss, with weight 1.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct HeldBack(Vec<[f64; 2]>);

/// Position error on a held-back part of the logs, m or rad, before any iteration. Rigid bodies are evaluated with the
/// linear fit to the torques of the other logs, other models with their initial weights. `None` if no prediction is
/// finite or no log can be held back.
///
/// # Errors
/// See [`Plan::new`].
pub fn error_at_start(config: &Config, data: &Dataset) -> Result<Option<f64>, PlanError> {
    let mut own = config.clone();
    (own.training.iterations, own.training.warm_up) = (0, 0);
    own.training.window.get_or_insert_with(|| lengths::usual(data));
    let mut trial = Trial::new(&own, data);
    trial.folds.truncate(1);
    let learned = trial.learn(&own, None)?;
    Ok(learned.map(|learned| learned.held_back.error()).filter(|error| error.is_finite()))
}

impl Trial {
    /// Uses all logs of the data or, if they are few or long, pieces of them.
    pub fn new(config: &Config, data: &Dataset) -> Self {
        let lengths = |data: &Dataset| match config.training.window {
            Some(window) => vec![window],
            None => lengths::candidates(data),
        };
        let longest = lengths(data).last().copied().unwrap_or_else(|| lengths::usual(data));
        let data = excerpt(data, lengths::steps(longest, data.h));
        Self { folds: folds(&data), lengths: lengths(&data) }
    }

    /// Trains for a few iterations in every fold, from the initial weights or from an earlier result. `None` if nothing is learned in some
    /// fold, or if no log is as long as a window.
    ///
    /// # Errors
    /// See [`Plan::new`].
    pub fn learn(&self, config: &Config, before: Option<&Learned>) -> Result<Option<Learned>, PlanError> {
        let mut own = config.clone();
        own.training.overlap = Some(0.0);
        let mut all = Learned { fits: Vec::new(), held_back: HeldBack::default() };
        for (k, fold) in self.folds.iter().enumerate() {
            let before = before.and_then(|before| before.fits.get(k));
            let mut plan = match Plan::of_fold(own.clone(), fold, before.is_some()) {
                Err(PlanError::Window(_)) => return Ok(None),
                plan => plan?,
            };
            if let Some(before) = before {
                plan.go_on(before);
            }
            let Some(fit) = Fit::new(plan) else { return Ok(None) };
            let Some(held_back) = self.judged(&fit, fold)? else { return Ok(None) };
            all.held_back.0.extend(held_back);
            all.fits.push(fit);
        }
        Ok((!all.fits.is_empty()).then_some(all))
    }

    /// The errors on the logs that a fold holds back; `None` unless they are finite.
    fn judged(&self, fit: &Fit, fold: &Fold) -> Result<Option<Vec<[f64; 2]>>, PlanError> {
        let Fit { plan, weights } = fit;
        let mut errors = Vec::new();
        let Some(windows) = &plan.windows else {
            let judge = plan.stages.last().and_then(|stage| stage.validation.as_ref());
            errors.extend(judge.map(|judge| [judge.held_back_loss(weights).ln(), 1.0]));
            return Ok(finite(errors));
        };
        errors.resize(fold.data.trajectories.len() - fold.training, [0.0; 2]);
        for length in &self.lengths {
            let (of, steps) =
                (fold.training..fold.data.trajectories.len(), lengths::steps(*length, fold.data.h));
            let loss = match windows.loss_of(&plan.architecture, of, steps) {
                Err(PlanError::Window(_)) => continue,
                loss => loss?,
            };
            for (log, logarithm) in loss.held_back_errors(weights) {
                if let Some([sum, lengths]) = errors.get_mut(log - fold.training) {
                    *sum += length * logarithm;
                    *lengths += length;
                }
            }
        }
        Ok(finite(errors))
    }
}

/// The errors, if there are any and all are finite.
fn finite(errors: Vec<[f64; 2]>) -> Option<Vec<[f64; 2]>> {
    let is_finite = errors.iter().all(|[sum, _]| sum.is_finite());
    (is_finite && errors.iter().any(|[_, lengths]| *lengths > 0.0)).then_some(errors)
}

impl Fit {
    /// Takes the final weights of training, not the weights that are best on held-back logs: the latter would favour
    /// configurations with more parameters.
    fn new(plan: Plan) -> Option<Self> {
        let state = plan.last_state()?;
        let mut weights = state.optimiser.weights().to_vec();
        if let Some(layout) = plan.calibration() {
            weights.truncate(layout.end());
        }
        Some(Self { plan, weights })
    }
}

impl Plan {
    /// Keeps only the last stage, and starts it from an earlier result. Newly added correcting networks start almost
    /// without effect.
    fn go_on(&mut self, before: &Fit) {
        self.stages.drain(..self.stages.len().saturating_sub(1));
        self.initial.clone_from(&before.weights);
        let (start, all) = (before.plan.parameters(), self.parameters());
        if all > start {
            self.initial.splice(start..start, self.architecture.corrections.without_effect());
        }
    }
}

impl HeldBack {
    /// The mean logarithm of the mean square.
    fn mean(&self) -> f64 {
        let [sum, lengths] = self.0.iter().fold([0.0; 2], |[a, b], [sum, length]| [a + sum, b + length]);
        sum / lengths
    }

    /// The geometric mean of the errors, m or rad.
    pub fn error(&self) -> f64 {
        (0.5 * self.mean()).exp()
    }

    /// Difference between the mean logarithms of two models on the same logs (self minus other), and its standard
    /// error, with logs taken as independent.
    pub fn beside(&self, other: &Self) -> [f64; 2] {
        let difference = self.mean() - other.mean();
        let count = self.0.len().min(other.0.len()) as f64;
        let off = |(own, other): (&[f64; 2], &[f64; 2])| own[0] - other[0] - difference * own[1];
        let squares: f64 = self.0.iter().zip(&other.0).map(|pair| off(pair).powi(2)).sum();
        let lengths: f64 = self.0.iter().map(|[_, length]| length).sum();
        [difference, (squares * count / (count - 1.0)).sqrt() / lengths]
    }

    /// Whether the error is smaller by more than the standard error of the difference.
    pub fn is_less_than(&self, other: &Self) -> bool {
        let [difference, deviation] = self.beside(other);
        difference < -deviation
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_less_where_that_is_no_chance() {
        let of = |sums: [f64; 3]| HeldBack(sums.iter().zip([1.0, 2.0, 1.0]).map(|(a, b)| [*a, b]).collect());
        let base = of([-2.0, -4.2, -2.2]);
        assert!((base.error() - (-1.05_f64).exp()).abs() < 1e-15);
        let alike = of([-2.1, -4.4, -2.3]);
        let [difference, deviation] = alike.beside(&base);
        assert!((difference + 0.1).abs() < 1e-15 && deviation < 1e-14, "{difference} {deviation}");
        assert!(alike.is_less_than(&base) && !base.is_less_than(&alike));
        // A difference of -0.4 in a single log, not shared by the other logs, gives a mean of -0.1 with a larger
        // standard error.
        let one = of([-2.4, -4.2, -2.2]);
        let [difference, deviation] = one.beside(&base);
        assert!(
            (difference + 0.1).abs() < 1e-15 && (deviation - 0.1146).abs() < 1e-3,
            "{difference} {deviation}"
        );
        assert!(!one.is_less_than(&base) && !base.is_less_than(&base));
    }
}
