//! The folder of a run: checkpoint, configuration, history and loss curve.

use super::state::Row;
use crate::config::{Config, ModelConfig};
use crate::plot::{self, PlotError};
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// The checkpoint.
pub(super) const CHECKPOINT: &str = "checkpoint.postcard";
/// One line an iteration.
const HISTORY: &str = "history.csv";
/// The configuration as it was read, every key written out.
const CONFIG: &str = "config.toml";
/// The history as a picture.
const LOSS_CURVE: &str = "loss.svg";

const HEAD: &str = "iteration,stage,seconds,train,validation\n";

/// Where the files of a run lie.
#[derive(Clone, Debug)]
pub(super) struct Folder {
    pub path: PathBuf,
}

impl Folder {
    pub fn checkpoint(&self) -> PathBuf {
        self.path.join(CHECKPOINT)
    }

    pub fn loss_curve(&self) -> PathBuf {
        self.path.join(LOSS_CURVE)
    }

    /// Whether there is something in it.
    pub fn is_used(&self) -> bool {
        match fs::read_dir(&self.path) {
            Ok(mut entries) => entries.next().is_some(),
            // A file of that name, or a folder that may not be read.
            Err(_) => self.path.symlink_metadata().is_ok(),
        }
    }

    /// Makes the folder and removes the files of an earlier run.
    pub fn clear(&self) -> io::Result<()> {
        fs::create_dir_all(&self.path)?;
        for name in [CHECKPOINT, HISTORY, CONFIG, LOSS_CURVE] {
            match fs::remove_file(self.path.join(name)) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
                _ => {}
            }
        }
        Ok(())
    }

    /// Writes the configuration with full paths, so that it can be used from here.
    pub fn write_config(&self, config: &Config) -> io::Result<()> {
        let mut config = config.clone();
        let model = match &mut config.model {
            ModelConfig::Modular(modular) => modular.from.as_mut(),
            ModelConfig::Rigid(_) | ModelConfig::Graph(_) => None,
        };
        for file in std::iter::once(&mut config.data.file).chain(model) {
            *file = fs::canonicalize(&*file).unwrap_or_else(|_| file.clone());
        }
        crate::atomic::write(&self.path.join(CONFIG), config.to_toml().as_bytes())
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

/// The history on its way to the disk. Rows that could not be written are kept and written with the next.
pub(super) struct History {
    file: File,
    /// Bytes of whole rows.
    length: u64,
    pending: String,
    /// All of them.
    pub rows: Vec<Row>,
}

impl History {
    /// A new file, or the old one up to an iteration.
    pub fn open(folder: &Folder, until: u64) -> io::Result<Self> {
        let path = folder.path.join(HISTORY);
        let mut rows = read_rows(&path)?;
        rows.retain(|row| row.iteration <= until);
        let text: String = std::iter::once(HEAD.to_owned()).chain(rows.iter().map(line)).collect();
        crate::atomic::write(&path, text.as_bytes())?;
        let file = OpenOptions::new().append(true).open(&path)?;
        Ok(Self { file, length: text.len() as u64, pending: String::new(), rows })
    }

    /// Appends a row; on error it stays pending, and no half row stays in the file.
    pub fn push(&mut self, row: Row) -> io::Result<()> {
        self.pending.push_str(&line(&row));
        self.rows.push(row);
        self.flush()
    }

    fn flush(&mut self) -> io::Result<()> {
        if let Err(error) = self.file.write_all(self.pending.as_bytes()) {
            self.file.set_len(self.length)?;
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
