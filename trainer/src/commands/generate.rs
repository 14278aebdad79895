//! `leastaction generate`.

use super::Done;
use super::arguments::{not_negative, positive, seed};
use super::output::{Failure, Output, written};
use clap::Args;
use leastaction::data::{self, MIN_SAMPLES, symo};
use leastaction::ground_truth::{Mechanism, Settings, generate, symo_set};
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;

/// Simulate a mechanism exactly and log its motion.
///
/// Trajectories begin at random states (SyMo's distributions), each under a constant random force of at most 2 N (or N m) on
/// the actuated coordinate. The log has q, v, a, u and t.
///
/// Example: leastaction generate cartpole -o cartpole.npz --trajectories 32
#[derive(Args)]
pub struct Generate {
    /// The mechanism.
    system: Mechanism,
    /// The log to write, .npz or .csv.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// How many trajectories.
    #[arg(long, default_value_t = 32, value_parser = clap::value_parser!(u32).range(1..))]
    trajectories: u32,
    /// States in each.
    #[arg(long, default_value_t = 34, value_parser = clap::value_parser!(u32).range(MIN_SAMPLES as i64..))]
    samples: u32,
    /// Time between states, s [default: 0.1 for the pendulum, else 0.05].
    #[arg(long, value_parser = positive, allow_negative_numbers = true)]
    h: Option<f64>,
    /// Standard deviation of the noise on positions and velocities, m or rad (m/s or rad/s).
    #[arg(long, default_value_t = 0.0, value_parser = not_negative, allow_negative_numbers = true)]
    noise: f64,
    /// Viscous damping of every coordinate, N s/m or N m s/rad.
    #[arg(long, default_value_t = 0.0, value_parser = not_negative, allow_negative_numbers = true)]
    drag: f64,
    /// Of the random numbers.
    #[arg(long, default_value_t = 0, value_parser = seed, allow_negative_numbers = true)]
    seed: u64,
    /// No force at all (such a log does not show the scale of the energies).
    #[arg(long)]
    no_control: bool,
    /// SyMo's whole data set in SyMo's layout: 128 training and 128 test trajectories of 34 states, 16 free ones of 502.
    #[arg(long, conflicts_with_all = ["trajectories", "samples", "h", "noise", "drag", "no_control"])]
    symo_layout: bool,
}

/// What was written.
#[derive(Serialize)]
struct Report {
    system: &'static str,
    file: PathBuf,
    trajectories: usize,
    samples: usize,
    h: f64,
    seed: u64,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { system, file, trajectories, samples, h, seed } = self;
        let file = file.display();
        writeln!(
            f,
            "{file}: {system}, {trajectories} trajectories, {samples} samples, step {h} s, seed {seed}"
        )
    }
}

impl Generate {
    /// Generates and writes.
    pub fn run(self, output: Output) -> Done {
        let (trajectories, samples, h) =
            if self.symo_layout { self.write_symo()? } else { self.write_log()? };
        let system = self.system.name();
        output.report(&Report { system, file: self.output, trajectories, samples, h, seed: self.seed })
    }

    fn write_log(&self) -> Result<(usize, usize, f64), Failure> {
        let settings = Settings {
            mechanism: self.system,
            trajectories: self.trajectories as usize,
            samples: self.samples as usize,
            h: self.h.unwrap_or(self.system.step()),
            noise: self.noise,
            drag: self.drag,
            control: !self.no_control,
            seed: self.seed,
        };
        let data = generate(&settings).map_err(|error| Failure::Work(error.to_string()))?;
        data::write(&self.output, &data).map_err(written)?;
        Ok((data.trajectories.len(), data.samples(), data.h))
    }

    fn write_symo(&self) -> Result<(usize, usize, f64), Failure> {
        let set = symo_set(self.system, self.seed).map_err(|error| Failure::Work(error.to_string()))?;
        symo::write(&self.output, &set, self.system.actuated()).map_err(written)?;
        let parts = [&set.train, &set.test, &set.integration];
        let trajectories = parts.iter().map(|part| part.trajectories.len()).sum();
        Ok((trajectories, parts.iter().map(|part| part.samples()).sum(), set.train.h))
    }
}
