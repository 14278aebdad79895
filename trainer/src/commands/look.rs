//! `leastaction look`.

use clap::Args;
use leastaction::cli::{Done, Failure, FileKind, Output, replaceable};
use leastaction::look;
use leastaction_learning::atomic;
use std::path::PathBuf;

/// Survey unknown logs: clocks, ranges, encoder grids, noise, and a guess of what the columns are.
///
/// With -o it writes a first configuration with columns guessed from their names: check it, then train with it.
///
/// Example: leastaction look "logs/*.csv" -o robot.toml
#[derive(Args)]
pub struct Look {
    /// Logs of one machine, .csv, .npz, .mat, .mcap, .db3, or the folder of a bag or of a data set of LeRobot; *, ? and ** match several files.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// A first configuration to write.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// The robot's description, URDF or MJCF, for the configuration.
    #[arg(long, value_name = "FILE", requires = "output")]
    urdf: Option<PathBuf>,
    /// Sampling rate of logs without time, Hz.
    #[arg(long, value_name = "HZ", value_parser = rate)]
    rate: Option<f64>,
}

fn rate(text: &str) -> Result<f64, String> {
    let rate = text.parse().ok().filter(|rate: &f64| *rate > 0.0 && rate.is_finite());
    rate.ok_or_else(|| format!("{text:?} is no rate; give a number of Hz above 0"))
}

impl Look {
    /// Reads the logs and reports.
    pub fn run(self, output: Output) -> Done {
        if let Some(file) = &self.output {
            replaceable(file, FileKind::Configuration)?;
        }
        let seen = look::Look::at(&self.files)?.at_rate(self.rate).described(self.urdf);
        let report = seen.report();
        report.doubts().iter().for_each(|doubt| output.note(&format!("note: {doubt}")));
        let mut is_refused = false;
        if let Some(file) = &self.output {
            let refused = |reason| {
                Failure::Input(format!(
                    "no configuration is written: {reason}. Without -o, look lists all columns"
                ))
            };
            let proposal = seen.configuration(file).map_err(refused)?;
            proposal.note.iter().for_each(|note| output.note(&format!("note: {note}")));
            is_refused = proposal.is_refused;
            atomic::write(file, proposal.text.as_bytes()).map_err(|error| Failure::file(file, error))?;
        }
        let written = self.output.clone();
        output.report(&look::Report { configuration: self.output, ..report })?;
        written
            .iter()
            .filter(|_| !is_refused)
            .for_each(|file| output.next(&format!("train {} -o run", file.display())));
        Ok(())
    }
}
