//! `leastaction generate … --robot`: logs as robots write them.

use crate::commands::system::System;
use clap::Args;
use leastaction::cli::arguments::{finite, not_negative, positive};
use leastaction::cli::{Failure, FileKind, folder, replaceable, written};
use leastaction_ground_truth::Mechanism;
use leastaction_ground_truth::robot::{
    CSV_HEAD, Drives, Excitation, JointFriction, Linkage, MOST_JOINTS, Machine, RobotError, RobotLogs,
    RobotSettings, Sensors, StartSpread, robot_logs, write_csv,
};
use leastaction_learning::data;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Options for logs as a robot writes them. Lists have one value per coordinate, or one for all.
#[derive(Args)]
#[command(next_help_heading = "Logs as a robot writes them (pendulum, cartpole, acrobot, n-pendulum)")]
#[group(skip)]
#[command(group = clap::ArgGroup::new("robot_output").multiple(true))]
pub struct RobotOptions {
    /// Folder for logs as a robot writes them, 00.csv, 01.csv, …: time, pos_meas1 …, vel_meas1 …, tau_con1 …, tau_meas1 …
    #[arg(long, value_name = "DIR", group = "robot_output")]
    pub robot: Option<PathBuf>,
    /// File for the true motion (q, v, a, and u as commanded), .npz or .csv.
    #[arg(long, value_name = "FILE", group = "robot_output")]
    pub truth: Option<PathBuf>,
    /// The links of n-pendulum: a TOML file with `gravity`, and a [[joint]] for every link with mass, length, centre, inertia (about the
    /// centre), rotor and gear. Coordinates are joint angles, 0 hanging.
    #[arg(long, requires = "robot_output", value_name = "FILE")]
    links: Option<PathBuf>,
    /// Viscous friction b, N m s/rad or N s/m.
    #[arg(long, requires = "robot_output", value_name = "B,…", value_delimiter = ',', default_values_t = [0.0], allow_negative_numbers = true, value_parser = not_negative)]
    viscous: Vec<f64>,
    /// Coulomb friction c of −c tanh(v/ε), N m or N.
    #[arg(long, requires = "robot_output", value_name = "C,…", value_delimiter = ',', default_values_t = [0.0], allow_negative_numbers = true, value_parser = not_negative)]
    coulomb: Vec<f64>,
    /// Width ε of Coulomb friction, rad/s or m/s.
    #[arg(long, requires = "robot_output", value_name = "E,…", value_delimiter = ',', default_values_t = [0.2], allow_negative_numbers = true, value_parser = positive)]
    width: Vec<f64>,
    /// Encoder count, rad or m.
    #[arg(long, requires = "robot_output", value_name = "COUNT", default_value_t = 0.0, allow_negative_numbers = true, value_parser = not_negative)]
    grid: f64,
    /// Standard deviation of the encoders' zero offsets, drawn anew for every log, rad or m.
    #[arg(long, requires = "robot_output", value_name = "SD", default_value_t = 0.0, allow_negative_numbers = true, value_parser = not_negative)]
    zeros: f64,
    /// Largest deviation of sampling times, and stamps, from their due times, ms.
    #[arg(long, requires = "robot_output", value_name = "MS", default_value_t = 0.0, allow_negative_numbers = true, value_parser = not_negative)]
    jitter: f64,
    /// Delay from a command to its effect, ms.
    #[arg(long, requires = "robot_output", value_name = "MS", default_value_t = 0.0, allow_negative_numbers = true, value_parser = not_negative)]
    delay: f64,
    /// Standard deviation of the torque about the commanded one, drawn anew for every sample, N m or N.
    #[arg(long, requires = "robot_output", value_name = "SD", default_value_t = 0.0, allow_negative_numbers = true, value_parser = not_negative)]
    torque_noise: f64,
    /// Gain: ratio of actual to commanded torque.
    #[arg(long, requires = "robot_output", value_name = "G,…", value_delimiter = ',', default_values_t = [1.0], allow_negative_numbers = true, value_parser = finite)]
    gain: Vec<f64>,
    /// Whether each coordinate has a drive, 0 or 1 [default: all; only the cart of cartpole].
    #[arg(long, requires = "robot_output", value_name = "0|1,…", value_delimiter = ',', value_parser = clap::value_parser!(u8).range(0..=1))]
    driven: Vec<u8>,
    /// Number of sines in the command of a drive.
    #[arg(long, requires = "robot_output", value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u8).range(0..=100))]
    sines: u8,
    /// Least and greatest frequency of the sines, Hz.
    #[arg(long, requires = "robot_output", value_name = "LEAST,GREATEST", value_delimiter = ',', num_args = 1, default_values_t = [0.3, 2.5], allow_negative_numbers = true, value_parser = not_negative)]
    frequency: Vec<f64>,
    /// Least and greatest amplitude of the sines, N m or N.
    #[arg(long, requires = "robot_output", value_name = "LEAST,GREATEST", value_delimiter = ',', num_args = 1, default_values_t = [0.1, 0.35], allow_negative_numbers = true, value_parser = not_negative)]
    amplitude: Vec<f64>,
    /// Largest distance of starts from the hanging position, ±, rad or m.
    #[arg(long, requires = "robot_output", value_name = "Q", default_value_t = 0.0, allow_negative_numbers = true, value_parser = not_negative)]
    spread: f64,
}

/// Values of the command's common options.
pub struct Common<'a> {
    pub system: System,
    pub count: Option<u32>,
    pub logs: Option<u32>,
    pub samples: Option<u32>,
    pub h: Option<f64>,
    pub speed: Option<f64>,
    pub noise: f64,
    pub seed: u64,
    pub output: Option<&'a Path>,
}

/// Facts about the logs that are not in the logs.
#[derive(Serialize)]
pub struct Hidden {
    /// Zero offsets of the encoders, log by log.
    zeros: Vec<Vec<f64>>,
}

/// Number of logs, samples in each, and time between samples, s.
pub type LogSize = (usize, usize, f64);

/// Largest number of coordinates of a robot.
pub const MOST_COORDINATES: usize = MOST_JOINTS;

/// Default number of logs, samples in each, and step.
const DEFAULT: LogSize = (10, 201, 0.01);

impl RobotOptions {
    /// Whether logs as a robot writes them are requested.
    pub fn given(&self) -> bool {
        self.robot.is_some() || self.truth.is_some()
    }

    /// Generates the logs and writes them.
    pub fn run(&self, common: &Common) -> Result<(LogSize, Hidden), Failure> {
        let size = common.size();
        if self.jitter > 0.0 && (self.truth.is_some() || common.output.is_some()) {
            let reason = "a log of even steps has no --jitter: leave out -o and --truth, or --jitter";
            return Err(Failure::Input(reason.to_owned()));
        }
        let files = self.files(size.0, common.output)?;
        let logs = robot_logs(&self.settings(common, size)?).map_err(refused)?;
        self.write(&logs, &files, common.output)?;
        let zeros = logs.logs.iter().map(|log| log.zeros.clone()).collect();
        Ok((size, Hidden { zeros }))
    }

    /// The files in the folder; refuses to replace files of another kind.
    fn files(&self, logs: usize, output: Option<&Path>) -> Result<Vec<PathBuf>, Failure> {
        let logs_of_motion = output.into_iter().chain(self.truth.as_deref());
        logs_of_motion.into_iter().try_for_each(|file| replaceable(file, FileKind::Log))?;
        let Some(dir) = &self.robot else { return Ok(Vec::new()) };
        folder(dir)?;
        let digits = (logs - 1).to_string().len().max(2);
        let files: Vec<PathBuf> = (0..logs).map(|id| dir.join(format!("{id:0digits$}.csv"))).collect();
        files.iter().try_for_each(|file| replaceable(file, FileKind::Table(CSV_HEAD)))?;
        let others = std::fs::read_dir(dir).map_err(|error| Failure::file(dir, error))?;
        let paths = others.filter_map(|entry| Some(entry.ok()?.path()));
        let mut other_logs =
            paths.filter(|path| path.extension().is_some_and(|extension| extension == "csv"));
        match other_logs.find(|path| !files.contains(path)) {
            Some(path) => {
                Err(Failure::input(&path, "the folder holds other logs; name another, or remove them"))
            }
            None => Ok(files),
        }
    }

    fn write(&self, logs: &RobotLogs, files: &[PathBuf], output: Option<&Path>) -> Result<(), Failure> {
        for (file, log) in files.iter().zip(&logs.logs) {
            write_csv(file, log).map_err(|error| Failure::file(file, error))?;
        }
        output.map_or(Ok(()), |file| data::write(file, &logs.measured())).map_err(written)?;
        self.truth.as_ref().map_or(Ok(()), |file| data::write(file, &logs.truth())).map_err(written)
    }

    fn settings(&self, common: &Common, (logs, samples, h): LogSize) -> Result<RobotSettings, Failure> {
        let machine = self.machine(common)?;
        let n = machine.coordinates();
        let [viscous, coulomb, width] =
            [("--viscous", &self.viscous), ("--coulomb", &self.coulomb), ("--width", &self.width)]
                .map(|(option, list)| for_all(option, list, n));
        let (viscous, coulomb, width) = (viscous?, coulomb?, width?);
        let joint = |i: usize| JointFriction { viscous: viscous[i], coulomb: coulomb[i], width: width[i] };
        let driven = match self.driven.as_slice() {
            [] => machine.driven(),
            some => for_all("--driven", some, n)?.into_iter().map(|driven| driven == 1).collect(),
        };
        Ok(RobotSettings {
            friction: (0..n).map(joint).collect(),
            sensors: Sensors {
                noise: common.noise,
                grid: self.grid,
                zeros: self.zeros,
                jitter: self.jitter * 1e-3,
            },
            drives: Drives {
                gain: for_all("--gain", &self.gain, n)?,
                delay: self.delay * 1e-3,
                noise: self.torque_noise,
                driven,
            },
            excitation: Excitation {
                sines: self.sines.into(),
                frequency: both("--frequency", &self.frequency)?,
                amplitude: both("--amplitude", &self.amplitude)?,
            },
            start: StartSpread { q: self.spread, v: common.speed.unwrap_or(0.0) },
            seed: common.seed,
            machine,
            logs,
            samples,
            h,
        })
    }

    fn machine(&self, common: &Common) -> Result<Machine, Failure> {
        let named = match common.system {
            System::Pendulum => Mechanism::Pendulum,
            System::Cartpole => Mechanism::Cartpole,
            System::Acrobot => Mechanism::Acrobot,
            System::NPendulum => return self.linkage(common).map(Machine::Linkage),
            _ => {
                let reason = "--robot knows the pendulum, the cart-pole, the acrobot and n-pendulum";
                return Err(Failure::Input(reason.to_owned()));
            }
        };
        let foreign = [(common.count.is_some(), "--count"), (self.links.is_some(), "--links")];
        leastaction::cli::refuse(named.name(), &foreign)?;
        Ok(Machine::Named(named))
    }

    fn linkage(&self, common: &Common) -> Result<Linkage, Failure> {
        let Some(file) = &self.links else {
            return Ok(Linkage::points(common.count.map_or(2, |count| count as usize)));
        };
        leastaction::cli::refuse("--links", &[(common.count.is_some(), "--count")])?;
        let text = std::fs::read_to_string(file).map_err(|error| Failure::input(file, error))?;
        Linkage::from_toml(&text).map_err(|error| Failure::input(file, error))
    }
}

impl Common<'_> {
    /// Number of logs, samples in each, and step.
    pub fn size(&self) -> LogSize {
        let (logs, samples, h) = DEFAULT;
        let or = |given: Option<u32>, default| given.map_or(default, |count| count as usize);
        (or(self.logs, logs), or(self.samples, samples), self.h.unwrap_or(h))
    }
}

/// Expands a list to one value per coordinate.
fn for_all<T: Copy>(option: &str, list: &[T], n: usize) -> Result<Vec<T>, Failure> {
    match list {
        [one] => Ok(vec![*one; n]),
        some if some.len() == n => Ok(some.to_vec()),
        some => {
            let found = some.len();
            Err(Failure::Input(format!(
                "{option} has {found} values; give one, or {n}, one for each coordinate"
            )))
        }
    }
}

fn both(option: &str, list: &[f64]) -> Result<[f64; 2], Failure> {
    match list {
        [one] => Ok([*one; 2]),
        [least, greatest] => Ok([*least, *greatest]),
        _ => Err(Failure::Input(format!("{option} takes the least and the greatest, LEAST,GREATEST"))),
    }
}

fn refused(error: RobotError) -> Failure {
    match error {
        RobotError::Diverged { .. } => Failure::Work(error.to_string()),
        _ => Failure::Input(error.to_string()),
    }
}
