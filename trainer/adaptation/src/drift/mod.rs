//! Drift of a machine from day to day: whether the errors of a model along a log are still those along a reference.

mod fisher;
mod signs;
mod windows;

pub use windows::{Moment, Windows};

use serde::Serialize;
use signs::{SIGNS, Scales, Sign};
use thiserror::Error;

/// Errors along a log compared with those along a reference of the same kind of motion.
///
/// Every coordinate has up to five signs of drift, means over the windows of a log: of its error ([`Difference::mean`]), of the error times the
/// direction of motion and times the command, and of the squared error of windows and of single ticks. With the mean x̄ over the n windows of
/// the log and x̄₀ over the n₀ of the reference, z = (x̄ − x̄₀)/√(σ²(1/n + 1/n₀)), for squares x̄₀ ln(x̄/x̄₀) in place of x̄ − x̄₀. Errors
/// last, so σ²/L is the variance of the means over B ≤ 20 blocks of L windows of the reference, at least four times as long as the errors are
/// correlated.
///
/// The value is the sum of z² over its expectation, thus near 1 if nothing has changed; squares count where they grow. It is compared with a
/// quantile of Fisher's F distribution with ν₁ and ν₂ degrees of freedom: ν₁ is twice the squared mean of the sum over its variance, which
/// follows from the correlations between the signs, and ν₂ = ¾(B − 1).
///
/// Assumed: the days are alike but for noise, their motions drawn from the same kind. Another kind of motion shows other errors of the model.
///
/// Sources: B. Schmeiser, "Batch size effects in the analysis of simulation output", 1982; F. Satterthwaite, "An approximate distribution of
/// estimates of variance components", 1946.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Drift {
    /// Mean squared difference from the reference over that of days without change.
    pub value: f64,
    /// Value that a day without change exceeds at the rate of false alarms.
    pub threshold: f64,
    /// Degrees of freedom ν₁, ν₂ of the value.
    pub freedom: [f64; 2],
    /// Root mean square error over windows, each coordinate's as a share of the reference's.
    pub errors: f64,
    /// Differences of the coordinates.
    pub coordinates: Vec<Difference>,
}

/// Difference of a coordinate from the reference, in standard errors; `None` for a sign that the reference does not show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Difference {
    /// Value over the signs of this coordinate alone.
    pub value: f64,
    /// Root mean square error over windows as a share of the reference's.
    pub errors: f64,
    /// Mean error: offset of a drive or encoder, or gravity.
    pub mean: Option<f64>,
    /// Mean error in the direction of motion: negative for more friction.
    pub direction: Option<f64>,
    /// Mean error in the direction of the command, less its mean: a load or a gain.
    pub command: Option<f64>,
    /// Mean squared error over windows: forces that the model does not know.
    pub windows: Option<f64>,
    /// Mean squared error of single ticks: noise, vibration, backlash.
    pub ticks: Option<f64>,
}

/// Reason why logs cannot be compared.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum DriftError {
    /// The log has no whole window.
    #[error("the log is shorter than a window")]
    NoWindow,
    /// The reference has too few independent parts.
    #[error(
        "the reference is too short: its {windows} windows are as good as {independent:.0} independent ones, and {LEAST_INDEPENDENT} are needed"
    )]
    TooShort {
        /// Number of windows.
        windows: usize,
        /// Number of independent windows with a mean as uncertain.
        independent: f64,
    },
    /// The logs differ in size.
    #[error("the reference has {} coordinates, the log {}", .0[0], .0[1])]
    Coordinates([usize; 2]),
    /// The model has no errors along the reference.
    #[error("the model has no errors along the reference")]
    Exact,
}

/// Smallest number of blocks of the reference.
const LEAST_BLOCKS: usize = 10;
/// Smallest number of independent windows of the reference.
const LEAST_INDEPENDENT: f64 = 20.0;
/// Degrees of freedom of a variance over those of normal blocks: blocks of squares have longer tails, so their variance is less certain.
const FREEDOM: f64 = 0.75;
/// Variance over squared mean of the square of a normal number that counts where it is positive alone.
const LARGEST_VARIANCE: f64 = 5.0;
/// Largest number of blocks: more make the threshold hardly lower, and errors that cancel in a motion to and fro do so in long blocks alone.
const MOST_BLOCKS: usize = 20;
/// Least length of a block, in times of correlation.
const BLOCK: f64 = 4.0;

impl Drift {
    /// Compares a log with a reference at a rate of false alarms per log, within (0, 1).
    ///
    /// # Errors
    /// [`DriftError`].
    pub fn new(reference: &Windows, log: &Windows, false_alarms: f64) -> Result<Self, DriftError> {
        if log.is_empty() {
            return Err(DriftError::NoWindow);
        }
        if !reference.is_empty() && reference.coordinates() != log.coordinates() {
            return Err(DriftError::Coordinates([reference, log].map(Windows::coordinates)));
        }
        let scales = Scales::new(reference);
        let (own, other) = (scales.signs(reference), scales.signs(log));
        let signs: Vec<Sign> = own.iter().map(|sign| Sign::new(sign)).collect();
        let blocks = Blocks::new(&own, &signs)?;
        let share = (1.0 / reference.len() as f64 + 1.0 / log.len() as f64) * blocks.length as f64;
        let difference = |k: usize| {
            let (variance, before, now) = (blocks.variance[k] * share, signs[k].mean, mean(&other[k]));
            let difference = if signs::is_square(k) { before * (now / before).ln() } else { now - before };
            (variance > 0.0).then(|| difference / variance.sqrt())
        };
        let z: Vec<_> = (0..own.len()).map(difference).collect();
        let coordinates: Vec<_> = z.chunks(SIGNS).zip(other.chunks(SIGNS)).map(of_coordinate).collect();
        let freedom = blocks.freedom();
        Ok(Self {
            value: value(&z).ok_or(DriftError::Exact)?,
            threshold: fisher::quantile(freedom, false_alarms),
            freedom,
            errors: mean(&coordinates.iter().map(|of| of.errors * of.errors).collect::<Vec<_>>()).sqrt(),
            coordinates,
        })
    }

    /// Whether the machine is no longer the one of the reference.
    pub fn has_drifted(&self) -> bool {
        self.value > self.threshold
    }
}

/// Mean of the squared differences over what is expected; `None` without any.
fn value(z: &[Option<f64>]) -> Option<f64> {
    let (mut sum, mut expected) = (0.0, 0.0);
    for (k, z) in z.iter().enumerate().filter_map(|(k, z)| Some((k, (*z)?))) {
        sum += if signs::is_square(k) { z.max(0.0).powi(2) } else { z * z };
        expected += signs::expected(k);
    }
    (expected > 0.0).then(|| sum / expected)
}

fn of_coordinate((z, log): (&[Option<f64>], &[Vec<f64>])) -> Difference {
    let [mean_error, direction, command, windows, ticks] = core::array::from_fn(|k| z[k]);
    Difference {
        value: value(z).unwrap_or(0.0),
        errors: mean(&log[signs::WINDOWS]).sqrt(),
        mean: mean_error,
        direction,
        command,
        windows,
        ticks,
    }
}

/// Means of signs over blocks of the reference.
struct Blocks {
    /// Windows of a block.
    length: usize,
    /// Deviations of the blocks of every sign from their mean.
    deviations: Vec<Vec<f64>>,
    /// Variance of the blocks of every sign.
    variance: Vec<f64>,
}

impl Blocks {
    fn new(reference: &[Vec<f64>], signs: &[Sign]) -> Result<Self, DriftError> {
        let windows = reference.first().map_or(0, Vec::len);
        let shown: Vec<f64> = signs.iter().filter(|sign| sign.variance > 0.0).map(|sign| sign.time).collect();
        if windows > 0 && shown.is_empty() {
            return Err(DriftError::Exact);
        }
        let time = mean(&shown);
        let independent = if windows > 0 { windows as f64 / time } else { 0.0 };
        if independent < LEAST_INDEPENDENT {
            return Err(DriftError::TooShort { windows, independent });
        }
        let length = ((BLOCK * time).ceil() as usize).max(windows / MOST_BLOCKS).min(windows / LEAST_BLOCKS);
        let deviations: Vec<_> = reference.iter().map(|sign| deviations(sign, length)).collect();
        // Blocks of an error that lasts τ windows vary by about τ/2L less than blocks that are independent.
        let kept = |sign: &Sign| 1.0 - (0.5 * sign.time / length as f64).min(0.5);
        let variance = deviations.iter().zip(signs).map(|(of, sign)| product(of, of) / kept(sign)).collect();
        Ok(Self { length, deviations, variance })
    }

    /// Degrees of freedom of the value: ν₁ = 2 E²/Var of its sum, and those of the blocks' variance.
    fn freedom(&self) -> [f64; 2] {
        let shown: Vec<usize> = (0..self.variance.len()).filter(|k| self.variance[*k] > 0.0).collect();
        let blocks = self.deviations[0].len() as f64;
        let expected: f64 = shown.iter().map(|k| signs::expected(*k)).sum();
        let pairs = shown.iter().flat_map(|k| shown.iter().map(move |l| (*k, *l)));
        let variance: f64 =
            pairs.map(|(k, l)| signs::covariance([k, l], self.correlation(k, l), blocks - 1.0)).sum();
        // All signs may be one, or all independent.
        let [least, most] = [2.0 / LARGEST_VARIANCE, shown.len() as f64];
        [(2.0 * expected * expected / variance).clamp(least, most), FREEDOM * (blocks - 1.0)]
    }

    /// Correlation of the blocks of two signs.
    fn correlation(&self, k: usize, l: usize) -> f64 {
        let product = |k: usize, l: usize| product(&self.deviations[k], &self.deviations[l]);
        product(k, l) / (product(k, k) * product(l, l)).sqrt()
    }
}

/// Deviations of the means over whole blocks from their mean.
fn deviations(of: &[f64], length: usize) -> Vec<f64> {
    let blocks: Vec<f64> = of.chunks_exact(length).map(mean).collect();
    let mean = mean(&blocks);
    blocks.iter().map(|block| block - mean).collect()
}

/// Covariance of deviations from means.
fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / (a.len() as f64 - 1.0)
}

fn mean(of: &[f64]) -> f64 {
    of.iter().sum::<f64>() / of.len() as f64
}
