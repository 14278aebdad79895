//! Short gaps that are bridged, because the motion goes on across them as it does elsewhere.
//!
//! A gap of length Δ is bridged if two conditions hold for every coordinate. Stretches of this length that have all
//! their samples show that linear interpolation between their ends is exact, up to noise or a small part of the
//! coordinate's range. And the motion across the gap agrees with the velocities before and after it,
//! q(Δ) − q(0) ≈ Δ(v₋ + v₊)/2, as well as it does across these stretches: nothing else happened meanwhile.

use crate::Rows;
use crate::in_order::InOrder;

/// Longest gap, in median intervals.
const LONGEST: f64 = 12.0;
/// Samples at either end of a stretch from which its velocity there is taken.
const ENDS: usize = 2;
/// Least number of complete stretches that show how smooth the motion is.
const FEWEST: usize = 20;
/// Largest number of these.
const MOST: usize = 400;
/// Ratio to the 95th percentile of complete stretches within which a gap agrees.
const AGREES: f64 = 3.0;
/// Error of interpolation, relative to the range of the coordinate, that does no harm.
const SMALL: f64 = 1e-3;
/// Error of interpolation, in standard deviations of the noise, that does no harm.
const NOISE: f64 = 3.0;

/// Decides for the gaps of one trajectory.
pub(crate) struct Bridges<'a> {
    q: &'a Rows,
    run: &'a InOrder,
    median: f64,
    /// Longest interval that is no gap.
    longest_step: f64,
    /// Noise and range of every coordinate.
    coordinates: Vec<Coordinate>,
}

/// Size of a coordinate's noise and motion.
struct Coordinate {
    noise: f64,
    range: f64,
}

/// Errors of a stretch in one coordinate: of linear interpolation at its middle, and of the velocities at its ends.
struct Errors {
    middle: f64,
    ends: f64,
}

impl<'a> Bridges<'a> {
    pub(crate) fn new(q: &'a Rows, run: &'a InOrder, (median, longest_step): (f64, f64)) -> Self {
        let mut own = Self { q, run, median, longest_step, coordinates: Vec::new() };
        own.coordinates = (0..q.width()).map(|i| own.coordinate(i)).collect();
        own
    }

    /// Whether the gap before sample `k` is bridged.
    pub(crate) fn bridges(&self, k: usize) -> bool {
        let span = self.run.t[k] - self.run.t[k - 1];
        if span > LONGEST * self.median || !self.has_ends(k - 1, k) {
            return false;
        }
        let stretches: Vec<(usize, usize)> = self.complete(span);
        stretches.len() >= FEWEST
            && (0..self.coordinates.len()).all(|i| self.agrees((k - 1, k), &stretches, i))
    }

    /// Whether coordinate i goes on across a gap as it does across complete stretches.
    fn agrees(&self, gap: (usize, usize), stretches: &[(usize, usize)], i: usize) -> bool {
        let Coordinate { noise, range } = self.coordinates[i];
        let all: Vec<Errors> = stretches.iter().map(|stretch| self.errors(*stretch, i)).collect();
        let usual = |of: fn(&Errors) -> f64| percentile_95(all.iter().map(of).collect());
        let harmless = (NOISE * noise).max(SMALL * range);
        usual(|errors| errors.middle) <= harmless
            && self.errors(gap, i).ends <= AGREES * usual(|errors| errors.ends).max(noise)
    }

    fn position(&self, k: usize, i: usize) -> f64 {
        let row = self.run.rows.get(k).and_then(|row| self.q.get(*row));
        row.and_then(|row| row.get(i)).copied().unwrap_or_default()
    }

    fn errors(&self, (from, to): (usize, usize), i: usize) -> Errors {
        let (t, q) = (&self.run.t, |k: usize| self.position(k, i));
        let velocity = |a: usize, b: usize| (q(b) - q(a)) / (t[b] - t[a]);
        let (span, moved) = (t[to] - t[from], q(to) - q(from));
        let mean = 0.5 * (velocity(from - ENDS, from) + velocity(to, to + ENDS));
        let middle = from.midpoint(to);
        let line = q(from) + moved * (t[middle] - t[from]) / span;
        Errors { middle: (q(middle) - line).abs(), ends: (moved - span * mean).abs() }
    }

    /// Whether no gap lies just before one sample and just after another.
    fn has_ends(&self, from: usize, to: usize) -> bool {
        let fits = from >= ENDS && to + ENDS < self.run.t.len();
        fits && self.is_complete(from - ENDS, from) && self.is_complete(to, to + ENDS)
    }

    fn is_complete(&self, from: usize, to: usize) -> bool {
        self.run.t[from..=to].windows(2).all(|pair| pair[1] - pair[0] <= self.longest_step)
    }

    /// Stretches of about this length without a gap, throughout the trajectory.
    fn complete(&self, span: f64) -> Vec<(usize, usize)> {
        let t = &self.run.t;
        let stretch = |from: usize| {
            let to = from + t[from..].partition_point(|t| *t < self.run.t[from] + span * (1.0 - 1e-6));
            let is_there = to < t.len() && to > from + 1 && self.is_complete(from, to);
            (is_there && self.has_ends(from, to)).then_some((from, to))
        };
        (0..t.len()).step_by(t.len().div_ceil(MOST)).filter_map(stretch).collect()
    }

    /// The noise from second differences, which are small for a motion sampled densely.
    fn coordinate(&self, i: usize) -> Coordinate {
        let count = self.run.t.len();
        let positions = || (0..count).map(|k| self.position(k, i));
        let range = positions().fold(f64::NEG_INFINITY, f64::max) - positions().fold(f64::INFINITY, f64::min);
        let q = |k: usize| self.position(k, i);
        let mut bends: Vec<f64> =
            (1..count.max(2) - 1).map(|k| (q(k - 1) - 2.0 * q(k) + q(k + 1)).abs()).collect();
        bends.sort_unstable_by(f64::total_cmp);
        // The second difference of white noise has √6 times its deviation, the median .6745 of that.
        let noise = bends.get(bends.len() / 2).map_or(0.0, |median| median / (0.6745 * 6.0_f64.sqrt()));
        Coordinate { noise, range }
    }
}

fn percentile_95(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() * 95 / 100).copied().unwrap_or(f64::INFINITY)
}

#[cfg(test)]
mod tests {
    use crate::note::Note;
    use crate::table::{Origin, Table};
    use crate::{Dataset, Rows};

    const H: f64 = 2e-3;

    fn position(t: f64) -> f64 {
        (3.0 * t).sin() + 0.3 * (11.0 * t).sin()
    }

    /// A log of an encoder with a grid, at these stamps.
    fn log(t: &[f64], q: impl Fn(f64) -> f64) -> Table {
        let q = t.iter().map(|t| (q(*t) / 4e-4).round() * 4e-4).collect();
        Table {
            q: Rows::from_flat(1, q).unwrap(),
            v: None,
            a: None,
            u: Rows::from_flat(1, vec![0.0; t.len()]),
            t: Some(t.to_vec()),
            h: None,
            trajectory: None,
            control: None,
            origin: Origin::rows(),
        }
    }

    fn jitter(k: usize) -> f64 {
        0.05 * H * ((k * 7 % 11) as f64 / 11.0 - 0.5)
    }

    fn stamps(count: usize) -> Vec<f64> {
        (0..count).map(|k| k as f64 * H + jitter(k)).collect()
    }

    fn worst(data: &Dataset) -> f64 {
        let errors = data.trajectories.iter().flat_map(|trajectory| {
            data.times(trajectory).zip(trajectory.q.column(0)).map(|(t, q)| (q - position(t)).abs())
        });
        errors.fold(0.0, f64::max)
    }

    #[test]
    fn dropped_samples_are_bridged() {
        let dropped = |k: &usize| k % 23 != 4 && !(100..104).contains(&(k % 500)) && k % 61 != 5;
        let t: Vec<f64> = (0..3000).filter(dropped).map(|k| k as f64 * H + jitter(k)).collect();
        let (data, notes) = log(&t, position).into_even(None).unwrap();
        assert_eq!(data.trajectories.len(), 1, "{notes:?}");
        assert!(notes.iter().any(|note| matches!(note, Note::Bridged { gaps: 6.., .. })), "{notes:?}");
        assert!(worst(&data) < 1.2e-3, "{}", worst(&data));
    }

    #[test]
    fn even_logs_are_bridged_too() {
        let t: Vec<f64> = (0..2000).filter(|k| k % 97 != 50).map(|k| f64::from(k) * H).collect();
        let (data, notes) = log(&t, position).into_even(None).unwrap();
        assert_eq!((data.trajectories.len(), data.h), (1, H), "{notes:?}");
        assert!(matches!(notes[..], [Note::Bridged { gaps: 21, .. }]), "{notes:?}");
    }

    #[test]
    fn a_gap_in_which_something_happened_stays_a_gap() {
        // The log goes on elsewhere after five missing samples.
        let t: Vec<f64> = (0..2000).filter(|k| !(800..805).contains(k)).map(|k| f64::from(k) * H).collect();
        let elsewhere = |t: f64| position(t) + if t >= 800.0 * H { 0.05 } else { 0.0 };
        let (data, notes) = log(&t, elsewhere).into_even(None).unwrap();
        assert_eq!(data.trajectories.len(), 2, "{notes:?}");
    }

    #[test]
    fn a_gap_too_long_for_the_motion_stays_a_gap() {
        let t: Vec<f64> = (0..2000).filter(|k| !(800..811).contains(k)).map(|k| f64::from(k) * H).collect();
        let fast = |t: f64| (200.0 * t).sin();
        let (data, _) = log(&t, fast).into_even(None).unwrap();
        assert_eq!(data.trajectories.len(), 2);
        let long: Vec<f64> =
            (0..2000).filter(|k| !(800..900).contains(k)).map(|k| f64::from(k) * H).collect();
        assert_eq!(log(&long, position).into_even(None).unwrap().0.trajectories.len(), 2);
    }

    #[test]
    fn samples_with_late_stamps_are_left_out() {
        let mut t = stamps(3000);
        let truth = t.clone();
        let late = |k: usize| k % 20 == 7;
        (0..3000).filter(|k| late(*k)).for_each(|k| t[k] += (0.3 + 2.7 * ((k * 13 % 29) as f64 / 29.0)) * H);
        let mut table = log(&truth, position);
        table.t = Some(t);
        let (data, notes) = table.into_even(None).unwrap();
        assert_eq!(data.trajectories.len(), 1, "{notes:?}");
        assert!(notes.iter().any(|note| matches!(note, Note::Late { samples: 100.. })), "{notes:?}");
        // A stamp late by less than half a step is not told from jitter.
        assert!(worst(&data) < 0.5 * H * 6.5, "{}", worst(&data));
    }

    #[test]
    fn a_clock_that_is_set_back_is_an_error() {
        let mut t = stamps(300);
        t[150..].iter_mut().for_each(|t| *t -= 0.1);
        assert!(log(&t, position).into_even(None).is_err());
    }
}
