//! Errors of predictions over windows of a log.

use core::f64::consts::TAU;

/// Errors of a model along a log, as means over windows that overlap by half, with the smooth weight (1 − cos 2πt/t_w)/t_w.
///
/// Noise of single readings nearly vanishes in such a mean, as an error that one reading causes is taken back with the next ones; errors of the
/// model's forces stay.
#[derive(Clone, Debug, PartialEq)]
pub struct Windows {
    half: usize,
    open: Vec<Sample>,
    /// Windows that are whole, in order of time.
    pub(super) whole: Vec<Vec<Coordinate>>,
}

/// Motion of a coordinate at a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moment {
    /// Error of the prediction, reading minus prediction, rad or m.
    pub error: f64,
    /// Velocity, rad/s or m/s.
    pub velocity: f64,
    /// Command; 0 for a log without.
    pub command: f64,
}

/// Moments of all coordinates at a tick.
type Sample = Vec<Moment>;

/// Means of a coordinate over a window.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Coordinate {
    /// Smooth means of the error, the velocity and the command.
    pub mean: Moment,
    /// Mean of the squared error of single ticks.
    pub square: f64,
}

/// Length of a window, s.
const WINDOW: f64 = 0.2;
/// Smallest number of ticks of a window, of a log with long recordings.
const LEAST_TICKS: usize = 40;
/// Smallest number of windows, end to end, of the longest recording.
const LEAST_WINDOWS: usize = 4;

impl Windows {
    /// Windows for ticks of h seconds in recordings of up to `longest` ticks: .2 s, at least 40 ticks, and at most a quarter of a recording.
    pub fn new(h: f64, longest: usize) -> Self {
        let ticks = ((WINDOW / h).round() as usize).max(LEAST_TICKS).min(longest / LEAST_WINDOWS);
        Self { half: (ticks / 2).max(1), open: Vec::new(), whole: Vec::new() }
    }

    /// Windows as long as these, without contents.
    #[must_use]
    pub fn emptied(&self) -> Self {
        Self { half: self.half, open: Vec::new(), whole: Vec::new() }
    }

    /// Takes a tick that follows the one before.
    pub fn take(&mut self, sample: impl IntoIterator<Item = Moment>) {
        self.open.push(sample.into_iter().collect());
        if self.open.len() == 2 * self.half {
            self.whole.push(means(&self.open));
            self.open.drain(..self.half);
        }
    }

    /// Drops the window that is open: the next tick does not follow the one before.
    pub fn interrupt(&mut self) {
        self.open.clear();
    }

    /// Number of whole windows.
    pub fn len(&self) -> usize {
        self.whole.len()
    }

    /// Number of coordinates; 0 before a window is whole.
    pub fn coordinates(&self) -> usize {
        self.whole.first().map_or(0, Vec::len)
    }

    /// Whether no window is whole.
    pub fn is_empty(&self) -> bool {
        self.whole.is_empty()
    }
}

fn means(samples: &[Sample]) -> Vec<Coordinate> {
    let count = samples.len() as f64;
    let mut sums = vec![Coordinate::default(); samples.first().map_or(0, Vec::len)];
    for (k, sample) in samples.iter().enumerate() {
        let weight = (1.0 - (TAU * (k as f64 + 0.5) / count).cos()) / count;
        for (sum, moment) in sums.iter_mut().zip(sample) {
            sum.mean.error += weight * moment.error;
            sum.mean.velocity += weight * moment.velocity;
            sum.mean.command += weight * moment.command;
            sum.square += moment.error * moment.error / count;
        }
    }
    sums
}
