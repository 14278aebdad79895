//! Trajectories in memory.

use crate::error::Fault;
use crate::place::Place;
use crate::problem::Problem;
use crate::rows::Rows;
use crate::time;
use leastaction_core::forces::ControlKind;
use std::ops::Range;

/// Least number of samples in a trajectory: one discrete Euler–Lagrange equation.
pub const MIN_SAMPLES: usize = 3;

/// One uninterrupted, uniformly sampled motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    /// Number in the file; unique in a data set.
    pub id: i64,
    /// Time of the first sample (s).
    pub t0: f64,
    /// Generalised coordinates, \[samples\]\[n\] (m, rad).
    pub q: Rows,
    /// Velocities (m/s, rad/s).
    pub v: Option<Rows>,
    /// Accelerations (m/s², rad/s²).
    pub a: Option<Rows>,
    /// Controls as generalised forces (N, N·m). If they are held, the last row is unused: no step follows it.
    pub u: Option<Rows>,
}

impl Trajectory {
    /// Number of samples.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.q.len()
    }

    /// Consecutive samples of a trajectory whose step is h (s); sample indices beyond the last are ignored.
    #[must_use]
    pub fn part(&self, samples: Range<usize>, h: f64) -> Self {
        let rows: Vec<usize> = samples.clone().collect();
        let of = |field: &Rows| field.select(&rows);
        Self {
            id: self.id,
            t0: self.t0 + samples.start as f64 * h,
            q: of(&self.q),
            v: self.v.as_ref().map(of),
            a: self.a.as_ref().map(of),
            u: self.u.as_ref().map(of),
        }
    }

    /// Fields with their names in files.
    pub(crate) fn fields(&self) -> [(&'static str, Option<&Rows>); 4] {
        [("q", Some(&self.q)), ("v", self.v.as_ref()), ("a", self.a.as_ref()), ("u", self.u.as_ref())]
    }

    fn check(&self, n: usize) -> Result<(), Problem> {
        let samples = self.samples();
        if samples < MIN_SAMPLES {
            return Err(Problem::TooShort { id: self.id, samples });
        }
        for (name, rows) in self.fields().into_iter().filter_map(|(name, rows)| Some((name, rows?))) {
            expect(name, "columns", rows.width(), n)?;
            expect(name, "samples", rows.len(), samples)?;
            finite(rows.as_flat())?;
        }
        finite(&[self.t0])
    }
}

pub(crate) fn expect(
    name: &'static str,
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), Problem> {
    if found == expected { Ok(()) } else { Err(Problem::Inconsistent { name, what, found, expected }) }
}

pub(crate) fn finite(values: &[f64]) -> Result<(), Problem> {
    values.iter().find(|x| !x.is_finite()).map_or(Ok(()), |&x| Err(Problem::NotFinite(x)))
}

/// Trajectories of one mechanism, all with the same number of coordinates n and step h.
#[derive(Debug, Clone, PartialEq)]
pub struct Dataset {
    /// Number of coordinates.
    pub n: usize,
    /// Time between samples (s).
    pub h: f64,
    /// Control kind, if the file states it.
    pub control: Option<ControlKind>,
    /// The motions, in the order of the file.
    pub trajectories: Vec<Trajectory>,
}

impl Dataset {
    /// Number of samples in all trajectories together.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.trajectories.iter().map(Trajectory::samples).sum()
    }

    /// Whether a control other than zero acts on any sample.
    #[must_use]
    pub fn is_forced(&self) -> bool {
        let forced = |t: &Trajectory| t.u.as_ref().is_some_and(|u| u.as_flat().iter().any(|u| *u != 0.0));
        self.trajectories.iter().any(forced)
    }

    /// The control kind; held unless stated otherwise.
    #[must_use]
    pub fn control_kind(&self) -> ControlKind {
        self.control.unwrap_or_default()
    }

    /// The sample whose u acts at the end of the step from sample `k`: `k` itself if u is held, the next one if u is
    /// linear.
    #[must_use]
    pub fn control_end(&self, k: usize) -> usize {
        match self.control_kind() {
            ControlKind::Held => k,
            ControlKind::Linear => k + 1,
        }
    }

    /// Whether u changes during any trajectory, so that its behaviour between samples matters.
    #[must_use]
    pub fn control_changes(&self) -> bool {
        let changes = |u: &Rows| u.iter().skip(1).any(|row| u.iter().next() != Some(row));
        self.trajectories.iter().any(|t| t.u.as_ref().is_some_and(changes))
    }

    /// Sets the control kind.
    ///
    /// # Errors
    /// The control kind of the file, if it differs and u changes.
    pub fn set_control(&mut self, kind: ControlKind) -> Result<(), ControlKind> {
        match self.control {
            Some(stated) if stated != kind && self.control_changes() => Err(stated),
            _ => {
                self.control = Some(kind);
                Ok(())
            }
        }
    }

    /// The first `k` trajectories, or all if there are fewer.
    #[must_use]
    pub fn truncated(&self, k: usize) -> Self {
        self.split(k).0
    }

    /// The first `k` trajectories and the rest.
    #[must_use]
    pub fn split(&self, k: usize) -> (Self, Self) {
        let (first, rest) = self.trajectories.split_at(k.min(self.trajectories.len()));
        (self.with(first.to_vec()), self.with(rest.to_vec()))
    }

    /// The stamps of a trajectory, t₀ + k h (s).
    pub fn times<'a>(&self, trajectory: &'a Trajectory) -> impl Iterator<Item = f64> + use<'a> {
        let (t0, h) = (trajectory.t0, self.h);
        (0..trajectory.samples()).map(move |k| t0 + k as f64 * h)
    }

    pub(crate) fn with(&self, trajectories: Vec<Trajectory>) -> Self {
        Self { trajectories, ..*self }
    }

    /// Refuses a data set that [`read`] would refuse.
    pub(crate) fn check(&self) -> Result<(), Fault> {
        positive(self.h).map_err(|problem| (Place::File, problem))?;
        if self.trajectories.is_empty() {
            return Err((Place::File, Problem::Empty));
        }
        let mut ids = std::collections::HashSet::new();
        for trajectory in &self.trajectories {
            let at = |problem| (Place::Trajectory(trajectory.id), problem);
            trajectory.check(self.n).map_err(at)?;
            time::check(&self.times(trajectory).collect::<Vec<_>>(), self.h).map_err(at)?;
            if !ids.insert(trajectory.id) {
                return Err(at(Problem::SameId(trajectory.id)));
            }
        }
        self.fields_everywhere()
    }

    pub(crate) fn fields_everywhere(&self) -> Result<(), Fault> {
        for (i, name) in ["v", "a", "u"].into_iter().enumerate() {
            let given = self.trajectories.iter().filter(|t| t.fields()[i + 1].1.is_some()).count();
            if given != 0 && given != self.trajectories.len() {
                return Err((Place::File, Problem::Partial(name)));
            }
        }
        Ok(())
    }
}

pub(crate) fn positive(h: f64) -> Result<(), Problem> {
    if h.is_finite() && h > 0.0 { Ok(()) } else { Err(Problem::BadStep(h)) }
}
