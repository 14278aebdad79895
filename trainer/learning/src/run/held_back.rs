//! What configurations that learned from a part of the logs say of the others.

use super::folds::{Fold, excerpt, folds};
use super::lengths;
use super::plan::{Plan, PlanError};
use crate::config::Config;
use crate::data::Dataset;

/// The logs by which configurations are compared.
pub(super) struct Trial {
    folds: Vec<Fold>,
    /// Lengths of windows over which held-back positions are compared, s, the shortest first.
    pub lengths: Vec<f64>,
}

/// What a configuration learned in each fold.
pub(super) struct Learned {
    pub fits: Vec<Fit>,
    pub held_back: HeldBack,
}

/// What was learned in a fold: the numbers that windows share, or all there are.
pub(super) struct Fit {
    pub plan: Plan,
    pub weights: Vec<f64>,
}

/// Errors of held-back positions: of every log the sum of the logarithms of mean squares, (m, rad)², over its windows, each as often as it is
/// long, and the sum of their lengths; where the loss is over single steps, of every fold the logarithm of the held-back loss.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct HeldBack(Vec<[f64; 2]>);

/// How far off positions of a part of the logs are, m or rad, that a model predicts before any iteration: rigid bodies as the linear fit to the
/// torques of the others leaves them, other models as they begin. `None` where nothing finite is predicted, or no log can be held back.
///
/// # Errors
/// As [`Plan::new`].
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
    /// All of these logs, or, where these are few or long, pieces of them.
    pub fn new(config: &Config, data: &Dataset) -> Self {
        let lengths = |data: &Dataset| match config.training.window {
            Some(window) => vec![window],
            None => lengths::candidates(data),
        };
        let longest = lengths(data).last().copied().unwrap_or_else(|| lengths::usual(data));
        let data = excerpt(data, lengths::steps(longest, data.h));
        Self { folds: folds(&data), lengths: lengths(&data) }
    }

    /// A few iterations in every fold, from the initial weights or from what was learned before; `None` where nothing is learned in
    /// some fold, or no log is as long as a window.
    ///
    /// # Errors
    /// As [`Plan::new`].
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

    /// The errors of the logs that a fold holds back; `None` where they are none that is finite.
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

/// These errors, if there are any and all are numbers.
fn finite(errors: Vec<[f64; 2]>) -> Option<Vec<[f64; 2]>> {
    let is_finite = errors.iter().all(|[sum, _]| sum.is_finite());
    (is_finite && errors.iter().any(|[_, lengths]| *lengths > 0.0)).then_some(errors)
}

impl Fit {
    /// The last numbers that training gives, not those that the held-back logs like best: more numbers would have more chances.
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
    /// The last stage alone, from what was learned before: networks that correct a model and were not there act hardly at first.
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
    /// The mean logarithm.
    fn mean(&self) -> f64 {
        let [sum, lengths] = self.0.iter().fold([0.0; 2], |[a, b], [sum, length]| [a + sum, b + length]);
        sum / lengths
    }

    /// The geometric mean of errors, m or rad.
    pub fn error(&self) -> f64 {
        (0.5 * self.mean()).exp()
    }

    /// By how much the logarithm of the mean square is larger than that of another model of the same logs, and the standard error of that,
    /// logs being independent of each other.
    pub fn beside(&self, other: &Self) -> [f64; 2] {
        let difference = self.mean() - other.mean();
        let count = self.0.len().min(other.0.len()) as f64;
        let off = |(own, other): (&[f64; 2], &[f64; 2])| own[0] - other[0] - difference * own[1];
        let squares: f64 = self.0.iter().zip(&other.0).map(|pair| off(pair).powi(2)).sum();
        let lengths: f64 = self.0.iter().map(|[_, length]| length).sum();
        [difference, (squares * count / (count - 1.0)).sqrt() / lengths]
    }

    /// Whether the error is less by more than the standard error of the difference.
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
        // -0.4 of one log alone, whose neighbours know nothing of it: a mean of -0.1 whose standard error is more.
        let one = of([-2.4, -4.2, -2.2]);
        let [difference, deviation] = one.beside(&base);
        assert!(
            (difference + 0.1).abs() < 1e-15 && (deviation - 0.1146).abs() < 1e-3,
            "{difference} {deviation}"
        );
        assert!(!one.is_less_than(&base) && !base.is_less_than(&base));
    }
}
