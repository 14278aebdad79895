//! Samples for a fit of torques, prepared from a log.

use super::signal::{Butterworth, derivative};
use leastaction_data::{Measured, Rows};
use thiserror::Error;

/// Preparation of samples from a log: linear resampling onto a uniform grid, filtering, differentiation and thinning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preparation {
    /// Step of the uniform grid, which starts at the first stamp (s).
    pub step: f64,
    /// Cut-off frequency of the fourth-order Butterworth filter, run forward and backward over positions, velocities and torques alike
    /// (Hz).
    pub cut_off: f64,
    /// Thinning: one of `every` grid points is kept.
    pub every: usize,
    /// Margin left out at each end (s): there the filter has data on one side only.
    pub margin: f64,
}

impl Default for Preparation {
    /// 1 ms, 20 Hz, one sample per 20 ms, without the first and the last 0.2 s.
    fn default() -> Self {
        Self { step: 1e-3, cut_off: 20.0, every: 20, margin: 0.2 }
    }
}

/// Samples of a motion and its torques.
#[derive(Clone, Debug, PartialEq)]
pub struct Samples {
    /// Times since the first stamp (s).
    pub t: Vec<f64>,
    /// Positions, \[samples\]\[n\] (rad, m).
    pub q: Rows,
    /// Velocities (rad/s, m/s).
    pub v: Rows,
    /// Accelerations (rad/s², m/s²).
    pub a: Rows,
    /// Drive torques and forces (N m, N).
    pub tau: Rows,
}

/// The reason why a log cannot be made into samples.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SampleError {
    /// The cut-off is impossible.
    #[error("a cut-off of {cut_off} Hz at a step of {step} s: it must be between 0 and half the sampling rate, {} Hz", 0.5 / step)]
    CutOff {
        /// Cut-off frequency (Hz).
        cut_off: f64,
        /// Step (s).
        step: f64,
    },
    /// The log is too short for its margins.
    #[error("{duration:.3} s of log: nothing is left without {margin} s at each end")]
    Short {
        /// Duration of the log (s).
        duration: f64,
        /// Margin (s).
        margin: f64,
    },
    /// The log has too many grid points.
    #[error("{duration:.3e} s of log at a step of {step} s are more than {MOST} samples")]
    Long {
        /// Duration of the log (s).
        duration: f64,
        /// Step (s).
        step: f64,
    },
    /// The number of torques differs from the number of positions.
    #[error(
        "{torques} columns of torques and {positions} of positions: there must be one for each coordinate"
    )]
    Torques {
        /// Torque columns.
        torques: usize,
        /// Position columns.
        positions: usize,
    },
}

/// Speed in widths ε that stands for full friction at rest.
const CREEP: f64 = 3.0;
/// Time, s, in which a coordinate of the speed ε passes the distance within which friction turns.
const TURNS_WITHIN: f64 = 0.04;

/// Columns of numbers, one per coordinate.
type Columns = Vec<Vec<f64>>;

/// Largest number of grid points.
const MOST: usize = 1 << 24;
/// Order of the filter.
const ORDER: usize = 4;

impl Preparation {
    fn filter(&self) -> Result<Butterworth, SampleError> {
        let Self { step, cut_off, .. } = *self;
        Butterworth::new(ORDER, cut_off, step).ok_or(SampleError::CutOff { cut_off, step })
    }
}

impl Samples {
    /// Prepares the samples of a log. If the log has no velocities, they are derivatives of the filtered positions.
    ///
    /// # Errors
    /// [`SampleError`].
    pub fn prepare(log: &Measured, how: &Preparation) -> Result<Self, SampleError> {
        let Preparation { step, .. } = *how;
        let filter = how.filter()?;
        let duration = log.t.last().zip(log.t.first()).map_or(0.0, |(last, first)| last - first);
        if duration / step >= MOST as f64 {
            return Err(SampleError::Long { duration, step });
        }
        let start = log.t.first().copied().unwrap_or_default();
        let count = (duration / step + 1e-9) as usize + 1;
        let grid: Vec<f64> = (0..count).map(|k| start + k as f64 * step).collect();
        let even = |rows: &Rows| log.straight(rows, &grid);
        let [v, torques] = [&log.v, &log.u].map(|rows| rows.as_ref().map(even));
        Self::filtered((&even(&log.q), v.as_ref(), torques.as_ref()), &filter, how)
    }

    /// Prepares samples from positions, velocities (if missing, derivatives of positions) and torques that already lie
    /// on the grid of `how`.
    ///
    /// # Errors
    /// [`SampleError`].
    pub fn of_even(
        states: (&Rows, Option<&Rows>, Option<&Rows>),
        how: &Preparation,
    ) -> Result<Self, SampleError> {
        Self::filtered(states, &how.filter()?, how)
    }

    /// Filters, differentiates and thins.
    fn filtered(
        (q, v, torques): (&Rows, Option<&Rows>, Option<&Rows>),
        filter: &Butterworth,
        how: &Preparation,
    ) -> Result<Self, SampleError> {
        let Preparation { step, every, margin, .. } = *how;
        let torques = torques
            .filter(|u| u.width() == q.width())
            .ok_or(SampleError::Torques { torques: torques.map_or(0, Rows::width), positions: q.width() })?;
        let smooth = |rows: &Rows| -> Columns {
            (0..rows.width()).map(|i| filter.filter(&rows.column(i).collect::<Vec<_>>())).collect()
        };
        let slopes = |of: &Columns| -> Columns { of.iter().map(|x| derivative(x, step)).collect() };
        let count = q.len();
        let (q, tau) = (smooth(q), smooth(torques));
        let v = v.map_or_else(|| slopes(&q), smooth);
        let a = slopes(&v);
        let cut = (margin / step).round() as usize;
        let kept: Vec<usize> = (cut..count.saturating_sub(cut)).step_by(every.max(1)).collect();
        if kept.is_empty() {
            return Err(SampleError::Short { duration: count.saturating_sub(1) as f64 * step, margin });
        }
        let rows = |columns: &Columns| {
            let values = kept.iter().flat_map(|k| columns.iter().map(move |column| column[*k])).collect();
            Rows::from_flat(columns.len(), values).expect("as many numbers as rows times columns")
        };
        let t = kept.iter().map(|k| *k as f64 * step).collect();
        Ok(Self { t, q: rows(&q), v: rows(&v), a: rows(&a), tau: rows(&tau) })
    }

    /// The samples with velocities at which the smooth law of friction that sticks, of these widths ε (m/s or rad/s; 0 for a coordinate without
    /// such friction), has the friction of the motion before.
    ///
    /// No state tells the friction at rest, which may take any value up to its level; where a drive holds a joint that it has just moved, it
    /// stays near that level. So the direction of friction is that of a play: s moves with q/δ, but not beyond ±1, where δ = ε · 40 ms is the
    /// distance within which friction turns. Until it has turned, and slower than 3ε, a coordinate has the velocity 3ε s, and tanh 3 = 0.995.
    ///
    /// Source: Dahl, "A solid friction model", 1968, whose limit for a stiff spring this is.
    #[must_use]
    pub fn with_friction_at_rest(mut self, widths: &[f64]) -> Self {
        let n = self.v.width();
        let mut v = self.v.as_flat().to_vec();
        for (i, width) in widths.iter().enumerate().filter(|(_, width)| **width > 0.0) {
            let (mut direction, mut before) = (0.0_f64, None);
            for (q, v) in self.q.column(i).zip(v.iter_mut().skip(i).step_by(n)) {
                let moved = q - before.replace(q).unwrap_or(q);
                direction = (direction + moved / (width * TURNS_WITHIN)).clamp(-1.0, 1.0);
                let has_turned = direction.abs() == 1.0 && direction * *v >= CREEP * width;
                if !has_turned {
                    *v = CREEP * width * direction;
                }
            }
        }
        self.v = Rows::from_flat(n, v).unwrap_or(self.v);
        self
    }

    /// Appends the samples of another log; its times continue from the last.
    ///
    /// # Panics
    /// If `other` has another number of coordinates.
    pub fn append(&mut self, other: &Self) {
        let end = self.t.last().copied().unwrap_or_default();
        self.t.extend(other.t.iter().map(|t| end + t));
        for (own, more) in [
            (&mut self.q, &other.q),
            (&mut self.v, &other.v),
            (&mut self.a, &other.a),
            (&mut self.tau, &other.tau),
        ] {
            let values = [own.as_flat(), more.as_flat()].concat();
            *own = Rows::from_flat(own.width(), values).expect("rows of as many coordinates");
        }
    }

    /// Number of samples.
    #[must_use]
    pub fn count(&self) -> usize {
        self.t.len()
    }

    /// The samples whose time satisfies `is_wanted`.
    #[must_use]
    pub fn at(&self, is_wanted: impl Fn(f64) -> bool) -> Self {
        self.selected(|k| is_wanted(self.t[k]))
    }

    /// The samples whose index satisfies `is_wanted`.
    #[must_use]
    pub fn selected(&self, is_wanted: impl Fn(usize) -> bool) -> Self {
        let kept: Vec<usize> = (0..self.count()).filter(|k| is_wanted(*k)).collect();
        let of = |all: &Rows| all.select(&kept);
        let t = kept.iter().map(|k| self.t[*k]).collect();
        Self { t, q: of(&self.q), v: of(&self.v), a: of(&self.a), tau: of(&self.tau) }
    }
}
