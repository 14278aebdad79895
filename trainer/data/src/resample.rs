//! Resampling of uneven samples onto one step.
//!
//! The new samples of a stretch without gaps lie at t₀, t₀ + h, t₀ + 2h, …, with t₀ the stamp of its first sample. Positions, velocities
//! and accelerations are interpolated linearly. A held control, with u_j acting from t_j to t_{j+1}, is averaged over the step in which it
//! acts, which keeps its impulse; a linear control is interpolated.

use crate::bridge::Bridges;
use crate::dataset::positive;
use crate::error::Fault;
use crate::in_order::InOrder;
use crate::intervals::{GAP, Intervals};
use crate::note::{Note, Resampled};
use crate::place::Place;
use crate::problem::Problem;
use crate::table::{Run, Table, Uniform};
use crate::time::rounded;
use crate::{Dataset, MIN_SAMPLES, Rows, Trajectory};
use leastaction_core::forces::ControlKind;
use std::cell::LazyCell;
use std::ops::Range;

/// Tolerance of the default step, relative to the mean interval: within it the decimal number with the fewest digits is
/// taken.
const ROUNDING: f64 = 5e-3;

/// Ratio of an interval to the step above which it is a gap, where all other intervals are steps.
const EVEN_GAP: f64 = 1.5;

/// Ratio of a step to the median interval below which most samples would be invented by interpolation.
const FINEST: f64 = 0.1;

/// The samples of a trajectory in the order of time.
pub(crate) struct Stamped {
    id: i64,
    pub(crate) samples: InOrder,
}

impl Table {
    /// Converts like [`Table::into_dataset`], but resamples if the stamps are uneven or another step is wanted.
    pub(crate) fn into_even(self, wanted: Option<f64>) -> Result<(Dataset, Vec<Note>), Fault> {
        self.check_finite()?;
        match self.uniform() {
            Ok(even) if wanted.is_none_or(|wanted| wanted == even.h) => self.bridged(even),
            Ok(_) | Err((_, Problem::ChangingStep { .. } | Problem::Unsorted { .. })) => {
                self.resampled(wanted)
            }
            Err(fault) => Err(fault),
        }
    }

    /// Bridges the gaps of an even table, if any can be bridged.
    fn bridged(&self, even: Uniform) -> Result<(Dataset, Vec<Note>), Fault> {
        if even.has_gaps() {
            let (data, mut notes) = self.resampled_at(Some(even.h), EVEN_GAP)?;
            if notes.iter().any(|note| matches!(note, Note::Bridged { .. })) {
                notes.retain(|note| !matches!(note, Note::Resampled(_)));
                return Ok((data, notes));
            }
        }
        Ok(self.dataset(even))
    }

    fn resampled(&self, wanted: Option<f64>) -> Result<(Dataset, Vec<Note>), Fault> {
        self.resampled_at(wanted, GAP)
    }

    /// Resamples; an interval of more than `gap` steps and median intervals is a gap.
    fn resampled_at(&self, wanted: Option<f64>, gap: f64) -> Result<(Dataset, Vec<Note>), Fault> {
        let runs = self.runs()?;
        let fresh = runs.iter().map(|run| run.id).max().unwrap_or_default();
        let stamped: Vec<Stamped> =
            runs.into_iter().map(|run| self.stamped(run)).collect::<Result<_, _>>()?;
        let of_run =
            |run: &Stamped| run.samples.t.windows(2).map(|pair| pair[1] - pair[0]).collect::<Vec<_>>();
        let Some(intervals) = Intervals::of(stamped.iter().flat_map(of_run)) else {
            return Err((Place::File, Problem::Empty));
        };
        let mean = intervals.mean_step();
        let h = wanted.unwrap_or_else(|| rounded(mean, ROUNDING * mean));
        positive(h).map_err(|problem| (Place::File, problem))?;
        if h < FINEST * intervals.median {
            return Err((Place::File, Problem::FineStep { h, median: intervals.median }));
        }
        let repeated = stamped.iter().map(|run| run.samples.repeated).sum();
        let late = stamped.iter().map(|run| run.samples.late).sum::<usize>();
        let Intervals { shortest, median, .. } = intervals;
        let longest_step = gap * h.max(median);
        let mut even = Even {
            table: self,
            h,
            median,
            fresh,
            longest_step,
            trajectories: Vec::new(),
            notes: Vec::new(),
            bridged: (0, 0.0),
        };
        stamped.iter().try_for_each(|run| even.take(run))?;
        let Even { trajectories, mut notes, bridged: (gaps, longest_gap), .. } = even;
        if trajectories.is_empty() {
            return Err((Place::File, Problem::Empty));
        }
        let longest = intervals.up_to(longest_step).last().copied().unwrap_or(shortest);
        notes.extend((gaps > 0).then_some(Note::Bridged { gaps, longest: longest_gap }));
        notes.extend((late > 0).then_some(Note::Late { samples: late }));
        notes.insert(0, Note::Resampled(Resampled { h, median, shortest, longest, repeated }));
        Ok((Dataset { n: self.q.width(), h, control: self.control, trajectories }, notes))
    }

    /// The samples of a run in the order of time.
    pub(crate) fn stamped(&self, run: Run) -> Result<Stamped, Fault> {
        let stamps = run.rows.clone().map(|row| (row, self.stamp(row, run.rows.start)));
        Ok(Stamped { id: run.id, samples: InOrder::of(stamps, |row| self.place("t", row))? })
    }
}

/// Trajectories with a common step, under construction.
struct Even<'a> {
    table: &'a Table,
    h: f64,
    /// Median interval of the file, s.
    median: f64,
    /// The largest id so far.
    fresh: i64,
    longest_step: f64,
    trajectories: Vec<Trajectory>,
    notes: Vec<Note>,
    /// Number of bridged gaps, and the longest of them, s.
    bridged: (usize, f64),
}

impl Even<'_> {
    /// Adds the stretches of a run between its gaps.
    fn take(&mut self, run: &Stamped) -> Result<(), Fault> {
        let (mut start, mut id) = (0, run.id);
        let InOrder { t, rows, .. } = &run.samples;
        let (q, intervals) = (&self.table.q, (self.median, self.longest_step));
        let bridges = LazyCell::new(|| Bridges::new(q, &run.samples, intervals));
        for k in 1..=t.len() {
            let interval = t.get(k).map(|now| now - t[k - 1]);
            if interval.is_some_and(|interval| interval <= self.longest_step) {
                continue;
            }
            if let Some(interval) = interval.filter(|_| bridges.bridges(k)) {
                self.bridged = (self.bridged.0 + 1, interval.max(self.bridged.1));
                continue;
            }
            self.keep(run, start..k, id);
            let Some(interval) = interval else { break };
            self.fresh = self.table.id_after(self.fresh, rows[k])?;
            let missing = (interval / self.h).round() as u64 - 1;
            let place = self.table.place("t", rows[k]);
            self.notes.push(Note::Gap { place, trajectory: run.id, missing, continues_as: self.fresh });
            (start, id) = (k, self.fresh);
        }
        Ok(())
    }

    fn keep(&mut self, run: &Stamped, part: Range<usize>, id: i64) {
        let (t, rows) = (&run.samples.t[part.clone()], &run.samples.rows[part.clone()]);
        let span = t.last().zip(t.first()).map_or(0.0, |(last, first)| last - first);
        // The tolerance keeps the last sample in spite of rounding.
        let samples = (span / self.h + 1e-6).floor() as usize + 1;
        if samples < MIN_SAMPLES {
            let place = self.table.place("t", rows.first().copied().unwrap_or_default());
            self.notes.push(Note::Dropped { place, trajectory: run.id, samples });
            return;
        }
        let t0 = t.first().copied().unwrap_or_default();
        let at: Vec<f64> = (0..=samples).map(|k| t0 + k as f64 * self.h).collect();
        let (at, ends) = (&at[..samples], &at[1..]);
        let track = Track { t, rows };
        let straight = |field: &Rows| track.straight(field, at);
        let table = self.table;
        let u = table.u.as_ref().map(|u| match table.control.unwrap_or_default() {
            ControlKind::Held => track.averaged(u, at, ends),
            ControlKind::Linear => track.straight(u, at),
        });
        let (q, v, a) = (straight(&table.q), table.v.as_ref().map(straight), table.a.as_ref().map(straight));
        self.trajectories.push(Trajectory { id, t0, q, v, a, u });
    }
}

/// A stretch of samples without gaps: at least two increasing stamps (s), and the rows of the fields that belong to them.
pub(crate) struct Track<'a> {
    pub(crate) t: &'a [f64],
    pub(crate) rows: &'a [usize],
}

impl Track<'_> {
    fn row<'r>(&self, field: &'r Rows, j: usize) -> &'r [f64] {
        self.rows.get(j).and_then(|row| field.get(*row)).unwrap_or_default()
    }

    /// Interpolates linearly at increasing times.
    pub(crate) fn straight(&self, field: &Rows, at: &[f64]) -> Rows {
        let (mut values, mut j) = (Vec::with_capacity(at.len() * field.width()), 0);
        for now in at {
            while j + 2 < self.t.len() && self.t[j + 1] <= *now {
                j += 1;
            }
            let part = ((now - self.t[j]) / (self.t[j + 1] - self.t[j])).clamp(0.0, 1.0);
            let ends = self.row(field, j).iter().zip(self.row(field, j + 1));
            values.extend(ends.map(|(from, to)| from + part * (to - from)));
        }
        Rows::from_flat(field.width(), values).unwrap_or_else(|| field.slice(0..0))
    }

    /// Averages over consecutive intervals; each sample acts until the next, and the last one from then on.
    pub(crate) fn averaged(&self, field: &Rows, from: &[f64], to: &[f64]) -> Rows {
        let (mut values, mut j) = (Vec::with_capacity(from.len() * field.width()), 0);
        for (from, to) in from.iter().zip(to) {
            while self.t.get(j + 1).is_some_and(|next| next <= from) {
                j += 1;
            }
            values.extend(self.mean(field, j, *from, *to));
        }
        Rows::from_flat(field.width(), values).unwrap_or_else(|| field.slice(0..0))
    }

    /// The mean over [from, to]; sample `first` acts at the beginning.
    fn mean(&self, field: &Rows, first: usize, from: f64, to: f64) -> Vec<f64> {
        let mut sum = vec![0.0; field.width()];
        let mut begin = from;
        for j in first..self.t.len() {
            let end = self.t.get(j + 1).map_or(to, |next| next.min(to));
            for (sum, u) in sum.iter_mut().zip(self.row(field, j)) {
                *sum += (end - begin) * u;
            }
            begin = end;
            if end >= to {
                break;
            }
        }
        sum.iter().map(|sum| sum / (to - from)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(t: &[f64], q: &[f64], u: &[f64]) -> Table {
        Table {
            q: Rows::from_flat(1, q.to_vec()).unwrap(),
            v: None,
            a: None,
            u: Rows::from_flat(1, u.to_vec()),
            t: Some(t.to_vec()),
            h: None,
            trajectory: None,
            control: None,
            origin: crate::table::Origin::rows(),
        }
    }

    fn jittered(samples: usize, h: f64) -> Vec<f64> {
        // A fixed pattern within 10% of the step.
        (0..samples).map(|k| (k as f64 + 0.1 * ((k * 7 % 11) as f64 / 11.0 - 0.5)) * h).collect()
    }

    #[test]
    fn a_straight_motion_stays_straight() {
        let t = jittered(200, 2e-3);
        let q: Vec<f64> = t.iter().map(|t| 3.0 * t - 1.0).collect();
        let (data, notes) = table(&t, &q, &vec![0.0; 200]).into_even(None).unwrap();
        assert_eq!(data.h, 2e-3);
        let trajectory = &data.trajectories[0];
        for (now, q) in data.times(trajectory).zip(trajectory.q.column(0)) {
            assert!((q - (3.0 * now - 1.0)).abs() < 1e-12, "{now} {q}");
        }
        assert!(matches!(notes[..], [Note::Resampled(Resampled { repeated: 0, .. })]), "{notes:?}");
    }

    #[test]
    fn the_impulse_of_a_held_control_stays() {
        let t = jittered(101, 1e-3);
        let u: Vec<f64> = (0..101).map(|k| ((k * k) % 17) as f64).collect();
        let impulse: f64 = t.windows(2).zip(&u).map(|(pair, u)| u * (pair[1] - pair[0])).sum();
        let (data, _) = table(&t, &vec![0.0; 101], &u).into_even(Some(5e-3)).unwrap();
        let even = data.trajectories[0].u.as_ref().unwrap();
        let whole = even.len() - 1;
        let found: f64 = even.column(0).take(whole).map(|u| u * data.h).sum();
        // The last step is partial: the impulse after the last whole step is the rest.
        let end = t[0] + whole as f64 * data.h;
        let rest: f64 = t.windows(2).zip(&u).map(|(pair, u)| u * (pair[1] - pair[0].max(end)).max(0.0)).sum();
        assert!((found + rest - impulse).abs() < 1e-12, "{found} + {rest} instead of {impulse}");
    }

    #[test]
    fn gaps_split_and_repeated_stamps_are_left_out() {
        let mut t = jittered(100, 0.01);
        for late in &mut t[60..] {
            *late += 0.2;
        }
        t[30] = t[29];
        let q: Vec<f64> = (0..100).map(f64::from).collect();
        let (data, notes) = table(&t, &q, &q).into_even(None).unwrap();
        assert_eq!(data.trajectories.iter().map(|t| t.id).collect::<Vec<_>>(), [0, 1]);
        assert!(matches!(notes[0], Note::Resampled(Resampled { repeated: 1, .. })), "{notes:?}");
        assert!(matches!(notes[1], Note::Gap { missing: 20, continues_as: 1, .. }), "{notes:?}");
    }

    #[test]
    fn even_stamps_are_left_as_they_are() {
        let t: Vec<f64> = (0..50).map(|k| f64::from(k) * 0.01).collect();
        let q: Vec<f64> = t.iter().map(|t| (3.0 * t).sin()).collect();
        let (data, notes) = table(&t, &q, &q).into_even(None).unwrap();
        assert_eq!(data.trajectories[0].q.as_flat(), q);
        assert!(notes.is_empty());
        let (coarser, _) = table(&t, &q, &q).into_even(Some(0.02)).unwrap();
        let every_other: Vec<f64> = q.iter().step_by(2).copied().collect();
        for (found, expected) in coarser.trajectories[0].q.column(0).zip(every_other) {
            assert!((found - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn a_step_far_below_the_interval_is_refused() {
        let t = jittered(50, 0.01);
        let (_, problem) = table(&t, &t, &t).into_even(Some(1e-9)).unwrap_err();
        assert!(matches!(problem, Problem::FineStep { h: 1e-9, .. }), "{problem}");
    }

    #[test]
    fn time_that_goes_back_is_refused_with_its_place() {
        let t = [0.0, 0.01, 0.02, 0.03, 0.04, 0.005, 0.015, 0.025];
        let (place, problem) = table(&t, &t, &t).into_even(None).unwrap_err();
        assert_eq!(place, Place::Row { key: "t".to_owned(), row: 5 });
        assert!(matches!(problem, Problem::Unsorted { .. }));
    }
}
