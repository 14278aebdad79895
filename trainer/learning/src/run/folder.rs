//! The folder of a run: checkpoint, configuration, history, loss curve and report.

use super::RunError;
use super::state::Row;
use crate::checkpoint;
use crate::config::Config;
use crate::lock::{self, Lock};
use leastaction_plot::{self as plot, PlotError};
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// History file, one line per iteration.
const HISTORY: &str = "history.csv";
/// The configuration as it was read, every key written out.
const CONFIG: &str = "config.toml";
/// Plot of the history.
const LOSS_CURVE: &str = "loss.svg";
/// Report on a run over windows.
const REPORT: &str = "report.html";

const HEAD: &str = "iteration,stage,seconds,train,validation\n";

/// The folder that holds the files of a run.
#[derive(Clone, Debug)]
pub(super) struct Folder {
    pub path: PathBuf,
}

impl Folder {
    pub fn checkpoint(&self) -> PathBuf {
        self.path.join(checkpoint::FILE)
    }

    pub fn loss_curve(&self) -> PathBuf {
        self.path.join(LOSS_CURVE)
    }

    pub fn report(&self) -> PathBuf {
        self.path.join(REPORT)
    }

    /// Whether the folder holds anything besides a lock.
    pub fn is_used(&self) -> bool {
        match fs::read_dir(&self.path) {
            Ok(entries) => entries.flatten().any(|entry| entry.file_name() != lock::FILE),
            // Either a file has this name, or the folder is not readable.
            Err(_) => self.path.symlink_metadata().is_ok(),
        }
    }

    /// Whether a run has used the folder, or is using it.
    pub fn has_lock(&self) -> bool {
        lock::file(&self.path).exists()
    }

    /// Whether the folder holds a run.
    pub fn has_run(&self) -> bool {
        self.checkpoint().exists()
    }

    /// A file in the folder, other than a checkpoint, that a run would overwrite.
    pub fn foreign(&self) -> Option<&'static str> {
        [CONFIG, HISTORY, LOSS_CURVE, REPORT].into_iter().find(|name| self.path.join(name).exists())
    }

    /// Creates the folder and locks it against other runs.
    pub fn lock(&self) -> Result<Lock, RunError> {
        Lock::new(&self.path).map_err(|error| self.failed(error))
    }

    /// The error for a failed operation on the folder.
    pub fn failed(&self, error: io::Error) -> RunError {
        RunError::Folder { folder: self.path.clone(), error }
    }

    /// Removes picture and page of an earlier run, since they do not describe this run.
    pub fn remove_pictures(&self) -> io::Result<()> {
        [self.loss_curve(), self.report()].iter().try_for_each(|file| match fs::remove_file(file) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
            _ => Ok(()),
        })
    }

    /// Writes the configuration with full paths, so that it can be used from the folder; a file that already holds an
    /// equal configuration is left unchanged.
    pub fn write_config(&self, config: &Config) -> io::Result<()> {
        let mut config = config.clone();
        config.model.files().into_iter().for_each(|file| *file = full(file));
        config.data.file = config.data.file.map(full);
        let path = self.path.join(CONFIG);
        if Config::read(&path).is_ok_and(|there| there == config) {
            return Ok(());
        }
        crate::atomic::write(&path, config.to_toml().as_bytes())
    }

    /// Plots the losses over iterations.
    pub fn draw(&self, rows: &[Row]) -> Result<(), PlotError> {
        let curve = |stage: &str, loss: fn(&Row) -> Option<f64>| -> Vec<(f64, f64)> {
            let of_stage = rows.iter().filter(|row| row.stage == stage);
            of_stage.filter_map(|row| Some((row.iteration as f64, loss(row)?))).collect()
        };
        let mut stages: Vec<&str> = rows.iter().map(|row| row.stage.as_str()).collect();
        stages.dedup();
        let mut curves = Vec::new();
        for stage in stages {
            curves.push((format!("{stage}: training loss"), curve(stage, |row| Some(row.train))));
            curves.push((format!("{stage}: validation loss"), curve(stage, |row| row.validation)));
        }
        let curves: Vec<(&str, &[(f64, f64)])> = curves
            .iter()
            .filter(|(_, c)| !c.is_empty())
            .map(|(label, c)| (label.as_str(), c.as_slice()))
            .collect();
        plot::loss_curve(&self.loss_curve(), "Loss", &curves)
    }
}

/// The full path of a file, or of a file name pattern.
fn full(path: &Path) -> PathBuf {
    fs::canonicalize(path).or_else(|_| std::path::absolute(path)).unwrap_or_else(|_| path.to_owned())
}

/// The history and its file. Rows that could not be written are kept and written with the next row.
pub(super) struct History {
    /// File to append to; `None` until the history is written for the first time.
    file: Option<File>,
    /// Length of the complete rows in the file, bytes.
    length: u64,
    pending: String,
    /// All rows.
    pub rows: Vec<Row>,
}

impl History {
    /// An empty history without a file.
    pub fn new() -> Self {
        Self { file: None, length: 0, pending: String::new(), rows: Vec::new() }
    }

    /// The history in a folder, up to iteration `until`.
    pub fn open(folder: &Folder, until: u64) -> io::Result<Self> {
        let mut rows = read_rows(&folder.path.join(HISTORY))?;
        rows.retain(|row| row.iteration <= until);
        let mut history = Self { rows, ..Self::new() };
        history.write(folder)?;
        Ok(history)
    }

    /// Writes all rows to a new file; later rows are appended to it.
    pub fn write(&mut self, folder: &Folder) -> io::Result<()> {
        let path = folder.path.join(HISTORY);
        let text: String = std::iter::once(HEAD.to_owned()).chain(self.rows.iter().map(line)).collect();
        crate::atomic::write(&path, text.as_bytes())?;
        self.file = Some(OpenOptions::new().append(true).open(&path)?);
        self.length = text.len() as u64;
        self.pending.clear();
        Ok(())
    }

    /// Appends a row. On error the row stays pending, and no partial row stays in the file.
    pub fn push(&mut self, row: Row) -> io::Result<()> {
        self.pending.push_str(&line(&row));
        self.rows.push(row);
        self.flush()
    }

    fn flush(&mut self) -> io::Result<()> {
        let Some(file) = &mut self.file else { return Ok(()) };
        if let Err(error) = file.write_all(self.pending.as_bytes()) {
            file.set_len(self.length)?;
            return Err(error);
        }
        self.length += self.pending.len() as u64;
        self.pending.clear();
        Ok(())
    }
}

fn line(row: &Row) -> String {
    let Row { iteration, stage, seconds, train, validation } = row;
    let validation = validation.map_or(String::new(), |loss| format!("{loss:e}"));
    format!("{iteration},{stage},{seconds:.3},{train:e},{validation}\n")
}

/// The rows of a history file, none if there is no file; lines that are not rows are skipped.
fn read_rows(path: &Path) -> io::Result<Vec<Row>> {
    match fs::read_to_string(path) {
        Ok(text) => Ok(text.lines().skip(1).filter_map(parse).collect()),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
        Err(error) => Err(error),
    }
}

fn parse(line: &str) -> Option<Row> {
    let cells: Vec<&str> = line.split(',').collect();
    let [iteration, stage, seconds, train, validation] = cells.try_into().ok()?;
    Some(Row {
        iteration: iteration.parse().ok()?,
        stage: stage.to_owned(),
        seconds: seconds.parse().ok()?,
        train: train.parse().ok()?,
        validation: validation.parse().ok(),
    })
}
