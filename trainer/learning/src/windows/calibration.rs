use super::logs::WindowLogs;
use crate::data::Rows;
use crate::report::force_unit;
use leastaction_core::forces::ControlKind;
use leastaction_models::Actuator;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Setting of a sensor or actuator number.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Setting {
    /// Known, with this value for every coordinate.
    Known(f64),
    /// Learned from the logs, for each coordinate separately.
    Learned,
}

/// Model of sensors and actuators: q̃ = q + z + noise, with a zero offset z for every coordinate and log, and τ_i = g_i y_i + o_i
/// with T ẏ_i = u_i(t − d) − y_i.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// Whether z (m or rad) is learned; otherwise it is 0.
    pub zero: bool,
    /// Gain g, not 0.
    pub gain: Setting,
    /// Offset o, N or N m.
    pub offset: Setting,
    /// Delay d ≥ 0, s.
    pub delay: Setting,
    /// Time constant T ≥ 0 of the lag, s; known to be 0: none.
    #[serde(default = "Setting::none")]
    pub lag: Setting,
}

impl Setting {
    const fn none() -> Self {
        Self::Known(0.0)
    }
}

impl Default for Calibration {
    /// Ideal sensors and actuators: z = 0, g = 1, o = 0, d = T = 0.
    fn default() -> Self {
        Self {
            zero: false,
            gain: Setting::Known(1.0),
            offset: Setting::Known(0.0),
            delay: Setting::none(),
            lag: Setting::none(),
        }
    }
}

impl Calibration {
    /// The actuator of n coordinates with its known numbers; learned numbers have their ideal values.
    pub fn known_actuator(&self, n: usize) -> Actuator {
        let known = |setting: Setting, ideal: f64| match setting {
            Setting::Known(number) => number,
            Setting::Learned => ideal,
        };
        Actuator {
            gain: vec![known(self.gain, 1.0); n],
            offset: vec![known(self.offset, 0.0); n],
            delay: known(self.delay, 0.0),
            lag: known(self.lag, 0.0),
        }
    }

    /// Whether drives lag, or may lag.
    pub const fn has_lag(&self) -> bool {
        !matches!(self.lag, Setting::Known(0.0))
    }
}

/// Prior standard deviation of a learned z as a part of the coordinate's range in the logs.
const ZERO_SIZE: f64 = 0.01;
/// Prior standard deviation of a learned o as a part of the root mean square of all u.
const OFFSET_SIZE: f64 = 0.05;
/// Prior standard deviation of a learned g around 1.
const GAIN_SIZE: f64 = 0.3;
/// Prior standard deviation of a learned d, s.
const DELAY_SIZE: f64 = 0.02;
/// Upper limit of a learned d, s.
const MOST_DELAY: f64 = 0.2;
/// Value from which a learned T starts, s: at 0 nothing would tell it from a delay.
const FIRST_LAG: f64 = 0.003;
/// Prior standard deviation of a learned T, s.
const LAG_SIZE: f64 = 0.02;
/// Upper limit of a learned T, s.
const MOST_LAG: f64 = 0.2;
/// Lower limit of a learned g.
const LEAST_GAIN: f64 = 0.05;

/// Calibrated sensors and actuators, with learned and known numbers.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Calibrated {
    /// Actuator, from commands to forces.
    #[serde(flatten)]
    pub actuator: Actuator,
    /// Zero offsets z, \[logs\]\[coordinates\], m or rad.
    pub zeros: Vec<Vec<f64>>,
}

impl Calibrated {
    /// Force τ at every sample of a control u with step h (s), as a loss over windows computes it: g y + o, with u constant before the
    /// first sample. For a held u, it is the mean over the step that begins at the sample.
    pub fn forces(&self, u: &Rows, (h, kind): (f64, ControlKind)) -> Option<Rows> {
        if self.actuator.lag > 0.0 {
            return self.lagging_forces(u, (h, kind));
        }
        let (n, late) = (u.width(), self.actuator.delay / h);
        let (whole, part) = (late.floor(), late - late.floor());
        let command = |k: f64, i: usize| u.get(k.max(0.0) as usize).and_then(|row| row.get(i)).copied();
        let force = |k: usize, i: usize| -> Option<f64> {
            let now = k as f64 - whole;
            let mean = (1.0 - part) * command(now, i)? + part * command(now - 1.0, i)?;
            Some(self.actuator.output(i, mean))
        };
        let all = (0..u.len()).flat_map(|k| (0..n).map(move |i| (k, i))).map(|(k, i)| force(k, i));
        Rows::from_flat(n, all.collect::<Option<_>>()?)
    }

    fn lagging_forces(&self, u: &Rows, step: (f64, ControlKind)) -> Option<Rows> {
        let (n, last) = (u.width(), u.len().checked_sub(1)?);
        let command = |k: isize, i: usize| u[usize::try_from(k).unwrap_or(0).min(last)][i];
        let lagging = self.actuator.lagging(step, (u.len(), n), command);
        let force = |(k, i): (usize, usize)| match step.1 {
            ControlKind::Linear => self.actuator.at_sample(step, (k, i), &lagging, |k| command(k, i)),
            ControlKind::Held => {
                let [start, end] = self.actuator.over_step(step, (k, i), &lagging, |k| command(k, i));
                0.5 * (start + end)
            }
        };
        Rows::from_flat(n, (0..u.len()).flat_map(|k| (0..n).map(move |i| (k, i))).map(force).collect())
    }
}

/// Positions of the calibration numbers: g and then o of all coordinates, d, T unless it is known to be 0, and for every log z of all
/// coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CalibrationLayout {
    /// Position of the first number.
    pub start: usize,
    /// Number of coordinates.
    pub n: usize,
    /// Number of logs.
    pub logs: usize,
    /// Settings of the numbers.
    pub calibration: Calibration,
}

/// A penalty weight · (w − centre)² on the number w at a position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Prior {
    pub position: usize,
    pub centre: f64,
    pub weight: f64,
}

impl CalibrationLayout {
    /// The layout after a weight block of `weights` numbers, for these logs.
    pub fn new(weights: usize, logs: &WindowLogs, calibration: Calibration) -> Self {
        Self { start: weights, n: logs.n, logs: logs.count(), calibration }
    }

    /// Position of g_i.
    pub fn gain(&self, i: usize) -> usize {
        self.start + i
    }

    /// Position of o_i.
    pub fn offset(&self, i: usize) -> usize {
        self.start + self.n + i
    }

    /// Position of d.
    pub fn delay(&self) -> usize {
        self.start + 2 * self.n
    }

    /// Position of T, if drives lag.
    pub fn lag(&self) -> Option<usize> {
        self.calibration.has_lag().then(|| self.delay() + 1)
    }

    /// Number of parameters that the control depends on: g, o, d and T.
    pub(super) fn controls(&self) -> usize {
        2 * self.n + 1 + usize::from(self.calibration.has_lag())
    }

    /// Position of z_i of a log.
    pub fn zero(&self, log: usize, i: usize) -> usize {
        self.start + self.controls() + log * self.n + i
    }

    /// Counts of numbers before and after the offsets o.
    pub(crate) fn beside_offsets(&self) -> [usize; 2] {
        [self.offset(0) - self.start, self.end() - self.delay()]
    }

    /// End (exclusive) of the positions of the calibration numbers.
    pub fn end(&self) -> usize {
        self.zero(self.logs, 0)
    }

    /// Initial values of the numbers.
    pub fn initial(&self) -> Vec<f64> {
        let Calibration { gain, offset, delay, lag, .. } = self.calibration;
        let start = |setting, otherwise| match setting {
            Setting::Known(known) => known,
            Setting::Learned => otherwise,
        };
        let mut numbers = vec![start(gain, 1.0); self.n];
        numbers.extend(vec![start(offset, 0.0); self.n]);
        numbers.push(start(delay, 0.0));
        numbers.extend(self.lag().map(|_| start(lag, FIRST_LAG)));
        numbers.resize(self.end() - self.start, 0.0);
        numbers
    }

    /// Initial values after an earlier calibration. Learned numbers start from the earlier values, known ones keep
    /// their own, and zero offsets start anew, since they belong to the earlier logs.
    pub(crate) fn initial_at(&self, before: &Actuator) -> Vec<f64> {
        let Calibration { gain, offset, delay, lag, .. } = self.calibration;
        let mut numbers = self.initial();
        let of_coordinates = |numbers: &mut [f64], setting: Setting, before: &[f64]| {
            let learned = setting == Setting::Learned && numbers.len() == before.len();
            if learned {
                numbers.copy_from_slice(before)
            }
        };
        of_coordinates(&mut numbers[..self.n], gain, &before.gain);
        of_coordinates(&mut numbers[self.n..2 * self.n], offset, &before.offset);
        of_coordinates(&mut numbers[2 * self.n..=2 * self.n], delay, &[before.delay]);
        // An earlier model without a lag says nothing about it.
        if self.lag().is_some() && before.lag > 0.0 {
            of_coordinates(&mut numbers[2 * self.n + 1..self.controls()], lag, &[before.lag]);
        }
        numbers
    }

    /// Reads the calibration from the numbers that windows share.
    pub fn read(&self, weights: &[f64]) -> Calibrated {
        let of = |range: Range<usize>| weights.get(range).unwrap_or_default().to_vec();
        Calibrated {
            actuator: Actuator {
                gain: of(self.gain(0)..self.offset(0)),
                offset: of(self.offset(0)..self.delay()),
                delay: weights.get(self.delay()).copied().unwrap_or_default(),
                lag: self.lag().and_then(|lag| weights.get(lag)).copied().unwrap_or_default(),
            },
            zeros: (0..self.logs).map(|log| of(self.zero(log, 0)..self.zero(log + 1, 0))).collect(),
        }
    }

    /// Name and unit of the number at a position; `unit` gives the unit of q̃_i.
    pub fn name(
        &self,
        position: usize,
        unit: impl Fn(usize) -> &'static str,
    ) -> Option<(String, &'static str)> {
        let place = position.checked_sub(self.start).filter(|_| position < self.end())?;
        let force = |i: usize| force_unit(unit(i));
        Some(match place.checked_sub(self.controls()) {
            Some(zero) => {
                let (log, i) = (zero / self.n, zero % self.n);
                (format!("log {log}, coordinate {i}: zero offset of the encoder"), unit(i))
            }
            None if position == self.delay() => ("delay of the actuator".to_owned(), "s"),
            None if Some(position) == self.lag() => ("lag of the actuator".to_owned(), "s"),
            None if place < self.n => (format!("coordinate {place}: gain of the actuator"), ""),
            None => {
                let i = place - self.n;
                (format!("coordinate {i}: offset of the actuator"), force(i))
            }
        })
    }

    /// The settings of g, o, d and T with their positions.
    fn settings(&self) -> [(Setting, Range<usize>); 4] {
        let Calibration { gain, offset, delay, lag, .. } = self.calibration;
        let of_lag = self.delay() + 1..self.start + self.controls();
        let [of_gain, of_offset] = [self.gain(0), self.offset(0)].map(|first| first..first + self.n);
        [(gain, of_gain), (offset, of_offset), (delay, self.delay()..self.delay() + 1), (lag, of_lag)]
    }

    /// Positions of numbers that are not learned; `learned` says for which logs z is learned.
    pub(super) fn fixed(&self, learned: impl Fn(usize) -> bool) -> Vec<usize> {
        let known = self.settings().into_iter().filter(|(setting, _)| *setting != Setting::Learned);
        let mut fixed: Vec<usize> = known.flat_map(|(_, positions)| positions).collect();
        let logs = (0..self.logs).filter(|log| !self.calibration.zero || !learned(*log));
        fixed.extend(logs.flat_map(|log| self.zero(log, 0)..self.zero(log + 1, 0)));
        fixed
    }

    /// Weak priors on the learned numbers, for directions that these logs do not determine.
    pub(super) fn priors(&self, logs: &WindowLogs, of: Range<usize>) -> Vec<Prior> {
        let Calibration { zero, gain, offset, delay, lag } = self.calibration;
        let mut priors = Vec::new();
        let mut add = |position: usize, centre: f64, size: f64| {
            // Any size will do if nothing moves and no force acts.
            let size = if size == 0.0 { 1.0 } else { size };
            priors.push(Prior { position, centre, weight: 1.0 / (size * size) });
        };
        if gain == Setting::Learned {
            (0..self.n).for_each(|i| add(self.gain(i), 1.0, GAIN_SIZE));
        }
        if offset == Setting::Learned {
            let size = OFFSET_SIZE * logs.control_size(of.clone());
            (0..self.n).for_each(|i| add(self.offset(i), 0.0, size));
        }
        if delay == Setting::Learned {
            add(self.delay(), 0.0, DELAY_SIZE);
        }
        if let Some(position) = self.lag().filter(|_| lag == Setting::Learned) {
            add(position, 0.0, LAG_SIZE);
        }
        if zero {
            let sizes: Vec<f64> = (0..self.n).map(|i| ZERO_SIZE * logs.extent(of.clone(), i)).collect();
            (0..self.logs).for_each(|log| {
                sizes.iter().enumerate().for_each(|(i, size)| add(self.zero(log, i), 0.0, *size));
            });
        }
        priors
    }

    /// Moves learned numbers back into their ranges.
    pub(super) fn project(&self, weights: &mut [f64]) {
        for i in 0..self.n {
            if self.calibration.gain == Setting::Learned {
                weights[self.gain(i)] = weights[self.gain(i)].max(LEAST_GAIN);
            }
        }
        if self.calibration.delay == Setting::Learned {
            weights[self.delay()] = weights[self.delay()].clamp(0.0, MOST_DELAY);
        }
        if let Some(lag) = self.lag().filter(|_| self.calibration.lag == Setting::Learned) {
            weights[lag] = weights[lag].clamp(0.0, MOST_LAG);
        }
    }
}
