//! Statistics of a coordinate's motion, and outliers.

use super::Signal;
use crate::angles::seams;
use crate::intervals::{GAP, Intervals};
use std::f64::consts::TAU;

/// Shortest time over which velocities are computed as differences (s): over shorter times they would be mostly noise.
const SPAN: f64 = 0.02;

/// Fraction of the largest velocity that a velocity must exceed to count as motion.
const SLOW: f64 = 0.02;

/// Multiple of the velocity noise's standard deviation that a velocity must also exceed.
const SURE: f64 = 5.0;

/// Distance of an outlier from the curve through its neighbours, in standard deviations, at least.
const APART: f64 = 10.0;

/// Fraction of this distance within which the neighbours of an outlier and its corrected value must fit a curve.
const ON_LINE: f64 = 0.25;

/// Motion of a coordinate in one file, in the units of its column and seconds.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionSurvey {
    /// Number of differences used for velocities.
    pub samples: usize,
    /// Root mean square of the velocity.
    pub speed: f64,
    /// Fraction of time in motion, 0 to 1.
    pub moving: f64,
    /// Number of reversals, rests left out.
    pub reversals: usize,
    /// Number of jumps by 2π, as in angles wrapped to one turn.
    pub turns: usize,
    /// Number of jumps by 360.
    pub turns_of_360: usize,
    /// Samples off the curve through their neighbours on both sides.
    pub outliers: Vec<Outlier>,
}

/// A single sample off the curve through its neighbours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outlier {
    /// Index of the sample, from 0.
    pub sample: usize,
    /// Stamp (s).
    pub time: f64,
    /// Deviation from the neighbours' curve.
    pub off: f64,
}

impl MotionSurvey {
    /// The motion of values at stamps (s); `None` if there are fewer than five. Samples without a number, or with a stamp not above the one
    /// before, are skipped.
    #[must_use]
    pub fn of(t: &[f64], q: &[f64]) -> Option<Self> {
        let Track { t, mut q, sample } = Track::of(t, q);
        let signal = Signal::of(&q).filter(|_| q.len() >= 5)?;
        let outliers = outliers(&q, &signal);
        let found: Vec<Outlier> =
            outliers.iter().map(|(k, off)| Outlier { sample: sample[*k], time: t[*k], off: *off }).collect();
        outliers.iter().for_each(|(k, off)| q[*k] -= off);
        let (turns, turns_of_360) = (unwrapped(&mut q, TAU), unwrapped(&mut q, 360.0));
        let velocities = Velocities::of(&t, &q, signal.noise)?;
        let all = || velocities.stretches.iter().flatten();
        let samples = all().count();
        let square: f64 = all().map(|v| v * v).sum();
        let moving = all().filter(|v| velocities.moves(**v)).count();
        Some(Self {
            samples,
            speed: (square / samples as f64).sqrt(),
            moving: moving as f64 / samples as f64,
            reversals: velocities.reversals(),
            turns,
            turns_of_360,
            outliers: found,
        })
    }
}

/// Finite samples at increasing stamps, with their indices.
#[derive(Default)]
struct Track {
    t: Vec<f64>,
    q: Vec<f64>,
    sample: Vec<usize>,
}

impl Track {
    fn of(t: &[f64], q: &[f64]) -> Self {
        let mut track = Self::default();
        for (sample, (&t, &q)) in t.iter().zip(q).enumerate() {
            let rises = track.t.last().is_none_or(|before| t > *before);
            if t.is_finite() && q.is_finite() && rises {
                track.t.push(t);
                track.q.push(q);
                track.sample.push(sample);
            }
        }
        track
    }
}

/// Deviation of a value from the cubic through two neighbours on each side: a sixth of the fourth difference.
fn off(x: &[f64], k: usize) -> Option<f64> {
    let [a, b, c, d, e] = *x.get(k.checked_sub(2)?..k + 3)? else { return None };
    Some(c - (4.0 * (b + d) - a - e) / 6.0)
}

/// Outliers with their deviations. A step in the values or a burst of motion is not an outlier: there the neighbours do not fit a curve
/// either.
fn outliers(q: &[f64], signal: &Signal) -> Vec<(usize, f64)> {
    // The variance of this deviation for white noise of standard deviation σ is 70 σ² / 36.
    let deviation = signal.noise * 70f64.sqrt() / 6.0;
    let least = APART * deviation.max(1e-7 * (signal.greatest - signal.least));
    let candidates = (2..q.len().saturating_sub(2)).filter_map(|k| Some((k, off(q, k)?)));
    candidates.filter(|(k, size)| size.abs() > least && is_alone(q, *k, *size)).collect()
}

fn is_alone(q: &[f64], k: usize, size: f64) -> bool {
    let start = k.saturating_sub(4);
    let mut near: Vec<f64> = q.get(start..(k + 5).min(q.len())).unwrap_or_default().to_vec();
    let Some(it) = near.get_mut(k - start) else { return false };
    *it -= size;
    let rest = (0..near.len()).filter_map(|j| off(&near, j));
    rest.fold(0.0, |most: f64, off| most.max(off.abs())) < ON_LINE * size.abs()
}

/// Unwraps an angle; returns the number of seams.
fn unwrapped(q: &mut [f64], turn: f64) -> usize {
    let seams = seams(q, turn);
    let mut turns = 0.0;
    for (q, seam) in q.iter_mut().skip(1).zip(&seams) {
        turns -= f64::from(*seam);
        *q += turns * turn;
    }
    seams.iter().filter(|seam| **seam != 0).count()
}

/// Velocities of the stretches between gaps.
struct Velocities {
    stretches: Vec<Vec<f64>>,
    slow: f64,
}

impl Velocities {
    fn of(t: &[f64], q: &[f64], noise: f64) -> Option<Self> {
        let median = Intervals::of(t.windows(2).map(|pair| pair[1] - pair[0]))?.median;
        let lag = ((SPAN / median).round() as usize).clamp(1, t.len() / 2);
        let rows: Vec<usize> = (0..t.len()).collect();
        let of_stretch = |rows: &[usize]| -> Vec<f64> {
            let ends = rows.iter().zip(rows.iter().skip(lag));
            ends.map(|(from, to)| (q[*to] - q[*from]) / (t[*to] - t[*from])).collect()
        };
        let stretches: Vec<Vec<f64>> =
            rows.chunk_by(|a, b| t[*b] - t[*a] <= GAP * median).map(of_stretch).collect();
        let largest = stretches.iter().flatten().fold(0.0, |most: f64, v| most.max(v.abs()));
        let of_noise = SURE * 2f64.sqrt() * noise / (lag as f64 * median);
        let any = stretches.iter().any(|stretch| !stretch.is_empty());
        any.then_some(Self { stretches, slow: of_noise.max(SLOW * largest) })
    }

    fn moves(&self, v: f64) -> bool {
        v.abs() > self.slow
    }

    fn reversals(&self) -> usize {
        let of_stretch = |stretch: &Vec<f64>| {
            let moving: Vec<f64> = stretch.iter().copied().filter(|v| self.moves(*v)).collect();
            moving.windows(2).filter(|pair| pair[0] * pair[1] < 0.0).count()
        };
        self.stretches.iter().map(of_stretch).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stamps(samples: u32) -> Vec<f64> {
        (0..samples).map(|k| 0.002 * f64::from(k)).collect()
    }

    #[test]
    fn reversals_rests_and_speed_are_those_of_the_motion() {
        // Two whole swings of 1 s, then 2 s of rest.
        let t = stamps(2000);
        let q: Vec<f64> = t.iter().map(|t| if *t < 2.0 { (TAU * t).cos() } else { 1.0 }).collect();
        let motion = MotionSurvey::of(&t, &q).unwrap();
        assert_eq!((motion.reversals, motion.turns, motion.outliers.len()), (3, 0, 0));
        assert!((motion.moving - 0.5).abs() < 0.02, "{motion:?}");
        assert!((motion.speed / (TAU / 2.0) - 1.0).abs() < 0.02, "{motion:?}");
    }

    #[test]
    fn rest_on_an_encoder_is_rest() {
        let t = stamps(3000);
        // Noise of half an encoder count makes the reading flicker between two counts.
        let flicker = |k: usize| if (k * k) % 7 < 3 { 1.0 } else { 0.0 };
        let q: Vec<f64> = (0..t.len()).map(|k| 1e-3 * flicker(k)).collect();
        let motion = MotionSurvey::of(&t, &q).unwrap();
        assert_eq!((motion.reversals, motion.moving, motion.outliers.len()), (0, 0.0, 0), "{motion:?}");
    }

    #[test]
    fn single_samples_apart_are_found_and_nothing_else() {
        let t = stamps(1500);
        let mut q: Vec<f64> = t.iter().map(|t| (3.0 * t).sin()).collect();
        let grid = 1e-3;
        q.iter_mut().for_each(|q| *q = (*q / grid).round() * grid);
        // Neither the step in the values nor the seam is an outlier.
        q[900..].iter_mut().for_each(|q| *q += 0.4);
        q[1200..].iter_mut().for_each(|q| *q -= TAU);
        q[100] += 0.05;
        q[600] -= 2.0;
        let motion = MotionSurvey::of(&t, &q).unwrap();
        let found: Vec<_> = motion.outliers.iter().map(|outlier| outlier.sample).collect();
        assert_eq!((found, motion.turns), (vec![100, 600], 1));
        let Outlier { time, off, .. } = motion.outliers[1];
        assert!(time == t[600] && (off + 2.0).abs() < 2.0 * grid, "{motion:?}");
    }

    #[test]
    fn samples_without_numbers_and_gaps_do_no_harm() {
        let mut t = stamps(400);
        t[200..].iter_mut().for_each(|t| *t += 5.0);
        t[50] = t[49];
        let mut q: Vec<f64> = t.iter().map(|t| if *t < 1.0 { *t } else { -3.0 - *t }).collect();
        q[10] = f64::NAN;
        let motion = MotionSurvey::of(&t, &q).unwrap();
        assert_eq!(motion.reversals, 0);
        assert!((motion.speed - 1.0).abs() < 1e-9 && motion.moving == 1.0, "{motion:?}");
        assert!(MotionSurvey::of(&[0.0; 20], &[1.0; 20]).is_none() && MotionSurvey::of(&[], &[]).is_none());
    }
}
