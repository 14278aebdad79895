//! Logs cut into windows.

use super::scales::robust_deviation;
use crate::data::{Dataset, Rows};
use leastaction_core::forces::ControlKind;
use std::ops::Range;
use thiserror::Error;

/// Least number of positions from which a state is estimated.
const GUESS: usize = 7;
/// Least time that these positions span, s: over a shorter time noise hides velocities.
const GUESS_TIME: f64 = 0.06;
/// Largest number of positions from which a state is estimated.
const LONGEST_GUESS: usize = 121;
/// Number of states that suffices for a first guess.
const MOST_GUESSES: usize = 20_000;
/// Length of the remainder at the end of a log, relative to the stride, from which on it gets a window of its own.
const REST: f64 = 0.5;

/// Ratio of a window's motion to the root mean square over all windows below which the window counts as at rest.
const AT_REST: f64 = 0.1;

/// Positions and controls of logs with a common step, as a loss over windows reads them.
#[derive(Clone, Debug)]
pub struct WindowLogs {
    /// Number of coordinates.
    pub n: usize,
    /// Step, s.
    pub h: f64,
    /// Behaviour of u between samples.
    pub control: ControlKind,
    logs: Vec<Log>,
}

/// Numbers of a log, \[samples\]\[n\], flat; u is empty if there is no control.
#[derive(Clone, Debug)]
struct Log {
    q: Vec<f64>,
    u: Vec<f64>,
}

/// Consecutive samples of a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Window {
    pub log: usize,
    /// First sample.
    pub first: usize,
}

/// Every log is shorter than a window.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error(
    "no log is as long as a window: a window of {window} s takes {samples} samples, the longest log has {longest}; make the window \
     shorter"
)]
pub struct TooShort {
    /// Length of a window, s.
    pub window: f64,
    /// Samples in a window.
    pub samples: usize,
    /// Samples in the longest log.
    pub longest: usize,
}

impl WindowLogs {
    /// The logs of a data set: every trajectory is a log.
    pub fn new(data: &Dataset) -> Self {
        let flat = |rows: &Rows| rows.as_flat().to_vec();
        let log = |trajectory: &crate::data::Trajectory| Log {
            q: flat(&trajectory.q),
            u: trajectory.u.as_ref().map_or(Vec::new(), flat),
        };
        let logs = data.trajectories.iter().map(log).collect();
        Self { n: data.n, h: data.h, control: data.control_kind(), logs }
    }

    /// Number of logs.
    pub fn count(&self) -> usize {
        self.logs.len()
    }

    /// Number of samples in a log.
    pub fn samples(&self, log: usize) -> usize {
        self.logs[log].q.len() / self.n.max(1)
    }

    /// Number of samples in all logs.
    pub fn all_samples(&self) -> usize {
        (0..self.count()).map(|log| self.samples(log)).sum()
    }

    /// Position i at a sample.
    pub(crate) fn position(&self, log: usize, sample: usize, i: usize) -> f64 {
        self.logs[log].q[sample * self.n + i]
    }

    /// Command u_i at a sample, constant beyond the ends of the log; 0 without control.
    pub(crate) fn command(&self, log: usize, sample: isize, i: usize) -> f64 {
        let last = self.samples(log).saturating_sub(1);
        let sample = usize::try_from(sample).unwrap_or(0).min(last);
        self.logs[log].u.get(sample * self.n + i).copied().unwrap_or(0.0)
    }

    /// Commands u_i that act at samples of logs, given as (log, sample), after a delay (≥ 0, s), and their derivatives with respect to the
    /// delay. A command is constant before the first sample, and 0 without control.
    ///
    /// Between samples the command is interpolated linearly; for a held u the result is also its mean over a step.
    pub(super) fn delayed_control<const L: usize>(
        &self,
        at: [(usize, usize); L],
        i: usize,
        delay: f64,
    ) -> [[f64; L]; 2] {
        let late = delay / self.h;
        let (whole, part) = (late as usize, late.fract());
        let of = |earlier: usize| {
            at.map(|(log, sample)| {
                let u = &self.logs[log].u;
                u.get(sample.saturating_sub(whole + earlier) * self.n + i).copied().unwrap_or(0.0)
            })
        };
        let [before, after] = [of(1), of(0)];
        let value = |lane: usize| after[lane] + part * (before[lane] - after[lane]);
        let slope = |lane: usize| (before[lane] - after[lane]) / self.h;
        [std::array::from_fn(value), std::array::from_fn(slope)]
    }

    /// Number of positions from which a state is estimated; odd.
    fn guessed_from(&self) -> usize {
        ((GUESS_TIME / self.h + 0.5) as usize).clamp(GUESS, LONGEST_GUESS) / 2 * 2 + 1
    }

    /// Windows of `steps` steps over some logs, each beginning `stride` ≥ 1 steps after the one before.
    pub(super) fn windows(
        &self,
        logs: Range<usize>,
        (steps, stride): (usize, usize),
    ) -> Result<Vec<Window>, TooShort> {
        let mut windows = Vec::new();
        for log in logs.clone() {
            let Some(last) = self.samples(log).checked_sub(steps + 1) else { continue };
            windows.extend((0..=last).step_by(stride).map(|first| Window { log, first }));
            if (last % stride) as f64 >= REST * stride as f64 {
                windows.push(Window { log, first: last });
            }
        }
        let longest = logs.map(|log| self.samples(log)).max().unwrap_or(0);
        let too_short = TooShort { window: steps as f64 * self.h, samples: steps + 1, longest };
        if windows.is_empty() { Err(too_short) } else { Ok(windows) }
    }

    /// (q_i, v_i) at the first sample of a window, from a parabola fitted to its first positions.
    pub(super) fn guess(&self, window: Window, steps: usize, i: usize) -> [f64; 2] {
        let count = self.guessed_from().min(steps + 1);
        let positions: Vec<f64> =
            (0..count).map(|k| self.position(window.log, window.first + k, i)).collect();
        let [value, slope] = parabola(&positions);
        [value, slope / self.h]
    }

    /// States q, v and v̇ in the middle of parabolas, each fitted to a few samples, and the mean of u over these
    /// samples, \[states\]\[n\], flat. They are noisy and smoothed, and thus only good for a first guess.
    pub fn smoothed(&self) -> [Vec<f64>; 4] {
        let mut states: [Vec<f64>; 4] = Default::default();
        let count = self.guessed_from();
        let stride = (count / 2).max(self.all_samples() / MOST_GUESSES);
        let shares =
            [Share::Value, Share::Slope, Share::Curvature].map(|share| shares(count, count / 2, share));
        for log in 0..self.count() {
            let last = (self.samples(log) + 1).saturating_sub(count);
            for (first, i) in (0..last).step_by(stride).flat_map(|k| (0..self.n).map(move |i| (k, i))) {
                let sum = |shares: &[f64]| -> f64 {
                    let each = shares.iter().enumerate();
                    each.map(|(k, share)| share * self.position(log, first + k, i)).sum()
                };
                let (value, slope, curvature) = (sum(&shares[0]), sum(&shares[1]), sum(&shares[2]));
                let u = |k: usize| self.command(log, (first + k) as isize, i);
                let force = (0..count).map(u).sum::<f64>() / count as f64;
                let own = [value, slope / self.h, curvature / (self.h * self.h), force];
                states.iter_mut().zip(own).for_each(|(all, x)| all.push(x));
            }
        }
        states
    }

    /// The root mean square of all u in some logs, N or N m.
    pub(super) fn control_size(&self, logs: Range<usize>) -> f64 {
        let all = || self.logs[logs.clone()].iter().flat_map(|log| &log.u);
        let count = all().count().max(1) as f64;
        (all().map(|u| u * u).sum::<f64>() / count).sqrt()
    }

    /// Distance between the least and the greatest q_i in some logs, m or rad.
    pub(super) fn extent(&self, logs: Range<usize>, i: usize) -> f64 {
        let all = self.logs[logs].iter().flat_map(|log| log.q.iter().skip(i).step_by(self.n.max(1)));
        let [least, most] =
            all.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], q| [least.min(*q), most.max(*q)]);
        (most - least).max(0.0)
    }

    /// Size of the motion in windows: the root mean square of q_i minus its first value.
    pub(super) fn motion(&self, windows: &[Window], steps: usize, i: usize) -> f64 {
        let moved = |window: &Window| self.moved(*window, steps, i).powi(2);
        let mean = windows.iter().map(moved).sum::<f64>() / windows.len() as f64;
        mean.sqrt().max(f64::MIN_POSITIVE.sqrt())
    }

    /// Size of the motion of every coordinate in adjacent windows of `steps` steps, m or rad; empty if all logs are shorter.
    pub(crate) fn motions(&self, steps: usize) -> Vec<f64> {
        let windows = self.windows(0..self.count(), (steps, steps)).unwrap_or_default();
        (0..self.n).filter(|_| !windows.is_empty()).map(|i| self.motion(&windows, steps, i)).collect()
    }

    /// Size of the motion in a single window.
    fn moved(&self, window: Window, steps: usize, i: usize) -> f64 {
        let q = |k: usize| self.position(window.log, window.first + k, i);
        let sum: f64 = (1..=steps).map(|k| (q(k) - q(0)).powi(2)).sum();
        (sum / steps as f64).sqrt()
    }

    /// Whether some coordinate moves in a window, relative to the usual `motion` of windows.
    pub(super) fn moves(&self, window: Window, steps: usize, motion: &[f64]) -> bool {
        motion.iter().enumerate().any(|(i, motion)| self.moved(window, steps, i) >= AT_REST * motion)
    }

    /// The root mean square of fourth differences of q_i, taken over samples that are `apart` samples apart.
    pub(super) fn fourth_difference(&self, logs: Range<usize>, i: usize, apart: usize) -> f64 {
        let (mut sum, mut count) = (0.0, 0_usize);
        for log in logs {
            let q = |k: usize| self.position(log, k, i);
            for k in 0..self.samples(log).saturating_sub(4 * apart) {
                let [a, b, c, d, e] = [0, 1, 2, 3, 4].map(|j| q(k + j * apart));
                sum += (a - 4.0 * b + 6.0 * c - 4.0 * d + e).powi(2);
                count += 1;
            }
        }
        (sum / count.max(1) as f64).sqrt()
    }

    /// The noise of sensor i: a robust standard deviation of third differences or, if these also show motion, of fifth
    /// differences, divided by its value for unit noise, √20 or √252.
    pub(crate) fn noise(&self, logs: Range<usize>, i: usize) -> f64 {
        let third = self.difference(logs.clone(), i, &[1.0, -3.0, 3.0, -1.0]) / 20_f64.sqrt();
        let fifth = self.difference(logs, i, &[1.0, -5.0, 10.0, -10.0, 5.0, -1.0]) / 252_f64.sqrt();
        if fifth > 0.0 && fifth < MOTION * third { fifth } else { third }
    }

    /// A robust standard deviation of weighted sums of consecutive positions; `shares` are the weights.
    fn difference(&self, logs: Range<usize>, i: usize, shares: &[f64]) -> f64 {
        let mut differences = Vec::new();
        for log in logs {
            let sum = |k: usize| -> f64 {
                let each = shares.iter().enumerate();
                each.map(|(j, share)| share * self.position(log, k + j, i)).sum()
            };
            let count = (self.samples(log) + 1).saturating_sub(shares.len());
            differences.extend((0..count).map(|k| sum(k).abs()));
        }
        robust_deviation(differences)
    }
}

/// Ratio of the noise estimated from fifth differences to that from third differences, below which the third
/// differences also show motion.
const MOTION: f64 = 0.9;

/// Quantity taken from a fitted parabola.
#[derive(Clone, Copy)]
enum Share {
    Value,
    Slope,
    Curvature,
}

/// Value and slope at 0 of the parabola fitted to values at 0, 1, 2, …; a line or a constant for fewer than three values.
fn parabola(values: &[f64]) -> [f64; 2] {
    [Share::Value, Share::Slope].map(|share| {
        let shares = shares(values.len(), 0, share);
        shares.iter().zip(values).map(|(share, value)| share * value).sum()
    })
}

/// Weights of `count` values at 0, 1, 2, … that give a quantity of the fitted parabola at time `at`. They follow from
/// the orthogonal polynomials 1, t and t² − (mean of t²) about the middle.
fn shares(count: usize, at: usize, of: Share) -> Vec<f64> {
    let middle = 0.5 * (count as f64 - 1.0);
    let times: Vec<f64> = (0..count).map(|k| k as f64 - middle).collect();
    let spread = times.iter().map(|t| t * t).sum::<f64>() / count as f64;
    let basis = |t: f64| [1.0, t, t * t - spread];
    let now = at as f64 - middle;
    let asked = match of {
        Share::Value => basis(now),
        Share::Slope => [0.0, 1.0, 2.0 * now],
        Share::Curvature => [0.0, 0.0, 2.0],
    };
    let norms: Vec<f64> = (0..3).map(|p| times.iter().map(|t| basis(*t)[p] * basis(*t)[p]).sum()).collect();
    let share = |t: f64| -> f64 {
        let own = basis(t);
        (0..3).filter(|p| norms[*p] > 1e-9).map(|p| asked[p] * own[p] / norms[p]).sum()
    };
    times.into_iter().map(share).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Trajectory;
    use rand::{RngExt, SeedableRng};

    fn logs(samples: [usize; 2]) -> WindowLogs {
        let trajectory = |(id, count): (i64, usize)| {
            let q: Vec<f64> = (0..2 * count).map(|k| k as f64).collect();
            let u: Vec<f64> = (0..2 * count).map(|k| (k * k) as f64).collect();
            Trajectory {
                id,
                t0: 0.0,
                q: Rows::from_flat(2, q).unwrap(),
                v: None,
                a: None,
                u: Rows::from_flat(2, u),
            }
        };
        let trajectories = (0..).zip(samples).map(trajectory).collect();
        WindowLogs::new(&Dataset { n: 2, h: 0.5, control: None, trajectories })
    }

    #[test]
    fn windows_lie_side_by_side_and_a_long_rest_has_its_own() {
        let windows = |samples| -> Vec<(usize, usize)> {
            let all = logs(samples).windows(0..2, (4, 4)).unwrap();
            all.iter().map(|window| (window.log, window.first)).collect()
        };
        assert_eq!(windows([10, 3]), [(0, 0), (0, 4)]);
        assert_eq!(windows([11, 5]), [(0, 0), (0, 4), (0, 6), (1, 0)]);
        let refused = logs([3, 4]).windows(0..2, (4, 4)).unwrap_err();
        assert_eq!(refused, TooShort { window: 2.0, samples: 5, longest: 4 });
    }

    #[test]
    fn windows_at_rest_are_told_from_those_that_move() {
        let q = [0.0, 0.1, 0.4, 0.4, 0.4, 0.4, 0.4, 0.41, 0.41].map(|q| [q]);
        let trajectory = Trajectory { id: 0, t0: 0.0, q: Rows::from_arrays(&q), v: None, a: None, u: None };
        let logs = WindowLogs::new(&Dataset { n: 1, h: 0.5, control: None, trajectories: vec![trajectory] });
        let windows = logs.windows(0..1, (4, 4)).unwrap();
        let motion = [logs.motion(&windows, 4, 0)];
        let moves: Vec<bool> = windows.iter().map(|window| logs.moves(*window, 4, &motion)).collect();
        assert_eq!(moves, [true, false]);
    }

    /// A swing at 7 rad/s: at 20 Hz its third differences show motion more than noise of 0.01.
    #[test]
    fn motion_at_long_steps_is_not_taken_for_noise() {
        let mut stream = rand_pcg::Pcg64::seed_from_u64(5);
        let mut q = |k: usize| 3.0 * (0.35 * k as f64).sin() + 0.0173 * stream.random_range(-1.0..1.0);
        let q = Rows::from_flat(1, (0..600).map(&mut q).collect()).unwrap();
        let trajectory = Trajectory { id: 0, t0: 0.0, q, v: None, a: None, u: None };
        let logs = WindowLogs::new(&Dataset { n: 1, h: 0.05, control: None, trajectories: vec![trajectory] });
        let noise = logs.noise(0..1, 0);
        assert!((0.008..0.013).contains(&noise), "{noise}");
    }

    #[test]
    fn a_delay_of_steps_and_of_parts_of_them() {
        let logs = logs([5, 0]);
        let u = |sample: usize| ((2 * sample + 1) * (2 * sample + 1)) as f64;
        let at = |sample: usize, delay: f64| logs.delayed_control([(0, sample)], 1, delay).map(|[x]| x);
        assert_eq!(at(3, 0.0), [u(3), (u(2) - u(3)) / 0.5]);
        assert_eq!(at(3, 0.5), [u(2), (u(1) - u(2)) / 0.5]);
        assert_eq!(at(3, 0.625)[0], 0.75 * u(2) + 0.25 * u(1));
        assert_eq!(at(1, 3.0), [u(0), 0.0]);
    }

    #[test]
    fn a_start_state_is_guessed_by_a_parabola() {
        let values: Vec<f64> = (0..7).map(|k| 2.0 - 0.5 * f64::from(k) + 0.25 * f64::from(k * k)).collect();
        let near = |[value, slope]: [f64; 2], to: [f64; 2]| {
            assert!((value - to[0]).abs() < 1e-12 && (slope - to[1]).abs() < 1e-12, "{value} {slope}");
        };
        near(parabola(&values), [2.0, -0.5]);
        near(parabola(&values[..2]), [2.0, -0.25]);
        near(parabola(&values[..1]), [2.0, 0.0]);
        let curvature: f64 = shares(7, 3, Share::Curvature).iter().zip(&values).map(|(a, b)| a * b).sum();
        assert!((curvature - 0.5).abs() < 1e-12, "{curvature}");
    }
}
