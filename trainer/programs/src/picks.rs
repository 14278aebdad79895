//! Rows whose numbers are read from arbitrary positions in other rows.

use crate::row::{Places, Row, WIDTH};

/// Position that stands for no number.
pub(crate) const NOWHERE: u32 = u32::MAX;

/// Plan for reading rows from other rows: whole or shifted rows if neighbouring numbers remain neighbours, otherwise
/// number by number.
#[derive(Clone, Debug, Default)]
pub(crate) struct Picks {
    rows: Box<[Pick]>,
    places: Box<[Places]>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pick {
    /// One number for the whole row.
    Same(u32),
    /// The numbers of the first row from `by` on, followed by those of the second row from its start.
    Shifted { rows: [u32; 2], by: u8 },
    /// The numbers of several rows in turn, or every n-th number of consecutive rows.
    Turned { first: u32, step: u32, turn: u8 },
    /// The positions at this index of the list.
    Any(u32),
}

/// Conversion between columns of several units and numbers one after the other.
#[derive(Clone, Copy, Debug)]
struct Turn {
    /// Number of units in a column.
    units: usize,
    /// Number of the written row in its group.
    part: usize,
    /// Whether the written rows are those of columns.
    to_columns: bool,
    write: fn(&[Row], usize, usize, &mut Row),
}

impl Turn {
    const fn to_columns<const UNITS: usize, const PART: usize>() -> Self {
        Self { units: UNITS, part: PART, to_columns: true, write: turned::<UNITS, PART, true> }
    }

    const fn to_numbers<const UNITS: usize, const PART: usize>() -> Self {
        Self { units: UNITS, part: PART, to_columns: false, write: turned::<UNITS, PART, false> }
    }

    /// Returns the only pick of this kind that could give the row; the caller checks whether it does.
    fn of_row(self, turn: usize, row: &Places) -> Option<Pick> {
        let of = |k: usize| turned_from(k, self.units, self.part, self.to_columns).0;
        let read = |k: usize| (row[k] != NOWHERE).then_some(row[k] as usize / WIDTH);
        let step = (1..WIDTH)
            .find(|k| of(*k) == of(0) + 1)
            .and_then(|k| read(k)?.checked_sub(read(0)?))
            .unwrap_or(1);
        let first = read(0)?.checked_sub(of(0) * step)?;
        Some(Pick::Turned { first: first as u32, step: step as u32, turn: turn as u8 })
    }
}

/// Conversions for columns with as many units as space has coordinates.
const TURNS: [Turn; 10] = [
    Turn::to_columns::<2, 0>(),
    Turn::to_columns::<2, 1>(),
    Turn::to_columns::<3, 0>(),
    Turn::to_columns::<3, 1>(),
    Turn::to_columns::<3, 2>(),
    Turn::to_numbers::<2, 0>(),
    Turn::to_numbers::<2, 1>(),
    Turn::to_numbers::<3, 0>(),
    Turn::to_numbers::<3, 1>(),
    Turn::to_numbers::<3, 2>(),
];

/// Row and lane from which lane k of a converted row is read.
#[inline(always)]
const fn turned_from(k: usize, units: usize, part: usize, to_columns: bool) -> (usize, usize) {
    if to_columns {
        let number = part + units * k;
        (number / WIDTH, number % WIDTH)
    } else {
        let number = WIDTH * part + k;
        (number % units, number / units)
    }
}

fn turned<const UNITS: usize, const PART: usize, const TO_COLUMNS: bool>(
    x: &[Row],
    first: usize,
    step: usize,
    turned: &mut Row,
) {
    // Lanes without a number may refer to rows beyond the last, in place of which the last row is read.
    let mut rows = [&x[first]; UNITS];
    rows.iter_mut().enumerate().for_each(|(row, of)| *of = &x[(first + row * step).min(x.len() - 1)]);
    for k in 0..WIDTH {
        let (row, lane) = turned_from(k, UNITS, PART, TO_COLUMNS);
        turned.0[k] = rows[row].0[lane];
    }
}

impl Picks {
    /// Creates the plan for rows of these positions; a number at [`NOWHERE`] may have any value.
    pub fn new(places: &[u32]) -> Self {
        Self::of(places, |place| place != NOWHERE)
    }

    /// Creates the plan for rows of these positions; a number at [`NOWHERE`] is 0.
    pub fn with_zeros(places: &[u32]) -> Self {
        Self::of(places, |_| true)
    }

    fn of(places: &[u32], matters: impl Fn(u32) -> bool) -> Self {
        let mut others = Vec::new();
        let rows = places.as_chunks().0.iter().map(|row: &Places| {
            let fits = |pick: &Pick| (0..WIDTH).all(|k| !matters(row[k]) || pick.place(k) == Some(row[k]));
            let turned = TURNS.iter().enumerate().filter_map(|(turn, of)| of.of_row(turn, row));
            [Pick::Same(row[0]), shifted(row)].into_iter().chain(turned).find(fits).unwrap_or_else(|| {
                others.push(*row);
                Pick::Any(others.len() as u32 - 1)
            })
        });
        Self { rows: rows.collect(), places: others.into() }
    }

    /// Reads one row of the plan from the rows that contain its positions.
    #[inline(always)]
    pub fn read(&self, row: usize, x: &[Row], to: &mut Row) {
        match self.rows[row] {
            Pick::Same(place) => *to = Row::splat(x[place as usize / WIDTH].0[place as usize % WIDTH]),
            Pick::Shifted { rows: [first, _], by: 0 } => *to = x[first as usize],
            Pick::Shifted { rows: [first, second], by } => {
                SHIFTS[usize::from(by)](&x[first as usize], &x[second as usize], to);
            }
            Pick::Turned { first, step, turn } => {
                (TURNS[usize::from(turn)].write)(x, first as usize, step as usize, to);
            }
            Pick::Any(list) => *to = Row::picked(x, &self.places[list as usize]),
        }
    }

    /// Reads all rows of `to`.
    pub fn write(&self, x: &[Row], to: &mut [Row]) {
        to.iter_mut().enumerate().for_each(|(row, to)| self.read(row, x, to));
    }
}

impl Pick {
    /// Position from which number k of the row is read.
    fn place(self, k: usize) -> Option<u32> {
        match self {
            Self::Same(place) => Some(place),
            Self::Shifted { rows: [first, second], by } => {
                let (k, by) = (k as u32, u32::from(by));
                let own = WIDTH as u32 - by;
                Some(if k < own { first * WIDTH as u32 + by + k } else { second * WIDTH as u32 + k - own })
            }
            Self::Turned { first, step, turn } => {
                let turn = TURNS[usize::from(turn)];
                let (row, lane) = turned_from(k, turn.units, turn.part, turn.to_columns);
                Some((first + row as u32 * step) * WIDTH as u32 + lane as u32)
            }
            Self::Any(_) => None,
        }
    }
}

/// Returns the only shift that could give a row: its first position gives the first source row and the offset, and the
/// position at which the second source row would begin gives that row.
fn shifted(row: &Places) -> Pick {
    let (first, by) = (row[0] / WIDTH as u32, row[0] as usize % WIDTH);
    let next = row.get(WIDTH - by).filter(|next| **next != NOWHERE);
    let second = next.map_or(first, |next| next / WIDTH as u32);
    Pick::Shifted { rows: [first, second], by: by as u8 }
}

/// Shifts by every number of positions, each compiled for a constant number.
const SHIFTS: [fn(&Row, &Row, &mut Row); WIDTH] = [
    shift::<0>,
    shift::<1>,
    shift::<2>,
    shift::<3>,
    shift::<4>,
    shift::<5>,
    shift::<6>,
    shift::<7>,
    shift::<8>,
    shift::<9>,
    shift::<10>,
    shift::<11>,
    shift::<12>,
    shift::<13>,
    shift::<14>,
    shift::<15>,
];

fn shift<const BY: usize>(first: &Row, second: &Row, to: &mut Row) {
    to.0[..WIDTH - BY].copy_from_slice(&first.0[BY..]);
    to.0[WIDTH - BY..].copy_from_slice(&second.0[..BY]);
}

/// Sums of rows read from other rows.
#[derive(Clone, Debug)]
pub(crate) struct PickSums {
    terms: Picks,
    /// End of the summands of every row.
    ends: Box<[usize]>,
}

impl PickSums {
    /// Creates sums whose summands are read from these positions; `ends` says where the summands of each row end.
    pub fn new(places: &[u32], ends: Box<[usize]>) -> Self {
        Self { terms: Picks::with_zeros(places), ends }
    }

    /// Writes all sums of `to`.
    pub fn write(&self, x: &[Row], to: &mut [Row]) {
        let (mut start, mut term) = (0, Row::default());
        for (to, end) in to.iter_mut().zip(&self.ends) {
            if start == *end {
                *to = Row::default();
            } else {
                self.terms.read(start, x, to);
            }
            for row in start + 1..*end {
                self.terms.read(row, x, &mut term);
                to.add_scaled(1.0, &term);
            }
            start = *end;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(count: usize) -> Vec<Row> {
        (0..count).map(|r| Row(std::array::from_fn(|k| (WIDTH * r + k) as f64))).collect()
    }

    #[test]
    fn rows_are_read_from_where_they_are_said_to_be() {
        let width = WIDTH as u32;
        let of = |f: &dyn Fn(u32) -> u32| (0..width).map(f).collect::<Vec<_>>();
        let shift =
            |by: u32| of(&|k| if k + by < width { width + k + by } else { 3 * width + k + by - width });
        let mut lists: Vec<Vec<u32>> = (0..width).map(shift).collect();
        lists.extend([of(&|_| 21), of(&|k| k + k / 9), of(&|k| 63 - k)]);
        lists.extend((0..2).map(|part| of(&|k| 2 * k + part)));
        lists.extend((0..3).map(|part| of(&|k| 3 * k + part)));
        lists.extend((0..2).map(|part| of(&|k| (k % 2) * 2 * width + 8 * part + k / 2)));
        let third = |part: u32, k: u32| width * ((width * part + k) % 3) + (width * part + k) / 3;
        lists.extend((0..3).map(|part| of(&|k| third(part, k))));
        for list in &lists {
            let mut found = Row::default();
            Picks::new(list).read(0, &rows(4), &mut found);
            assert_eq!(found.0.map(|x| x as u32).to_vec(), *list);
        }
        let picks = Picks::new(&lists.concat());
        assert_eq!(
            picks.places.len(),
            2,
            "whole rows, shifted and turned rows and single numbers need no list"
        );
    }

    #[test]
    fn what_is_read_from_nowhere_is_zero_in_sums_and_anything_elsewhere() {
        let mut places: Vec<u32> = (5..5 + WIDTH as u32).collect();
        places[WIDTH - 3..].fill(NOWHERE);
        assert!(Picks::new(&places).places.is_empty());
        let mut sums = rows(2);
        PickSums::new(&[&places[..], &places].concat(), [2, 2].into()).write(&rows(2), &mut sums);
        let expected: Vec<f64> =
            (0..WIDTH).map(|k| if k + 3 < WIDTH { 2.0 * (k + 5) as f64 } else { 0.0 }).collect();
        assert_eq!(sums[0].0.to_vec(), expected);
        assert_eq!(sums[1], Row::default());
    }
}
