//! Removal of time intervals from logs.

use crate::error::Fault;
use crate::note::Note;
use crate::place::Place;
use crate::problem::Problem;
use crate::table::Table;
use crate::{MIN_SAMPLES, Rows};

impl Table {
    /// Removes the samples whose stamps are in closed intervals (s). The samples after such an interval form a new
    /// trajectory. Pieces of fewer than 3 samples are removed as well.
    pub(crate) fn without(self, intervals: &[(f64, f64)]) -> Result<(Self, Vec<Note>), Fault> {
        self.check_finite()?;
        let (mut rows, mut ids, mut notes) = (Vec::new(), Vec::new(), Vec::new());
        let runs = self.runs()?;
        let mut fresh = runs.iter().map(|run| run.id).max().unwrap_or_default();
        let mut left_out = 0;
        for run in runs {
            let stays = |row: &usize| {
                let t = self.stamp(*row, run.rows.start);
                !intervals.iter().any(|(from, to)| (*from..=*to).contains(&t))
            };
            let kept: Vec<usize> = run.rows.clone().filter(stays).collect();
            left_out += run.rows.len() - kept.len();
            let mut id = Some(run.id);
            for piece in kept.chunk_by(|row, next| row + 1 == *next) {
                if piece.len() < MIN_SAMPLES {
                    let place = self.place("t", piece[0]);
                    notes.push(Note::Dropped { place, trajectory: run.id, samples: piece.len() });
                    continue;
                }
                if id.is_none() {
                    fresh = self.id_after(fresh, piece[0])?;
                }
                rows.extend_from_slice(piece);
                ids.extend(std::iter::repeat_n(id.take().unwrap_or(fresh), piece.len()));
            }
        }
        if rows.is_empty() {
            return Err((Place::File, Problem::AllLeftOut));
        }
        let pieces = ids.chunk_by(|a, b| a == b).count();
        if left_out > 0 {
            notes.insert(0, Note::LeftOut { samples: left_out, pieces });
        }
        Ok((self.selected(&rows, ids), notes))
    }

    /// The stamp of a row (s); counted from the first row of its trajectory if the file only has a step.
    pub(crate) fn stamp(&self, row: usize, first: usize) -> f64 {
        match (&self.t, &self.h) {
            (Some(t), _) => t.get(row).copied().unwrap_or_default(),
            (None, h) => h.as_ref().map_or(0.0, |(h, _)| *h) * (row - first) as f64,
        }
    }

    fn selected(self, rows: &[usize], ids: Vec<i64>) -> Self {
        let of = |field: &Rows| field.select(rows);
        Self {
            q: of(&self.q),
            v: self.v.as_ref().map(of),
            a: self.a.as_ref().map(of),
            u: self.u.as_ref().map(of),
            t: self.t.as_ref().map(|t| rows.iter().filter_map(|row| t.get(*row)).copied().collect()),
            trajectory: Some(ids),
            origin: self.origin.select(rows),
            ..self
        }
    }
}
