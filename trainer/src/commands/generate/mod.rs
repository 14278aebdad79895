//! `leastaction generate`.

mod robot;

use robot::{Common, Hidden, RobotOptions};

use super::system::{Kind, System};
use clap::{Args, ValueEnum};
use leastaction::cli::arguments::{finite, not_negative, positive, seed};
use leastaction::cli::{Done, Failure, FileKind, Output, refuse, replaceable, written};
use leastaction_core::forces::ControlKind;
use leastaction_ground_truth::{
    Drive, GenerationError, LgnnSettings, LgnnSystem, ManyBody, Mechanism, ModlanetSettings, Settings,
    generate, generate_many, lgnn_set, modlanet_set_of, symo_set,
};
use leastaction_learning::data::{self, Dataset, MIN_SAMPLES, modlanet, symo};
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};

/// Simulate a mechanism exactly and log its motion.
///
/// Trajectories begin at random states. For pendulum, cartpole and acrobot (SyMo's distributions) a random force of at most 2 N (or N m)
/// acts on the actuated coordinate, constant or, with --control, changing at every sample, and the log has q, v, a, u and t. For n-pendulum
/// and n-body (ModLaNet's distributions; masses, lengths and k are 1) the motion is free, and the log has q, v, a and t. For rod-pendulum,
/// n-spring and hybrid (LGNN's; masses and lengths are 1) the coordinates are Cartesian, (x, y) of every node.
///
/// Example: leastaction generate cartpole -o cartpole.npz --trajectories 32
///
/// Example: leastaction generate n-body --count 3 -o bodies.npz --modlanet-layout
///
/// Example: leastaction generate n-spring --count 5 -o springs.npz
///
/// With --robot, logs are written as robots write them, one CSV file each, with column names of their own, friction in the joints, drives
/// with delay, encoders with quantisation, noise (--noise) and zero offsets, and jittering stamps; -o then writes the same readings as one
/// log, and --truth the true motion. Every drive follows a sum of sines, different in every log.
///
/// Example: leastaction generate acrobot --robot logs --truth truth.npz --coulomb 0.1,0.07 --noise 0.001 --delay 6
#[derive(Args)]
pub struct Generate {
    /// The mechanism.
    system: System,
    /// The log to write, .npz or .csv.
    #[arg(short, long, value_name = "FILE", required_unless_present = "robot_output")]
    output: Option<PathBuf>,
    /// Number of pendulums, bodies or nodes [default: 2 for n-pendulum, 3 for n-body and rod-pendulum, 5 for n-spring].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MOST_ELEMENTS))]
    count: Option<u32>,
    /// Number of trajectories; all samples together may have at most 2^27 numbers [default: 32; for n-pendulum 100 with 2 pendulums, for
    /// n-body 200 with 3 bodies, with other counts 20; 100 for LGNN's systems; 10 with --robot].
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    trajectories: Option<u32>,
    /// Number of states in each trajectory [default: 34; 101 for n-pendulum and n-body; 100 for LGNN's systems; 201 with --robot].
    #[arg(long, value_parser = clap::value_parser!(u32).range(MIN_SAMPLES as i64..))]
    samples: Option<u32>,
    /// Time between states, s [default: 0.1 for pendulum, n-pendulum and n-spring, 0.01 for systems with rods and with --robot, else 0.05].
    #[arg(long, value_parser = positive, allow_negative_numbers = true)]
    h: Option<f64>,
    /// Limit of the initial velocities, for n-pendulum and with --robot, rad/s [default: 10 for 2 pendulums, else 8; 0 with --robot].
    #[arg(long, value_parser = not_negative, allow_negative_numbers = true)]
    speed: Option<f64>,
    /// Standard deviation of the noise on positions and velocities, m or rad (m/s or rad/s).
    #[arg(long, default_value_t = 0.0, value_parser = not_negative, allow_negative_numbers = true)]
    noise: f64,
    /// Viscous damping of every coordinate, N s/m or N m s/rad.
    #[arg(long, default_value_t = 0.0, value_parser = not_negative, allow_negative_numbers = true)]
    drag: f64,
    /// Force along x on the second node of LGNN's systems, N; the log then has u.
    #[arg(long, default_value_t = 0.0, value_parser = finite, allow_negative_numbers = true)]
    pull: f64,
    /// Seed of the random numbers.
    #[arg(long, default_value_t = 0, value_parser = seed, allow_negative_numbers = true)]
    seed: u64,
    /// Behaviour of the random force on pendulum, cartpole or acrobot [default: constant].
    #[arg(long, value_name = "KIND", conflicts_with = "no_control")]
    control: Option<Control>,
    /// No force at all (such a log does not show the scale of the energies).
    #[arg(long)]
    no_control: bool,
    /// Write SyMo's whole data set in SyMo's layout: 128 training and 128 test trajectories of 34 states, 16 free ones of 502.
    #[arg(long, conflicts_with_all = ["trajectories", "samples", "h", "noise", "drag", "pull", "control", "no_control", "modlanet_layout"])]
    symo_layout: bool,
    /// Write a training and a test set (the last tenth of the trajectories) in ModLaNet's layout.
    #[arg(long)]
    modlanet_layout: bool,
    #[command(flatten)]
    robot: RobotOptions,
}

/// The random force on an actuated coordinate.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Control {
    /// One force for each trajectory.
    Constant,
    /// A new force at every sample, held until the next, as a controller does; the log says so.
    Held,
    /// A new force at every sample, linear in between; the log says so.
    Linear,
}

/// Largest number of elements in a system.
const MOST_ELEMENTS: i64 = 1000;

/// Largest count of numbers in a log; together they take 1 GiB, which is held in memory before it is written.
const MOST_NUMBERS: usize = 1 << 27;

/// Report on the written files.
#[derive(Serialize)]
struct Report {
    system: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<PathBuf>,
    #[serde(skip_serializing_if = "Option::is_none")]
    robot: Option<PathBuf>,
    #[serde(skip_serializing_if = "Option::is_none")]
    truth: Option<PathBuf>,
    trajectories: usize,
    samples: usize,
    h: f64,
    seed: u64,
    #[serde(skip_serializing_if = "Option::is_none", flatten)]
    hidden: Option<Hidden>,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { system, file, robot, truth, trajectories, samples, h, seed, .. } = self;
        let files: Vec<_> =
            [file, robot, truth].into_iter().flatten().map(|file| file.display().to_string()).collect();
        let files = files.join(", ");
        writeln!(
            f,
            "{files}: {system}, {trajectories} trajectories, {samples} samples, step {h} s, seed {seed}"
        )
    }
}

/// Number of trajectories, number of samples, step.
type Size = (usize, usize, f64);

impl Generate {
    /// Generates the motion and writes it.
    pub fn run(self, output: Output) -> Done {
        if self.robot.given() {
            return self.run_robot(output);
        }
        replaceable(self.file(), FileKind::Log)?;
        let (system, (trajectories, samples, h)) = match self.system.kind() {
            Kind::Symo(mechanism) => (mechanism.name(), self.symo(mechanism)?),
            Kind::Modlanet(system) => {
                let default = if self.system == System::NBody { 3 } else { 2 };
                let system = system(self.count.map_or(default, |count| count as usize));
                (system.name(), self.modlanet(system)?)
            }
            Kind::Lgnn(system) => {
                let default = if self.system == System::NSpring { 5 } else { 3 };
                let system = system(self.count.map_or(default, |count| count as usize));
                (system.name(), self.lgnn(system)?)
            }
        };
        let Self { output: file, seed, .. } = self;
        let (robot, truth, hidden) = (None, None, None);
        let written = file.clone();
        output.report(&Report { system, file, robot, truth, trajectories, samples, h, seed, hidden })?;
        written.iter().for_each(|file| output.next(&format!("look {} -o robot.toml", file.display())));
        Ok(())
    }

    /// The log to write; without --robot there is always one.
    fn file(&self) -> &Path {
        self.output.as_deref().unwrap_or(Path::new(""))
    }

    fn run_robot(self, output: Output) -> Done {
        let foreign = [
            (self.drag != 0.0, "--drag"),
            (self.pull != 0.0, "--pull"),
            (self.no_control, "--no-control"),
            (self.control.is_some(), "--control"),
            (self.symo_layout, "--symo-layout"),
            (self.modlanet_layout, "--modlanet-layout"),
        ];
        refuse("--robot", &foreign)?;
        let Self { system, count, trajectories, samples, h, speed, noise, seed, output: file, robot, .. } =
            self;
        let common = Common {
            system,
            count,
            logs: trajectories,
            samples,
            h,
            speed,
            noise,
            seed,
            output: file.as_deref(),
        };
        let (logs, samples, _) = common.size();
        // Every sample takes twice as many numbers as in a log: measured and true values.
        fits(logs, samples, 2 * robot::MOST_COORDINATES)?;
        let ((trajectories, each, h), hidden) = robot.run(&common)?;
        let (samples, hidden) = (trajectories * each, Some(hidden));
        let (system, robot, truth) = (system.name(), robot.robot, robot.truth);
        let written = file.clone();
        output.report(&Report { system, file, robot, truth, trajectories, samples, h, seed, hidden })?;
        written.iter().for_each(|file| output.next(&format!("look {} -o robot.toml", file.display())));
        Ok(())
    }

    fn symo(&self, mechanism: Mechanism) -> Result<Size, Failure> {
        let foreign = [
            (self.count.is_some(), "--count"),
            (self.speed.is_some(), "--speed"),
            (self.pull != 0.0, "--pull"),
            (self.modlanet_layout, "--modlanet-layout"),
        ];
        refuse(mechanism.name(), &foreign)?;
        if self.symo_layout { self.write_symo(mechanism) } else { self.write_log(mechanism) }
    }

    fn write_log(&self, mechanism: Mechanism) -> Result<Size, Failure> {
        let settings = Settings {
            mechanism,
            trajectories: self.trajectories.unwrap_or(32) as usize,
            samples: self.samples.unwrap_or(34) as usize,
            h: self.h.unwrap_or(mechanism.step()),
            noise: self.noise,
            drag: self.drag,
            drive: self.drive(),
            seed: self.seed,
        };
        fits(settings.trajectories, settings.samples, mechanism.coordinates().len())?;
        self.log(&generate(&settings).map_err(failed)?)
    }

    fn drive(&self) -> Drive {
        match self.control {
            _ if self.no_control => Drive::Free,
            None | Some(Control::Constant) => Drive::Constant,
            Some(Control::Held) => Drive::Changing(ControlKind::Held),
            Some(Control::Linear) => Drive::Changing(ControlKind::Linear),
        }
    }

    fn log(&self, data: &Dataset) -> Result<Size, Failure> {
        data::write(self.file(), data).map_err(written)?;
        Ok((data.trajectories.len(), data.samples(), data.h))
    }

    fn write_symo(&self, mechanism: Mechanism) -> Result<Size, Failure> {
        let set = symo_set(mechanism, self.seed, 0.0).map_err(failed)?;
        symo::write(self.file(), &set, mechanism.actuated()).map_err(written)?;
        let parts = [&set.train, &set.test, &set.integration];
        let trajectories = parts.iter().map(|part| part.trajectories.len()).sum();
        Ok((trajectories, parts.iter().map(|part| part.samples()).sum(), set.train.h))
    }

    fn modlanet(&self, system: ManyBody) -> Result<Size, Failure> {
        let foreign = [
            (self.drag != 0.0, "--drag"),
            (self.pull != 0.0, "--pull"),
            (self.no_control, "--no-control"),
            (self.control.is_some(), "--control"),
            (self.symo_layout, "--symo-layout"),
            (self.speed.is_some() && matches!(system, ManyBody::Bodies(_)), "--speed"),
        ];
        refuse(system.name(), &foreign)?;
        let settings = self.modlanet_settings(system);
        fits(settings.trajectories, settings.samples, system.coordinates())?;
        if !self.modlanet_layout {
            return self.log(&generate_many(&settings).map_err(failed)?);
        }
        if settings.trajectories < 2 {
            return Err(Failure::Input("--modlanet-layout needs --trajectories 2 or more".to_owned()));
        }
        let set = modlanet_set_of(&settings).map_err(failed)?;
        modlanet::write(self.file(), &set).map_err(written)?;
        Ok((settings.trajectories, set.train.q.len() + set.test.q.len(), settings.h))
    }

    fn lgnn(&self, system: LgnnSystem) -> Result<Size, Failure> {
        let foreign = [
            (self.count.is_some() && system == LgnnSystem::Hybrid, "--count"),
            (self.speed.is_some(), "--speed"),
            (self.no_control, "--no-control"),
            (self.control.is_some(), "--control"),
            (self.symo_layout, "--symo-layout"),
            (self.modlanet_layout, "--modlanet-layout"),
        ];
        refuse(system.name(), &foreign)?;
        let published = LgnnSettings::published(system, self.seed);
        let settings = LgnnSettings {
            drag: self.drag,
            pull: self.pull,
            trajectories: self.trajectories.map_or(published.trajectories, |count| count as usize),
            samples: self.samples.map_or(published.samples, |count| count as usize),
            h: self.h.unwrap_or(published.h),
            noise: self.noise,
            ..published
        };
        fits(settings.trajectories, settings.samples, 2 * system.nodes())?;
        self.log(&lgnn_set(&settings).map_err(|error| match error {
            GenerationError::Mechanism(error) => Failure::Input(format!("{}: {error}", system.name())),
            other => failed(other),
        })?)
    }

    fn modlanet_settings(&self, system: ManyBody) -> ModlanetSettings {
        let published = ModlanetSettings::published(system, self.seed);
        ModlanetSettings {
            trajectories: self.trajectories.map_or(published.trajectories, |count| count as usize),
            samples: self.samples.map_or(published.samples, |count| count as usize),
            h: self.h.unwrap_or(published.h),
            speed: self.speed.unwrap_or(published.speed),
            noise: self.noise,
            ..published
        }
    }
}

/// Refuses logs that would fill the memory. A sample has q, v, a and u, its time and its trajectory's id.
fn fits(trajectories: usize, samples: usize, coordinates: usize) -> Result<(), Failure> {
    let numbers = trajectories.saturating_mul(samples).saturating_mul(4 * coordinates + 2);
    if numbers <= MOST_NUMBERS {
        return Ok(());
    }
    Err(Failure::Input(format!(
        "{trajectories} trajectories of {samples} samples are {:.1e} numbers, and a log holds at most {MOST_NUMBERS}; lower \
         --trajectories or --samples, or write several logs with different seeds",
        numbers as f64
    )))
}

fn failed(error: impl fmt::Display) -> Failure {
    Failure::Work(error.to_string())
}
