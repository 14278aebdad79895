//! A log of an axis, and stretches of it.

use crate::hardware::error::HardwareError;
use crate::hardware::machine::Machine;
use crate::hardware::polynomial::Polynomial;
use leastaction_learning::data::{Measured, Rows, read_measured};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Samples on each side of the one at which a stretch's measured start is.
const HALF: usize = 10;

/// Consecutive samples that a model learns from or predicts.
#[derive(Clone, Debug, PartialEq)]
pub struct Stretch {
    /// File of these samples alone.
    pub file: PathBuf,
    /// Time between samples, s.
    pub h: f64,
    /// Positions, \[samples\]\[1\] (m).
    pub q: Rows,
    /// Forces of the drive, each held until the next sample, \[samples\]\[1\] (N).
    pub u: Rows,
    /// Sample at which predictions start.
    pub first: usize,
    /// Position (m) and velocity (m/s) there.
    pub start: [f64; 2],
}

impl Stretch {
    /// Reads a log, which starts at rest.
    ///
    /// # Errors
    /// [`HardwareError`] if the file cannot be read, or is no log of at least a second with one step.
    pub fn read(file: &Path) -> Result<Self, HardwareError> {
        let Measured { t, q, u, .. } = read_measured(file, &Machine::Emps.columns())?;
        let h = step(&t).map_err(|what| HardwareError::unusable(file, &what))?;
        // The column was requested.
        let u = u.unwrap_or_else(|| q.slice(0..0));
        let start = [q[0][0], 0.0];
        Ok(Self { file: file.to_owned(), h, q, u, first: 0, start })
    }

    /// Three equal stretches, as files of a folder; each starts where a quadratic through its first 21 samples has its middle.
    ///
    /// # Errors
    /// [`HardwareError::Io`].
    pub fn thirds(&self, folder: &Path) -> Result<[Self; 3], HardwareError> {
        let third = |k: usize| self.cut(folder.join(format!("third-{}.csv", k + 1)), k);
        Ok([third(0)?, third(1)?, third(2)?])
    }

    fn cut(&self, file: PathBuf, third: usize) -> Result<Self, HardwareError> {
        let count = self.q.len() / 3;
        let samples = third * count..(third + 1) * count;
        let [q, u] = [&self.q, &self.u].map(|rows| rows.slice(samples.clone()));
        let [position, velocity, _] = Polynomial::new(HALF, 2, self.h).at(&q, 0).map(|values| values[0]);
        let cut = Self { file, q, u, first: HALF, start: [position, velocity], ..*self };
        cut.write(samples.start)?;
        Ok(cut)
    }

    /// Writes the file; times are those of the whole log, whose sample `start` is the first.
    fn write(&self, start: usize) -> Result<(), HardwareError> {
        let mut text = "time,position,force\n".to_owned();
        for (k, (q, u)) in self.q.as_flat().iter().zip(self.u.as_flat()).enumerate() {
            // Writing to a string does not fail.
            let _ = writeln!(text, "{},{q},{u}", (start + k) as f64 * self.h);
        }
        let failed = |error| HardwareError::Io { path: self.file.clone(), error };
        std::fs::write(&self.file, text).map_err(failed)
    }

    /// Forces of the steps that are predicted, N.
    pub fn forces(&self) -> &[f64] {
        &self.u.as_flat()[self.first..self.u.len() - 1]
    }

    /// Positions that are predicted, m.
    pub fn positions(&self) -> &[f64] {
        &self.q.as_flat()[self.first..]
    }

    /// Root mean square error of predicted positions, m; NaN if a position is missing.
    pub fn error(&self, predicted: &[f64]) -> f64 {
        let positions = self.positions();
        if predicted.len() != positions.len() {
            return f64::NAN;
        }
        let squares = positions.iter().zip(predicted).map(|(q, predicted)| (q - predicted) * (q - predicted));
        (squares.sum::<f64>() / positions.len() as f64).sqrt()
    }
}

/// Largest difference of a sampling interval from their mean, relative to it.
const JITTER: f64 = 0.1;

/// The step of a log.
fn step(t: &[f64]) -> Result<f64, String> {
    let span = t.last().zip(t.first()).map_or(0.0, |(last, first)| last - first);
    let steps = t.len().saturating_sub(1);
    let h = span / steps.max(1) as f64;
    if span < 1.0 || t.len() < 300 {
        return Err(format!("{} samples over {span} s; a log has at least 300 samples and 1 s", t.len()));
    }
    match t.windows(2).position(|pair| ((pair[1] - pair[0]) / h - 1.0).abs() > JITTER) {
        Some(k) => Err(format!(
            "samples {k} and {} are {} s apart, the mean is {h} s; a log must have one step",
            k + 1,
            t[k + 1] - t[k]
        )),
        None => Ok(h),
    }
}
