//! Joining of columns with different clocks into one table with the stamps of the first coordinate's clock.
//!
//! Positions, velocities and linear controls of another clock are interpolated linearly; held controls are averaged
//! from one stamp of the table to the next. Samples of the table that lie in a gap of the other clock, or outside its
//! time span, are left out.

use crate::columns::Column;
use crate::error::Fault;
use crate::in_order::InOrder;
use crate::intervals::{GAP, Intervals};
use crate::note::Note;
use crate::place::Place;
use crate::problem::Problem;
use crate::resample::Track;
use crate::table::{Origin, Table};
use crate::{MIN_SAMPLES, Rows};
use leastaction_core::forces::ControlKind;
use std::ops::Range;

/// Columns, each with its index among all columns of q, v and u.
pub(crate) type Wanted = Vec<(usize, Column)>;

/// Columns with a common clock.
pub(crate) struct Part {
    /// Stamps, s.
    pub t: Vec<f64>,
    /// Values in SI units.
    pub values: Rows,
    pub wanted: Wanted,
    pub origin: Origin,
    /// Control kind that the file states.
    pub control: Option<ControlKind>,
}

/// Numbers of columns of q, v and u.
#[derive(Clone, Copy)]
pub(crate) struct Widths {
    pub q: usize,
    pub v: usize,
    pub u: usize,
}

impl Widths {
    fn is_control(self, index: usize) -> bool {
        index >= self.q + self.v
    }
}

/// Joins all parts into one table; the first part has the first coordinate.
pub(crate) fn joined(
    parts: Vec<Part>,
    widths: Widths,
    control: Option<ControlKind>,
) -> Result<(Table, Vec<Note>), Fault> {
    let mut parts = parts.into_iter();
    let Some(first) = parts.next() else { return Err((Place::File, Problem::Empty)) };
    let mut whole = Whole::new(first, widths)?;
    let stated = whole.control;
    for part in parts {
        let stated = part.control.or(stated);
        whole.add(part, stated.or(control).unwrap_or_default())?;
    }
    whole.table()
}

/// The table under construction: all samples of the first clock, each with a flag that says whether all clocks cover
/// it.
struct Whole {
    widths: Widths,
    t: Vec<f64>,
    origin: Origin,
    control: Option<ControlKind>,
    median: f64,
    columns: Vec<Vec<f64>>,
    covered: Vec<bool>,
    joined: bool,
}

impl Whole {
    fn new(first: Part, widths: Widths) -> Result<Self, Fault> {
        let Part { t, values, wanted, origin, control } = first;
        let median = median(&t);
        let covered = vec![true; t.len()];
        let columns = vec![Vec::new(); widths.q + widths.v + widths.u];
        let mut whole = Self { widths, t, origin, control, median, columns, covered, joined: false };
        whole.put(&wanted, |i| values.column(i).collect());
        Ok(whole)
    }

    fn put(&mut self, wanted: &Wanted, column: impl Fn(usize) -> Vec<f64>) {
        for (i, (index, _)) in wanted.iter().enumerate() {
            if let Some(place) = self.columns.get_mut(*index) {
                *place = column(i);
            }
        }
    }

    /// Resamples a part at the stamps of the table.
    fn add(&mut self, part: Part, control: ControlKind) -> Result<(), Fault> {
        if !self.joined {
            self.only_rising()?;
        }
        let (t, rows) = part.rising()?;
        let longest = GAP * median(&t).max(self.median);
        let track = Track { t: &t, rows: &rows };
        let (at, ends) = (self.t.clone(), self.ends());
        let is_held =
            |(index, _): &(usize, Column)| self.widths.is_control(*index) && control == ControlKind::Held;
        let choice: Vec<bool> = part.wanted.iter().map(is_held).collect();
        let all_held = choice.iter().all(|held| *held);
        for (covered, now) in self.covered.iter_mut().zip(&at) {
            *covered &= covers(&t, *now, longest, all_held);
        }
        let held = choice.contains(&true).then(|| track.averaged(&part.values, &at, &ends));
        let straight = choice.contains(&false).then(|| track.straight(&part.values, &at));
        self.put(&part.wanted, |i| {
            let values = if choice[i] { &held } else { &straight };
            values.iter().flat_map(|values| values.column(i)).collect()
        });
        self.control = self.control.or(part.control);
        Ok(())
    }

    /// End of the time over which the values at a stamp act: the next stamp, but not beyond a gap.
    fn ends(&self) -> Vec<f64> {
        let end = |(k, now): (usize, &f64)| match self.t.get(k + 1) {
            Some(next) => next.min(now + GAP * self.median),
            None => now + self.median,
        };
        self.t.iter().enumerate().map(end).collect()
    }

    /// Drops samples with the same stamp as the one before; an error if time goes back.
    fn only_rising(&mut self) -> Result<(), Fault> {
        self.joined = true;
        let stamps = self.t.iter().copied().enumerate();
        let InOrder { t, rows, .. } = InOrder::of(stamps, |row| self.origin.place("t", row))?;
        let kept = |column: &Vec<f64>| rows.iter().filter_map(|row| column.get(*row).copied()).collect();
        self.columns = self.columns.iter().map(kept).collect();
        self.origin = self.origin.select(&rows);
        self.covered = vec![true; t.len()];
        self.t = t;
        Ok(())
    }

    fn table(self) -> Result<(Table, Vec<Note>), Fault> {
        let rows: Vec<usize> = (0..self.t.len()).filter(|row| self.covered[*row]).collect();
        let missing = self.t.len() - rows.len();
        if rows.len() < MIN_SAMPLES && missing > 0 {
            return Err((Place::File, Problem::NoOverlap { samples: self.t.len(), shared: rows.len() }));
        }
        let field = |range: Range<usize>| {
            let width = range.len();
            let row = |row: &usize| {
                self.columns[range.clone()].iter().map(|column| column[*row]).collect::<Vec<_>>()
            };
            Rows::from_rows(width, rows.iter().map(row)).filter(|_| width > 0)
        };
        let Widths { q, v, u } = self.widths;
        let fields = [field(0..q), field(q..q + v), field(q + v..q + v + u)];
        let [Some(q), v, u] = fields else { return Err((Place::File, Problem::Empty)) };
        let t = Some(rows.iter().map(|row| self.t[*row]).collect());
        let (origin, control) = (self.origin.select(&rows), self.control);
        let table = Table { q, v, a: None, u, t, h: None, trajectory: None, control, origin };
        let note = (missing > 0).then_some(Note::Uncovered { samples: missing });
        Ok((table, note.into_iter().collect()))
    }
}

impl Part {
    /// Stamps, with the rows that they belong to; of equal stamps the first is kept.
    fn rising(&self) -> Result<(Vec<f64>, Vec<usize>), Fault> {
        let stamps = self.t.iter().copied().enumerate();
        let InOrder { t, rows, .. } = InOrder::of(stamps, |row| self.origin.place("t", row))?;
        let too_few = || (Place::File, Problem::NoOverlap { samples: t.len(), shared: 0 });
        if t.len() < 2 { Err(too_few()) } else { Ok((t, rows)) }
    }
}

fn median(t: &[f64]) -> f64 {
    let intervals = t.windows(2).map(|pair| pair[1] - pair[0]).filter(|interval| *interval > 0.0);
    Intervals::of(intervals).map_or(0.0, |intervals| intervals.median)
}

/// Whether a clock has data at a time: the time is in an interval that is not a gap or, for held values, soon after the
/// last stamp.
fn covers(t: &[f64], now: f64, longest: f64, held: bool) -> bool {
    let after = t.partition_point(|stamp| *stamp <= now);
    let Some(before) = after.checked_sub(1).and_then(|before| t.get(before)) else { return false };
    match t.get(after) {
        Some(next) => next - before <= longest || *before == now,
        None => now - before <= if held { longest } else { 0.0 },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(t: &[f64], values: &[f64], index: usize) -> Part {
        Part {
            t: t.to_vec(),
            values: Rows::from_flat(1, values.to_vec()).unwrap(),
            wanted: vec![(index, Column::si("x"))],
            origin: Origin::rows(),
            control: None,
        }
    }

    /// A table with q on stamps `t`, and u on another clock.
    fn with_control(t: &[f64], of_u: &[f64], u: &[f64], control: ControlKind) -> Result<Table, Fault> {
        let widths = Widths { q: 1, v: 0, u: 1 };
        joined(vec![part(t, t, 0), part(of_u, u, 1)], widths, Some(control)).map(|(table, _)| table)
    }

    #[test]
    fn held_controls_keep_their_impulse_and_linear_ones_their_line() {
        let t = [0.0, 0.5, 1.0, 1.5, 2.0];
        let of_u = [-0.25, 0.25, 0.75, 1.25, 1.75, 2.25];
        let u = [1.0, 3.0, 5.0, 7.0, 9.0, 11.0];
        let held = with_control(&t, &of_u, &u, ControlKind::Held).unwrap();
        assert_eq!(held.u.unwrap().as_flat()[..4], [2.0, 4.0, 6.0, 8.0]);
        let linear = with_control(&t, &of_u, &u, ControlKind::Linear).unwrap();
        assert_eq!(linear.u.unwrap().as_flat(), [2.0, 4.0, 6.0, 8.0, 10.0]);
        assert_eq!(linear.t.unwrap(), t);
    }

    #[test]
    fn what_only_one_clock_saw_is_left_out() {
        let t: Vec<f64> = (0..40).map(f64::from).collect();
        let mut of_u: Vec<f64> = (5..30).map(f64::from).collect();
        of_u.drain(10..16);
        let table = with_control(&t, &of_u, &vec![1.0; of_u.len()], ControlKind::Linear).unwrap();
        let kept: Vec<f64> = (5..15).chain(21..30).map(f64::from).collect();
        assert_eq!(table.t.unwrap(), kept);
        assert_eq!((table.origin.place("t", 0), table.q[0][0]), (Origin::rows().place("t", 5), 5.0));
    }

    #[test]
    fn clocks_that_never_ran_together_are_refused() {
        let (t, of_u) = ([0.0, 1.0, 2.0, 3.0], [1e9, 1e9 + 1.0, 1e9 + 2.0]);
        let (_, problem) = with_control(&t, &of_u, &[0.0; 3], ControlKind::Held).err().unwrap();
        assert!(matches!(problem, Problem::NoOverlap { samples: 4, shared: 0 }), "{problem}");
        let (place, problem) =
            with_control(&t, &[0.0, 2.0, 1.0], &[0.0; 3], ControlKind::Held).err().unwrap();
        assert!(matches!(problem, Problem::Unsorted { .. }) && place == Origin::rows().place("t", 2));
    }
}
