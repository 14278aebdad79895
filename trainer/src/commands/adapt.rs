//! `leastaction adapt`.

use clap::Args;
use leastaction::adaptation::Adaptation;
use leastaction::cli::arguments::positive;
use leastaction::cli::{Done, Failure, FileKind, Output, replaceable};
use leastaction::evaluation::{LogReading, is_page};
use leastaction::models::of_file_or_run;
use leastaction_adaptation::Request;
use std::path::{Path, PathBuf};

/// Let numbers of a model follow the machine along a log: what it carries, and how its friction changes.
///
/// The filter is the controller's, in its arithmetic: over windows of the momentum balance it estimates the ten inertial numbers of a body,
/// to which something may be attached, and the friction of every coordinate, with standard errors. It says what is attached as soon as that is
/// sure, at a stated rate of false alarms.
///
/// How uncertain the model is in itself is measured on the log that it learned from: that of --config, or of the run. Without either, it is
/// taken from the log itself, after the numbers have followed it.
///
/// Example: leastaction adapt run --data loaded.csv
///
/// Example: leastaction adapt arm.postcard --data loaded.csv --config arm.toml -o page.html
#[derive(Args)]
#[command(group = clap::ArgGroup::new("for_controller").multiple(true))]
pub struct Adapt {
    /// The model file, or the folder of a training run.
    model: PathBuf,
    /// The log.
    #[arg(long, value_name = "FILE")]
    data: PathBuf,
    /// The configuration that the model was trained by: its [data] says how logs are read, and names the log on which the model is right.
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// Body to which something may be attached, counted from 0 [default: the last one].
    #[arg(long, value_name = "BODY")]
    body: Option<usize>,
    /// Standard deviation of what may be attached, kg [default: a quarter of the mechanism].
    #[arg(long, value_name = "KG", value_parser = positive)]
    mass: Option<f64>,
    /// Friction stays what it is.
    #[arg(long)]
    no_friction: bool,
    /// Networks follow, too: the last layer of the potential's network, and the strength of the network's dissipation.
    #[arg(long)]
    networks: bool,
    /// Length of a window, s [default: .2, and at least 40 samples].
    #[arg(long, value_name = "S", value_parser = positive)]
    window: Option<f64>,
    /// Time that is remembered, s.
    #[arg(long, value_name = "S", value_parser = positive, default_value_t = 20.0)]
    memory: f64,
    /// False alarms in an hour.
    #[arg(long, value_name = "RATE", value_parser = positive, default_value_t = 1e-3)]
    false_alarms: f64,
    /// A page, .html: the numbers over time with their standard errors, and how well they explain the log.
    #[arg(short, long, value_name = "PAGE.html")]
    output: Option<PathBuf>,
    /// A patch with the numbers in use at the end of the log, a few bytes for a controller, `inspect --patch` and `convert --patch`.
    #[arg(long, value_name = "FILE")]
    patch: Option<PathBuf>,
    /// The settings of the adapter as a file that a controller reads, in Rust or C or behind `simulate --on`.
    #[arg(long, value_name = "FILE", requires = "tick", group = "for_controller")]
    settings: Option<PathBuf>,
    /// The settings of the adapter as a Rust module, for a controller.
    #[arg(long, value_name = "FILE.rs", requires = "tick", group = "for_controller")]
    rust: Option<PathBuf>,
    /// Tick of the controller, s.
    #[arg(long, value_name = "S", value_parser = positive, requires = "for_controller")]
    tick: Option<f64>,
}

impl Adapt {
    /// Reads the model and the logs, and lets the numbers follow.
    pub fn run(self, output: Output) -> Done {
        let page = self.page()?;
        self.patch.iter().try_for_each(|file| replaceable(file, FileKind::Patch))?;
        self.rust.iter().try_for_each(|file| replaceable(file, FileKind::SettingsSource))?;
        self.settings.iter().try_for_each(|file| replaceable(file, FileKind::Settings))?;
        let model = of_file_or_run(&self.model, None)?;
        let reading = LogReading::new(self.config.as_deref(), Some(self.data.clone().into()), &self.model)?;
        let adaptation = Adaptation {
            file: &self.model,
            model: &model,
            config: self.config.as_deref(),
            request: self.request(),
        };
        let tell = &mut |sentence: String| output.note(&format!("note: {sentence}"));
        let adapted = adaptation.along(&reading, tell)?;
        if let Some(path) = page {
            adapted.write_page(path)?;
            output.note(&format!("page in {}", path.display()));
        }
        if let Some(file) = &self.patch {
            adapted.write_patch(file)?;
            output.note(&format!("patch in {}", file.display()));
        }
        if let (Some(file), Some(tick)) = (&self.rust, self.tick) {
            adapted.write_source(file, tick)?;
            output.note(&format!("settings for a controller in {}", file.display()));
        }
        if let (Some(file), Some(tick)) = (&self.settings, self.tick) {
            adapted.write_settings(file, tick)?;
            output.note(&format!("settings for a controller in {}", file.display()));
        }
        output.report(&adapted.report)
    }

    fn page(&self) -> Result<Option<&Path>, Failure> {
        let Some(path) = self.output.as_deref() else { return Ok(None) };
        if is_page(path)? { Ok(Some(path)) } else { Err(Failure::input(path, "name a page, as page.html")) }
    }

    fn request(&self) -> Request {
        let Self { body, mass, networks, window, memory, false_alarms, .. } = *self;
        Request { body, mass, networks, window, memory, false_alarms, friction: !self.no_friction }
    }
}
