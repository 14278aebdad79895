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

/// One line an iteration.
const HISTORY: &str = "history.csv";
/// The configuration as it was read, every key written out.
const CONFIG: &str = "config.toml";
/// The history as a picture.
const LOSS_CURVE: &str = "loss.svg";
/// What a run over windows is worth.
const REPORT: &str = "report.html";

const HEAD: &str = "iteration,stage,seconds,train,validation\n";

/// Where the files of a run lie.
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

    /// Whether there is something in it beside a lock.
    pub fn is_used(&self) -> bool {
        match fs::read_dir(&self.path) {
            Ok(entries) => entries.flatten().any(|entry| entry.file_name() != lock::FILE),
            // A file of that name, or a folder that may not be read.
            Err(_) => self.path.symlink_metadata().is_ok(),
        }
    }

    /// Whether a run was in it, or is.
    pub fn has_lock(&self) -> bool {
        lock::file(&self.path).exists()
    }

    /// Whether there is a run.
    pub fn has_run(&self) -> bool {
        self.checkpoint().exists()
    }

    /// A file in it that a run would overwrite beside a checkpoint.
    pub fn foreign(&self) -> Option<&'static str> {
        [CONFIG, HISTORY, LOSS_CURVE, REPORT].into_iter().find(|name| self.path.join(name).exists())
    }

    /// Makes it and keeps other runs out of it.
    pub fn lock(&self) -> Result<Lock, RunError> {
        Lock::new(&self.path).map_err(|error| self.failed(error))
    }

    /// What the operating system said of it.
    pub fn failed(&self, error: io::Error) -> RunError {
        RunError::Folder { folder: self.path.clone(), error }
    }

    /// Removes picture and page of an earlier run, which are not true of this one.
    pub fn remove_pictures(&self) -> io::Result<()> {
        [self.loss_curve(), self.report()].iter().try_for_each(|file| match fs::remove_file(file) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
            _ => Ok(()),
        })
    }

    /// Writes the configuration with full paths, so that it can be used from here; one that says the same stays as it is written.
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

    /// Draws losses over iterations.
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

/// The full path of a file, or of a pattern of names.
fn full(path: &Path) -> PathBuf {
    fs::canonicalize(path).or_else(|_| std::path::absolute(path)).unwrap_or_else(|_| path.to_owned())
}

/// The history on its way to the disk. Rows that could not be written are kept and written with the next.
pub(super) struct History {
    /// `None`: nothing is written yet.
    file: Option<File>,
    /// Bytes of whole rows.
    length: u64,
    pending: String,
    /// All of them.
    pub rows: Vec<Row>,
}

impl History {
    /// Of a run that has no rows yet, and no file.
    pub fn new() -> Self {
        Self { file: None, length: 0, pending: String::new(), rows: Vec::new() }
    }

    /// The history in a folder up to an iteration.
    pub fn open(folder: &Folder, until: u64) -> io::Result<Self> {
        let mut rows = read_rows(&folder.path.join(HISTORY))?;
        rows.retain(|row| row.iteration <= until);
        let mut history = Self { rows, ..Self::new() };
        history.write(folder)?;
        Ok(history)
    }

    /// Writes all rows to a new file, to which others are appended.
    pub fn write(&mut self, folder: &Folder) -> io::Result<()> {
        let path = folder.path.join(HISTORY);
        let text: String = std::iter::once(HEAD.to_owned()).chain(self.rows.iter().map(line)).collect();
        crate::atomic::write(&path, text.as_bytes())?;
        self.file = Some(OpenOptions::new().append(true).open(&path)?);
        self.length = text.len() as u64;
        self.pending.clear();
        Ok(())
    }

    /// Appends a row; on error it stays pending, and no half row stays in the file.
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

/// The rows of a history, none where there is no file; what is not a row is left out.
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
