//! `leastaction excite`.

use super::motion::MotionFile;
use clap::Args;
use leastaction::cli::arguments::{finite, positive, seed};
use leastaction::cli::{Done, Failure, FileKind, MOTION_HEAD, Output, replaceable, written};
use leastaction_learning::atomic;
use leastaction_learning::data::{self, Dataset, Trajectory};
use leastaction_learning::torque::excitation::{Excitation, ExcitationError, Search, Use, excite};
use leastaction_models::tree::{Limits, Tree};
use leastaction_models::urdf::{self, Described, Inertias, Options};
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;

/// Find a motion that excites an arm enough to identify its masses, inertias and friction.
///
/// The motion is a Fourier series of every joint that starts and ends each period at rest, within the limits of position, velocity and
/// effort in the robot description (URDF). The search minimises the condition number of the regressor of base parameters and friction, with
/// columns scaled to norm 1. The same seed gives the same motion on any number of threads. Obstacles, the arm itself included, are not
/// considered: check the motion before running it.
///
/// Torques are kept within their limits as far as the description has masses; friction is not included.
///
/// Example: leastaction excite panda.urdf -o excitation.csv --motion excitation.toml
#[derive(Args)]
pub struct Excite {
    /// The robot description.
    urdf: PathBuf,
    /// The motion to write, .csv or .npz: t, q and v of one period.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Also write the motion as a Fourier series, for `simulate --scenario track --trajectory`.
    #[arg(long, value_name = "FILE.toml")]
    motion: Option<PathBuf>,
    /// Period of the motion, s.
    #[arg(long, value_name = "S", default_value_t = 10.0, value_parser = positive)]
    period: f64,
    /// Number of harmonics per joint.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u8).range(3..=5))]
    harmonics: u8,
    /// Time between rows, s.
    #[arg(long, value_name = "S", default_value_t = 0.001, value_parser = positive)]
    h: f64,
    /// Fraction of every limit that may be used, up to 1.
    #[arg(long, value_name = "PART", default_value_t = 0.9, value_parser = positive)]
    share: f64,
    /// Position limit, ±, for joints without one, rad or m.
    #[arg(long, value_name = "RAD", value_parser = positive)]
    position: Option<f64>,
    /// Velocity limit for joints without one, rad/s or m/s.
    #[arg(long, value_name = "RAD/S", value_parser = positive)]
    velocity: Option<f64>,
    /// Effort limit for joints without one, N m or N; by default they are unlimited.
    #[arg(long, value_name = "NM", value_parser = positive)]
    effort: Option<f64>,
    /// Total mass of all links without mass in the description, kg: their bodies are guessed from it.
    #[arg(long, value_name = "KG", value_parser = positive)]
    mass: Option<f64>,
    /// Joints that move, separated by commas; all others are held still.
    #[arg(long, value_name = "JOINT,…", value_delimiter = ',')]
    joints: Option<Vec<String>>,
    /// Position at which a joint is held still, rad or m, as joint=0.5; repeat it for more joints.
    #[arg(long, value_name = "JOINT=POSITION", value_parser = locked)]
    lock: Vec<(String, f64)>,
    /// Number of searches, each from its own start.
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u16).range(1..))]
    starts: u16,
    /// Number of motions that each search tries.
    #[arg(long, value_name = "N", default_value_t = 500, value_parser = clap::value_parser!(u32).range(1..))]
    trials: u32,
    /// Seed of the random numbers.
    #[arg(long, default_value_t = 0, value_parser = seed, allow_negative_numbers = true)]
    seed: u64,
}

/// Reads a joint and the position at which it is held.
fn locked(text: &str) -> Result<(String, f64), String> {
    let (joint, at) = text.split_once('=').ok_or("a joint and its position, as joint=0.5")?;
    Ok((joint.to_owned(), finite(at)?))
}

/// Radius of guessed bodies about their lines, m.
const RADIUS: f64 = 0.1;
/// Largest number of rows.
const MOST_ROWS: f64 = 1e7;

/// Report on the motion that was found and written.
#[derive(Serialize)]
struct Report {
    file: PathBuf,
    #[serde(skip_serializing_if = "Option::is_none")]
    motion: Option<PathBuf>,
    rows: usize,
    h: f64,
    period: f64,
    seed: u64,
    /// Condition number of the first motion tried.
    condition_before: f64,
    condition: f64,
    joints: Vec<JointUse>,
}

/// Extent to which a motion uses the limits of a joint; a limit that does not exist is null.
#[derive(Serialize)]
struct JointUse {
    joint: String,
    position: [f64; 2],
    position_limits: [f64; 2],
    velocity: f64,
    velocity_limit: f64,
    effort: f64,
    effort_limit: Option<f64>,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { file, rows, h, period, condition_before, condition, joints, .. } = self;
        writeln!(f, "{}: {rows} rows, one every {h} s, period {period} s", file.display())?;
        writeln!(f, "condition number {condition:.1}, of the first motion {condition_before:.1}")?;
        let width = joints.iter().map(|of| of.joint.chars().count()).max().unwrap_or(0).max(5);
        writeln!(
            f,
            "{:width$} {:>34} {:>18} {:>18}",
            "joint", "position (limits)", "velocity (limit)", "effort (limit)"
        )?;
        for of in joints {
            let [[from, to], [least, most]] = [of.position, of.position_limits];
            let position = format!("{from:.3} … {to:.3} ({least:.3} … {most:.3})");
            let velocity = format!("{:.3} ({:.3})", of.velocity, of.velocity_limit);
            let limit = of.effort_limit.map_or("none".to_owned(), |limit| format!("{limit:.1}"));
            let effort = format!("{:.2} ({limit})", of.effort);
            writeln!(f, "{:width$} {position:>34} {velocity:>18} {effort:>18}", of.joint)?;
        }
        Ok(())
    }
}

impl Excite {
    /// Searches for a motion and writes it.
    pub fn run(self, output: Output) -> Done {
        replaceable(&self.output, FileKind::Log)?;
        self.motion.iter().try_for_each(|path| replaceable(path, FileKind::Motion))?;
        if self.period / self.h > MOST_ROWS {
            return Err(Failure::Input(format!("--period over --h: more than {MOST_ROWS:e} rows")));
        }
        let tree = self.tree(output)?;
        let limits: Vec<Limits> = (0..tree.coordinates()).map(|k| self.limits(&tree, k)).collect();
        if self.motion.is_some() && limits.iter().any(|of| !of.effort.is_finite()) {
            let what = "--motion has the largest forces in it, and the description has no effort for every joint; give --effort";
            return Err(Failure::Input(what.to_owned()));
        }
        let found = excite(&tree, &limits, &self.search()).map_err(|error| self.failed(&error))?;
        let rows = self.write(&found)?;
        if let Some(path) = &self.motion {
            let text = format!(
                "{MOTION_HEAD}\n{}",
                motion_text(&found, &limits).map_err(|error| Failure::file(path, error))?
            );
            atomic::write(path, text.as_bytes()).map_err(|error| Failure::file(path, error))?;
        }
        output.report(&self.report((&tree, &limits), &found, rows))
    }

    fn search(&self) -> Search {
        let Self { period, harmonics, share, starts, trials, seed, .. } = *self;
        Search {
            period,
            harmonics: harmonics.into(),
            share,
            starts: starts.into(),
            trials: trials as usize,
            seed,
        }
    }

    fn tree(&self, output: Output) -> Result<Tree, Failure> {
        let (joints, lock) = (self.joints.clone(), self.lock.iter().cloned().collect());
        let options = Options { inertias: Inertias::Optional, joints, lock, ..Options::default() };
        let Described { tree, notes } =
            urdf::read_with(&self.urdf, &options).map_err(|error| Failure::input(&self.urdf, error))?;
        output.notes(&notes.iter().map(ToString::to_string).collect::<Vec<_>>());
        let tree = self.mass.map_or_else(|| tree.clone(), |mass| tree.with_guessed_inertias(mass, RADIUS));
        let massless = tree.bodies().iter().filter(|body| body.inertia.mass() == 0.0).count();
        if massless > 0 {
            output.note(&format!(
                "note: {massless} of {} bodies have no mass in the description, so torques are not held to their limits; --mass guesses them",
                tree.bodies().len()
            ));
        }
        Ok(tree)
    }

    /// The limits of the description, completed by those of the options.
    fn limits(&self, tree: &Tree, coordinate: usize) -> Limits {
        let Limits { position, velocity, effort } = tree.limits(coordinate);
        let or =
            |limit: f64, given: Option<f64>| if limit.is_finite() { limit } else { given.unwrap_or(limit) };
        let [from, to] = position;
        let position = [-or(-from, self.position), or(to, self.position)];
        Limits { position, velocity: or(velocity, self.velocity), effort: or(effort, self.effort) }
    }

    fn failed(&self, error: &ExcitationError) -> Failure {
        match error {
            ExcitationError::NoLimit { what, .. } => {
                Failure::input(&self.urdf, format!("{error}; give one with --{what}"))
            }
            ExcitationError::NoRoom { .. } => Failure::input(&self.urdf, error),
            ExcitationError::Search(_) => Failure::Input(error.to_string()),
            _ => Failure::file(&self.urdf, error),
        }
    }

    /// Writes the log of one period; returns its number of rows.
    fn write(&self, found: &Excitation) -> Result<usize, Failure> {
        let rows = (self.period / self.h + 1e-9) as usize + 1;
        let samples = found.series.samples(rows, self.h);
        let n = samples.q.width();
        let one = Trajectory { id: 0, t0: 0.0, q: samples.q, v: Some(samples.v), a: None, u: None };
        let log = Dataset { n, h: self.h, control: None, trajectories: vec![one] };
        data::write(&self.output, &log).map_err(written)?;
        Ok(rows)
    }

    fn report(&self, (tree, limits): (&Tree, &[Limits]), found: &Excitation, rows: usize) -> Report {
        let joint = |(k, (own, limits)): (usize, (&Use, &Limits))| JointUse {
            joint: tree.coordinate_name(k).to_owned(),
            position: own.position,
            position_limits: limits.position,
            velocity: own.velocity,
            velocity_limit: limits.velocity,
            effort: own.effort,
            effort_limit: Some(limits.effort).filter(|effort| effort.is_finite()),
        };
        Report {
            file: self.output.clone(),
            motion: self.motion.clone(),
            rows,
            h: self.h,
            period: self.period,
            seed: self.seed,
            condition_before: found.condition[0],
            condition: found.condition[1],
            joints: found.uses.iter().zip(limits).enumerate().map(joint).collect(),
        }
    }
}

fn motion_text(found: &Excitation, limits: &[Limits]) -> Result<String, toml::ser::Error> {
    let Excitation { series, .. } = found;
    let part = |part: usize| -> Vec<Vec<f64>> {
        series.waves.iter().map(|waves| waves.iter().map(|wave| wave[part]).collect()).collect()
    };
    toml::to_string(&MotionFile {
        frequency: series.frequency,
        // The motion already begins at rest.
        ramp: 0.0,
        centre: series.centre.clone(),
        limit: limits.iter().map(|of| of.effort).collect(),
        cosine: part(0),
        sine: part(1),
    })
}
