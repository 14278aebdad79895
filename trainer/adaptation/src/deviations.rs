//! How well a model explains the balance of momentum along a log.

use crate::ticks::Ticks;
use crate::{AdaptationError, Choice};
use leastaction_data::Dataset;
use leastaction_models::Model;
use leastaction_replica::Replica;

/// Standard deviations of the balance of every coordinate along a log on which the model is right, N or N m: those of independent windows that
/// are as uncertain in their mean as these are, whose errors last.
///
/// With the autocorrelation ρ_l of the residuals over l windows, the variance of a mean is 1 + 2 Σ ρ_l times that of independent ones; the sum
/// ends at the first ρ_l that is not positive. A mean that is not 0 counts as an error.
///
/// # Errors
/// [`AdaptationError`].
pub fn deviations(
    (model, chip): (&Model, &Replica),
    choice: &Choice,
    data: &Dataset,
) -> Result<Vec<f32>, AdaptationError> {
    let mut residuals: Vec<Vec<Vec<f32>>> = Vec::new();
    for trajectory in &data.trajectories {
        let ticks = Ticks::new((model, chip), data, trajectory)?;
        residuals.push(along(chip, choice, &ticks)?);
    }
    let windows: usize = residuals.iter().map(Vec::len).sum();
    if windows == 0 {
        let longest = data.trajectories.iter().map(|trajectory| trajectory.samples()).max().unwrap_or(0);
        return Err(AdaptationError::TooShort { window: choice.window(), longest: longest as f64 * data.h });
    }
    Ok(of_windows(&residuals, model.n()))
}

/// Standard deviations of the balance of n coordinates whose residuals are given, one list of windows for each run; see [`deviations`].
pub fn of_windows(residuals: &[Vec<Vec<f32>>], n: usize) -> Vec<f32> {
    (0..n).map(|i| deviation(residuals, i) as f32).collect()
}

/// Residuals of the balance in every whole window of a trajectory.
fn along(chip: &Replica, choice: &Choice, ticks: &Ticks) -> Result<Vec<Vec<f32>>, AdaptationError> {
    let mut adaptation = chip.adaptation(&choice.settings)?;
    let mut residuals = Vec::new();
    for k in 0..ticks.len() {
        if adaptation.take(ticks.at(k))?.is_some() {
            residuals.push(adaptation.findings().residuals().to_vec());
        }
    }
    Ok(residuals)
}

fn deviation(residuals: &[Vec<Vec<f32>>], i: usize) -> f64 {
    let product = |lag: usize| {
        let pairs = residuals.iter().flat_map(|one| one.iter().zip(one.iter().skip(lag)));
        let (sum, count) =
            pairs.fold((0.0, 0), |(sum, count), (a, b)| (sum + f64::from(a[i]) * f64::from(b[i]), count + 1));
        if count > 0 { sum / f64::from(count) } else { 0.0 }
    };
    let variance = product(0);
    let windows = residuals.iter().map(Vec::len).max().unwrap_or(0);
    (variance + 2.0 * lasting(windows, product)).sqrt()
}

/// Sum of the covariances of values with those some windows later, over a quarter of the `windows`; it ends at the first that is not positive.
pub(crate) fn lasting(windows: usize, covariance: impl Fn(usize) -> f64) -> f64 {
    (1..=windows / 4).map(covariance).take_while(|covariance| *covariance > 0.0).sum()
}
