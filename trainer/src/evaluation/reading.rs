//! How a log is read that is not the one that a run learned from.

use super::Tell;
use crate::cli::Failure;
use crate::notes::sentences;
use leastaction_core::forces::ControlKind;
use leastaction_learning::config::{Config, DataConfig, LogFiles};
use leastaction_learning::data::{DataError, Dataset, Note};
use std::path::{Path, PathBuf};

/// A log, and how it is read: by a configuration, or else as the logs of the run were, or else by leastaction's own names.
pub struct LogReading {
    config: DataConfig,
    /// The configuration in the folder of a run that `config` is taken from.
    of_run: Option<PathBuf>,
}

impl LogReading {
    /// The log `named`, read by the `[data]` of a configuration, or else the configuration's own log. Without a
    /// configuration the `model` says how, if it is the folder of a run.
    ///
    /// # Errors
    /// [`Failure::Input`] if neither is given, or if the configuration cannot be read.
    pub fn new(config: Option<&Path>, named: Option<LogFiles>, model: &Path) -> Result<Self, Failure> {
        let configured = config.map(Config::read).transpose()?.map(|config| config.data);
        match (configured, named) {
            (Some(configured), Some(file)) => Ok(Self::by(DataConfig { file, ..configured })),
            (Some(config), None) => Ok(Self::by(config)),
            (None, Some(file)) => Self::as_of_run(file, model),
            (None, None) => Err(Failure::Input("name the log with --data".to_owned())),
        }
    }

    /// The log that the `model` learned from: that of a configuration, or else of the run if `model` is its folder. `None` without either.
    ///
    /// # Errors
    /// [`Failure::Input`] if the configuration cannot be read.
    pub fn of_training(config: Option<&Path>, model: &Path) -> Result<Option<Self>, Failure> {
        let config = config.map(PathBuf::from).or_else(|| config_of_run(model));
        config.map(|config| Self::new(Some(&config), None, model)).transpose()
    }

    /// A log that has leastaction's own names.
    #[must_use]
    pub fn native(file: LogFiles) -> Self {
        Self::by(DataConfig::new(file))
    }

    fn by(config: DataConfig) -> Self {
        Self { config, of_run: None }
    }

    /// A log that is read as the logs of the run in this folder were. A model file says nothing about logs.
    fn as_of_run(file: LogFiles, model: &Path) -> Result<Self, Failure> {
        let Some(own) = config_of_run(model) else { return Ok(Self::native(file)) };
        let config = DataConfig { file, ..Config::read(&own)?.data };
        let is_plain = config.reading() == DataConfig::new(config.file.clone()).reading();
        Ok(Self { config, of_run: (!is_plain).then_some(own) })
    }

    /// Reads the log at this step, s, instead of its own, if there is one.
    #[must_use]
    pub fn at_step(mut self, step: Option<f64>) -> Self {
        self.config.step = step.or(self.config.step);
        self
    }

    /// The names of the files.
    #[must_use]
    pub fn file(&self) -> PathBuf {
        PathBuf::from(self.config.file.to_string())
    }

    /// Names of the coordinates in the configuration: columns, or the joints of topics.
    #[must_use]
    pub fn names(&self) -> Vec<String> {
        let columns = self.config.columns.iter().flat_map(|columns| &columns.columns.q);
        columns.map(|column| joint(&column.name).to_owned()).collect()
    }

    /// Reads the log; reports what the user should know about it. Behaviour of u between samples is as `asked`, else as
    /// configured, else as `trained`.
    ///
    /// # Errors
    /// [`Failure::Input`] if the log cannot be read.
    pub fn read(
        &self,
        (asked, trained): (Option<ControlKind>, Option<ControlKind>),
        tell: Tell,
    ) -> Result<Dataset, Failure> {
        let with = |config: &DataConfig| {
            let control = asked.or(config.control).or(trained);
            DataConfig { control, ..config.clone() }
        };
        let (data, notes) = match &self.of_run {
            None => with(&self.config).read().map_err(|error| Failure::Input(error.to_string()))?,
            Some(own) => self.as_run_or_native(own, with, tell)?,
        };
        sentences(&notes).into_iter().for_each(&mut *tell);
        Ok(data)
    }

    /// Reads a log as the logs of a run were, or by leastaction's own names if it has these and cannot be read otherwise.
    fn as_run_or_native(
        &self,
        own: &Path,
        with: impl Fn(&DataConfig) -> DataConfig,
        tell: Tell,
    ) -> Result<Read, Failure> {
        let (file, own) = (&self.config.file, own.display());
        let error = match with(&self.config).read() {
            Ok(read) => {
                tell(format!("{file} is read as the logs of the run were, by [data] of {own}"));
                return Ok(read);
            }
            Err(error) => error,
        };
        if let Ok(read) = with(&DataConfig::new(file.clone())).read() {
            tell(format!("{file} has the names of leastaction's own logs and is read by them, not by {own}"));
            return Ok(read);
        }
        Err(refused(&error, &own))
    }
}

/// A log, with notes for each file.
type Read = (Dataset, Vec<(PathBuf, Note)>);

/// The joint in `topic/joint/position`; any other name as it is.
fn joint(column: &str) -> &str {
    let mut parts = column.rsplitn(3, '/').skip(1);
    parts.next().filter(|_| column.starts_with('/') && parts.next().is_some()).unwrap_or(column)
}

fn refused(error: &DataError, own: &dyn std::fmt::Display) -> Failure {
    let remedy = "if this log is laid out otherwise, give a configuration with --config";
    Failure::Input(format!("{error} (read by [data] of {own}; {remedy})"))
}

/// The configuration in the folder of a run.
fn config_of_run(model: &Path) -> Option<PathBuf> {
    Some(model.join("config.toml")).filter(|config| config.is_file())
}
