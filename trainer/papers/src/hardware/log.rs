//! Logs of a machine, on the grid.

use super::error::HardwareError;
use super::grid::Grid;
use super::machine::Machine;
use leastaction_learning::data::{Rows, read_measured};
use std::path::{Path, PathBuf};

/// A log with sample k at t₀ + 10k ms.
#[derive(Clone, Debug, PartialEq)]
pub struct Log {
    /// File of the log.
    pub file: PathBuf,
    /// Positions, interpolated linearly, \[samples\]\[n\] (rad).
    pub q: Rows,
    /// Velocities given by the drives, interpolated linearly (rad/s).
    pub v: Rows,
    /// Measured torques, averaged over every step (N m).
    pub measured: Rows,
    /// Commanded torques, averaged over every step, if they are logged (N m).
    pub commanded: Option<Rows>,
}

impl Log {
    /// Reads a file.
    pub fn read(file: &Path, machine: Machine) -> Result<Self, HardwareError> {
        let samples = read_measured(file, &machine.columns())?;
        let grid = Grid::new(file, &samples)?;
        // Every requested column is present in the file.
        let none = || samples.q.slice(0..0);
        let (v, u) = (samples.v.clone().unwrap_or_else(none), samples.u.clone().unwrap_or_else(none));
        let (n, torques) = (machine.joints(), grid.averaged(&u));
        Ok(Self {
            file: file.to_owned(),
            q: grid.straight(&samples.q),
            v: grid.straight(&v),
            measured: columns(&torques, 0, n),
            commanded: machine.logs_commands().then(|| columns(&torques, n, n)),
        })
    }

    /// Number of samples on the grid.
    pub fn samples(&self) -> usize {
        self.q.len()
    }

    /// Number of joints n.
    pub fn joints(&self) -> usize {
        self.q.width()
    }
}

/// Returns `count` columns from `first` on.
fn columns(rows: &Rows, first: usize, count: usize) -> Rows {
    let values = rows.iter().flat_map(|row| row.iter().skip(first).take(count).copied()).collect();
    Rows::from_flat(count, values).unwrap_or_else(|| rows.slice(0..0))
}

/// Reads all logs of a machine in `data`/machine, the `.csv` files in the order of their names.
pub fn read_logs(data: &Path, machine: Machine) -> Result<Vec<Log>, HardwareError> {
    let folder = data.join(machine.name());
    let files = log_files(&folder)?;
    if files.len() < 2 {
        return Err(HardwareError::TooFew { folder, found: files.len() });
    }
    files.iter().map(|file| Log::read(file, machine)).collect()
}

/// The `.csv` files of a folder, in the order of their names.
pub(super) fn log_files(folder: &Path) -> Result<Vec<PathBuf>, HardwareError> {
    let failed = |error| HardwareError::Io { path: folder.to_owned(), error };
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        files.push(entry.map_err(failed)?.path());
    }
    files.retain(|file| file.extension().is_some_and(|kind| kind.eq_ignore_ascii_case("csv")));
    files.sort();
    Ok(files)
}
