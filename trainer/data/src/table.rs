//! Conversion of a file's flat table to trajectories.

use std::collections::HashSet;
use std::ops::Range;

use leastaction_core::forces::ControlKind;

use crate::dataset::positive;
use crate::error::Fault;
use crate::note::Note;
use crate::place::Place;
use crate::problem::Problem;
use crate::time::Stamps;
use crate::{Dataset, MIN_SAMPLES, Rows, Trajectory};

/// Data of a file, checked for shapes only.
pub(crate) struct Table {
    pub(crate) q: Rows,
    pub(crate) v: Option<Rows>,
    pub(crate) a: Option<Rows>,
    pub(crate) u: Option<Rows>,
    pub(crate) t: Option<Vec<f64>>,
    pub(crate) h: Option<(f64, Place)>,
    pub(crate) trajectory: Option<Vec<i64>>,
    pub(crate) control: Option<ControlKind>,
    /// Places of the samples in the file.
    pub(crate) origin: Origin,
}

/// Places of samples in a file.
pub(crate) enum Origin {
    /// Rows of arrays: those with these indices, or all rows in order.
    Rows(Option<Vec<usize>>),
    /// Line numbers of a CSV file.
    Lines(Vec<u64>),
    /// Numbers of the messages of a bag.
    Messages(Vec<u64>),
}

impl Origin {
    /// Consecutive rows.
    pub(crate) fn rows() -> Self {
        Self::Rows(None)
    }

    /// The places of the selected samples.
    pub(crate) fn select(&self, rows: &[usize]) -> Self {
        let of = |all: &[u64]| rows.iter().filter_map(|row| all.get(*row)).copied().collect();
        match self {
            Self::Rows(None) => Self::Rows(Some(rows.to_vec())),
            Self::Rows(Some(all)) => {
                Self::Rows(Some(rows.iter().filter_map(|row| all.get(*row)).copied().collect()))
            }
            Self::Lines(lines) => Self::Lines(of(lines)),
            Self::Messages(messages) => Self::Messages(of(messages)),
        }
    }

    pub(crate) fn place(&self, key: &str, row: usize) -> Place {
        let at = |all: &[u64]| all.get(row).copied().unwrap_or_default();
        let column = key.to_owned();
        match self {
            Self::Rows(all) => {
                let row = all.as_ref().and_then(|all| all.get(row)).copied().unwrap_or(row);
                Place::Row { key: column, row }
            }
            Self::Lines(lines) => Place::Cell { line: at(lines), column },
            Self::Messages(messages) => Place::Value { message: at(messages), column },
        }
    }
}

/// Division of a table with a uniform step into trajectories.
pub(crate) struct Uniform {
    pub(crate) h: f64,
    pieces: Vec<Run>,
    notes: Vec<Note>,
}

impl Uniform {
    pub(crate) fn has_gaps(&self) -> bool {
        self.notes.iter().any(|note| matches!(note, Note::Gap { .. }))
    }
}

/// A trajectory of the table.
pub(crate) struct Run {
    pub(crate) id: i64,
    pub(crate) rows: Range<usize>,
}

impl Table {
    pub(crate) fn into_dataset(self) -> Result<(Dataset, Vec<Note>), Fault> {
        self.check_finite()?;
        let even = self.uniform()?;
        Ok(self.dataset(even))
    }

    /// The step between stamps, and the pieces between gaps.
    pub(crate) fn uniform(&self) -> Result<Uniform, Fault> {
        let runs = self.runs()?;
        let h = self.step(&runs)?;
        let (pieces, notes) = self.pieces(runs, h)?;
        Ok(Uniform { h, pieces, notes })
    }

    pub(crate) fn dataset(&self, Uniform { h, pieces, notes }: Uniform) -> (Dataset, Vec<Note>) {
        let trajectories = pieces.iter().map(|piece| self.trajectory(piece)).collect();
        (Dataset { n: self.q.width(), h, control: self.control, trajectories }, notes)
    }

    pub(crate) fn place(&self, key: &str, row: usize) -> Place {
        self.origin.place(key, row)
    }

    /// Refuses a table without samples, or with a number that is not finite.
    pub(crate) fn check_finite(&self) -> Result<(), Fault> {
        if self.q.is_empty() {
            return Err((Place::File, Problem::Empty));
        }
        let fields =
            [("q", Some(&self.q)), ("v", self.v.as_ref()), ("a", self.a.as_ref()), ("u", self.u.as_ref())];
        for (key, field) in fields {
            let (values, width) = field.map_or((&[][..], 1), |rows| (rows.as_flat(), rows.width()));
            self.check_values(key, values, width)?;
        }
        self.check_values("t", self.t.as_deref().unwrap_or_default(), 1)
    }

    fn check_values(&self, key: &str, values: &[f64], width: usize) -> Result<(), Fault> {
        match values.iter().position(|x| !x.is_finite()) {
            Some(i) => Err((self.place(key, i / width), Problem::NotFinite(values[i]))),
            None => Ok(()),
        }
    }

    /// The stretches of equal trajectory id.
    pub(crate) fn runs(&self) -> Result<Vec<Run>, Fault> {
        let Some(ids) = &self.trajectory else {
            return self.long_enough(vec![Run { id: 0, rows: 0..self.q.len() }]);
        };
        let (mut runs, mut seen, mut start) = (Vec::new(), HashSet::new(), 0);
        for stretch in ids.chunk_by(|a, b| a == b) {
            let id = stretch.first().copied().unwrap_or_default();
            if !seen.insert(id) {
                return Err((self.place("trajectory", start), Problem::Scattered(id)));
            }
            runs.push(Run { id, rows: start..start + stretch.len() });
            start += stretch.len();
        }
        self.long_enough(runs)
    }

    fn long_enough(&self, runs: Vec<Run>) -> Result<Vec<Run>, Fault> {
        match runs.iter().find(|run| run.rows.len() < MIN_SAMPLES) {
            Some(run) => Err((
                self.place("q", run.rows.start).without_column(),
                Problem::TooShort { id: run.id, samples: run.rows.len() },
            )),
            None => Ok(runs),
        }
    }

    fn step(&self, runs: &[Run]) -> Result<f64, Fault> {
        let ranges: Vec<_> = runs.iter().map(|run| run.rows.clone()).collect();
        let stamps = self.t.as_deref().map(Stamps::new);
        let at_row = |(row, problem)| (self.place("t", row), problem);
        match (&self.h, stamps) {
            (Some((h, place)), stamps) => {
                positive(*h).map_err(|problem| (place.clone(), problem))?;
                let agree = stamps.map_or(Ok(()), |stamps| stamps.agree_with(*h, &ranges));
                agree.map_err(|fault| match fault.1 {
                    Problem::StepMismatch { .. } => (place.clone(), fault.1),
                    _ => at_row(fault),
                })?;
                Ok(*h)
            }
            (None, Some(stamps)) => stamps.step(&ranges).map_err(at_row),
            (None, None) => Err((Place::File, Problem::MissingTime(self.how_to_state_h()))),
        }
    }

    fn how_to_state_h(&self) -> &'static str {
        match self.origin {
            Origin::Lines(_) => "a comment line # h = 0.05",
            _ => "one number under the key h",
        }
    }

    /// Splits trajectories at gaps.
    fn pieces(&self, runs: Vec<Run>, h: f64) -> Result<(Vec<Run>, Vec<Note>), Fault> {
        let Some(t) = &self.t else { return Ok((runs, Vec::new())) };
        let stamps = Stamps::new(t);
        let mut fresh = runs.iter().map(|run| run.id).max().unwrap_or_default();
        let (mut pieces, mut notes) = (Vec::new(), Vec::new());
        for run in runs {
            let gaps = stamps.gaps(&run.rows, h).map_err(|(row, problem)| (self.place("t", row), problem))?;
            let mut start = run.rows.start;
            let mut id = run.id;
            for gap in gaps {
                self.keep(Run { id, rows: start..gap.row }, run.id, &mut pieces, &mut notes);
                start = gap.row;
                fresh = self.id_after(fresh, gap.row)?;
                id = fresh;
                notes.push(Note::Gap {
                    place: self.place("t", gap.row),
                    trajectory: run.id,
                    missing: gap.missing,
                    continues_as: id,
                });
            }
            self.keep(Run { id, rows: start..run.rows.end }, run.id, &mut pieces, &mut notes);
        }
        if pieces.is_empty() { Err((Place::File, Problem::Empty)) } else { Ok((pieces, notes)) }
    }

    /// The next unused id, for a piece that begins at `row`.
    pub(crate) fn id_after(&self, largest: i64, row: usize) -> Result<i64, Fault> {
        let problem = || Problem::NotInteger("the id after the largest one".to_owned());
        largest.checked_add(1).ok_or_else(|| (self.place("trajectory", row), problem()))
    }

    fn keep(&self, piece: Run, trajectory: i64, pieces: &mut Vec<Run>, notes: &mut Vec<Note>) {
        let samples = piece.rows.len();
        if samples < MIN_SAMPLES {
            notes.push(Note::Dropped { place: self.place("t", piece.rows.start), trajectory, samples });
        } else {
            pieces.push(piece);
        }
    }

    fn trajectory(&self, piece: &Run) -> Trajectory {
        let cut = |rows: &Rows| rows.slice(piece.rows.clone());
        Trajectory {
            id: piece.id,
            t0: self.t.as_ref().and_then(|t| t.get(piece.rows.start)).copied().unwrap_or(0.0),
            q: cut(&self.q),
            v: self.v.as_ref().map(cut),
            a: self.a.as_ref().map(cut),
            u: self.u.as_ref().map(cut),
        }
    }
}
