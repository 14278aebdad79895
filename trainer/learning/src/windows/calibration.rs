use serde::{Deserialize, Serialize};

/// A number of sensors or actuators.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Setting {
    /// It is this, of every coordinate.
    Known(f64),
    /// Of every coordinate another, from the logs.
    Learned,
}

/// Sensors and actuators: q̃ = q + z + noise, z a zero offset of every coordinate and log, and τ_i(t) = g_i u_i(t − d_i) + o_i.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// Whether z is learned, m or rad; else it is 0.
    pub zero: bool,
    /// g, > 0.
    pub gain: Setting,
    /// o, N or N m.
    pub offset: Setting,
    /// d ≥ 0, s.
    pub delay: Setting,
}

impl Default for Calibration {
    /// What is logged is what is: z = 0, g = 1, o = 0, d = 0.
    fn default() -> Self {
        Self {
            zero: false,
            gain: Setting::Known(1.0),
            offset: Setting::Known(0.0),
            delay: Setting::Known(0.0),
        }
    }
}

/// A learned z is expected to be of this size, m or rad.
const ZERO_SIZE: f64 = 0.02;
/// A learned g to be this near to 1.
const GAIN_SIZE: f64 = 0.3;
/// A learned d to be of this size, s.
const DELAY_SIZE: f64 = 0.02;
/// A learned d at most, s.
const MOST_DELAY: f64 = 0.2;
/// A learned g at least.
const LEAST_GAIN: f64 = 0.05;

/// Where the numbers of a calibration are: of all coordinates g, o and d, then of every log z of all coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CalibrationLayout {
    /// Position of the first.
    pub start: usize,
    /// Coordinates.
    pub n: usize,
    /// Logs.
    pub logs: usize,
    /// What is learned.
    pub calibration: Calibration,
    /// The size of u, N or N m: a learned o is expected to be a twentieth of it.
    pub control: f64,
}

/// A penalty weight · (w − centre)² on the number at a position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Prior {
    pub position: usize,
    pub centre: f64,
    pub weight: f64,
}

impl CalibrationLayout {
    /// Position of g_i.
    pub fn gain(&self, i: usize) -> usize {
        self.start + i
    }

    /// Position of o_i.
    pub fn offset(&self, i: usize) -> usize {
        self.start + self.n + i
    }

    /// Position of d_i.
    pub fn delay(&self, i: usize) -> usize {
        self.start + 2 * self.n + i
    }

    /// Position of z_i of a log.
    pub fn zero(&self, log: usize, i: usize) -> usize {
        self.start + 3 * self.n + log * self.n + i
    }

    /// The position after the last.
    pub fn end(&self) -> usize {
        self.zero(self.logs, 0)
    }

    /// The numbers before anything is learned.
    pub fn initial(&self) -> Vec<f64> {
        let Calibration { gain, offset, delay, .. } = self.calibration;
        let start = |setting, otherwise| match setting {
            Setting::Known(known) => known,
            Setting::Learned => otherwise,
        };
        let of = [start(gain, 1.0), start(offset, 0.0), start(delay, 0.0)];
        let mut numbers: Vec<f64> = of.into_iter().flat_map(|x| std::iter::repeat_n(x, self.n)).collect();
        numbers.resize(self.end() - self.start, 0.0);
        numbers
    }

    /// The settings of g, o and d with their first positions.
    fn settings(&self) -> [(Setting, usize); 3] {
        let Calibration { gain, offset, delay, .. } = self.calibration;
        [(gain, self.gain(0)), (offset, self.offset(0)), (delay, self.delay(0))]
    }

    /// Positions of what is not learned, `learned` saying of which logs z is.
    pub(super) fn fixed(&self, learned: impl Fn(usize) -> bool) -> Vec<usize> {
        let known = self.settings().into_iter().filter(|(setting, _)| *setting != Setting::Learned);
        let mut fixed: Vec<usize> = known.flat_map(|(_, first)| first..first + self.n).collect();
        let logs = (0..self.logs).filter(|log| !self.calibration.zero || !learned(*log));
        fixed.extend(logs.flat_map(|log| self.zero(log, 0)..self.zero(log + 1, 0)));
        fixed
    }

    /// What is expected of the numbers before the logs are seen: weak, for what a log does not show.
    pub(super) fn priors(&self) -> Vec<Prior> {
        let offset = 0.05 * self.control.max(f64::MIN_POSITIVE.sqrt());
        let sizes = [(1.0, GAIN_SIZE), (0.0, offset), (0.0, DELAY_SIZE)];
        let mut priors = Vec::new();
        for ((setting, first), (centre, size)) in self.settings().into_iter().zip(sizes) {
            if setting == Setting::Learned {
                let prior = |position| Prior { position, centre, weight: 1.0 / (size * size) };
                priors.extend((first..first + self.n).map(prior));
            }
        }
        if self.calibration.zero {
            let weight = 1.0 / (ZERO_SIZE * ZERO_SIZE);
            let prior = |position| Prior { position, centre: 0.0, weight };
            priors.extend((self.zero(0, 0)..self.end()).map(prior));
        }
        priors
    }

    /// Brings learned numbers back into their range.
    pub(super) fn project(&self, weights: &mut [f64]) {
        for i in 0..self.n {
            if self.calibration.gain == Setting::Learned {
                weights[self.gain(i)] = weights[self.gain(i)].max(LEAST_GAIN);
            }
            if self.calibration.delay == Setting::Learned {
                weights[self.delay(i)] = weights[self.delay(i)].clamp(0.0, MOST_DELAY);
            }
        }
    }
}
