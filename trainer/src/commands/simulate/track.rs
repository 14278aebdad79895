//! Following a motion that a file describes, by the model of one file on the plant of another.

use super::plant::{OnPlant, encoders};
use super::scenario::following;
use super::{Report, Request, Trace};
use crate::commands::motion::MotionFile;
use clap::{Args, ValueEnum};
use leastaction::cli::Failure;
use leastaction::cli::arguments::positive_f32;
use leastaction_chip::SystemOf;
use leastaction_firmware_sim::control::{Gains, HARMONICS, Law, Reference, Trajectory};
use leastaction_firmware_sim::scenario::TrackConfig;
use std::path::{Path, PathBuf};

/// How a motion is followed.
#[derive(Args, Default)]
#[command(next_help_heading = "Following a motion (track)")]
pub struct Motion {
    /// A periodic motion of all coordinates, a TOML file: `frequency` (Hz), `centre` (rad or m), and a row of at most five harmonics a
    /// coordinate each of `cosine` and `sine` (rad or m); `limit`, the largest forces (N m or N); `ramp`, the seconds in which
    /// it is entered from rest (2 where it is left out).
    #[arg(long, value_name = "FILE", requires = "plant")]
    trajectory: Option<PathBuf>,
    /// The controller [default: computed-torque].
    #[arg(long, value_enum)]
    law: Option<LawName>,
    /// ω of the feedback −ω²e − 2ζωė (as an acceleration, of all coordinates alike), rad/s [default: 8].
    #[arg(long, value_name = "RAD/S", value_parser = positive_f32)]
    bandwidth: Option<f32>,
    /// ζ of that feedback; 1 does not overshoot [default: 1].
    #[arg(long, value_name = "ZETA", value_parser = positive_f32)]
    damping: Option<f32>,
}

/// A controller's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LawName {
    /// The model's inverse dynamics along the motion, feedback through its inertia matrix.
    ComputedTorque,
    /// Gravity compensation by the model and PD feedback joint by joint.
    PdGravity,
}

impl From<LawName> for Law {
    fn from(name: LawName) -> Self {
        match name {
            LawName::ComputedTorque => Self::ComputedTorque,
            LawName::PdGravity => Self::PdGravity,
        }
    }
}

/// When a motion begins, s: the observer needs a few samples before.
const BEGIN: f32 = 0.1;
/// What the observer remembers, s.
const MEMORY: f32 = 0.05;
/// Samples of that at the default tick of 1 ms.
pub(super) const MEMORY_SAMPLES: u8 = 50;

impl Motion {
    /// The motion of a file, a law, and ω of its feedback (rad/s).
    pub fn along(file: PathBuf, law: LawName, bandwidth: f32) -> Self {
        Self { trajectory: Some(file), law: Some(law), bandwidth: Some(bandwidth), damping: None }
    }

    /// Refuses what means nothing where the motion is the scenario's own.
    pub fn check(&self, is_followed: bool) -> Result<(), Failure> {
        match (is_followed, &self.trajectory, self.is_tuned()) {
            (true, None, _) => {
                Err(Failure::Input("track with a --plant follows the motion of --trajectory FILE; name one, or leave out --plant".to_owned()))
            }
            (false, Some(_), _) | (false, None, true) => {
                let reason =
                    "--trajectory, --law, --bandwidth and --damping are of --scenario track with a --plant";
                Err(Failure::Input(reason.to_owned()))
            }
            _ => Ok(()),
        }
    }

    fn is_tuned(&self) -> bool {
        self.law.is_some() || self.bandwidth.is_some() || self.damping.is_some()
    }

    /// The motion of N coordinates with the limits of the forces.
    fn read<const N: usize>(&self, path: &Path) -> Result<(Reference<N>, [f32; N]), Failure> {
        let text = std::fs::read_to_string(path).map_err(|error| Failure::file(path, error))?;
        let file: MotionFile = toml::from_str(&text).map_err(|error| Failure::input(path, error))?;
        let wrong = |what: &str, found: usize| {
            Failure::input(path, format!("{what} has {found} entries; the model has {N} coordinates"))
        };
        let single = |list: &[f64]| list.iter().map(|x| *x as f32).collect::<Vec<_>>();
        let all = |what: &str, list: &[f64]| {
            <[f32; N]>::try_from(single(list)).map_err(|_| wrong(what, list.len()))
        };
        let mut waves = [[[0.0; 2]; HARMONICS]; N];
        for (part, (what, rows)) in [("cosine", &file.cosine), ("sine", &file.sine)].into_iter().enumerate() {
            if rows.len() != N {
                return Err(wrong(what, rows.len()));
            }
            for (wave, row) in waves.iter_mut().zip(rows) {
                if row.len() > HARMONICS {
                    let found = row.len();
                    let message =
                        format!("{what} has a row of {found} harmonics; at most {HARMONICS} are followed");
                    return Err(Failure::input(path, message));
                }
                wave.iter_mut().zip(row).for_each(|(pair, x)| pair[part] = *x as f32);
            }
        }
        let centre = all("centre", &file.centre)?;
        let limit = all("limit", &file.limit)?;
        let (ramp, frequency) = (file.ramp as f32, [file.frequency as f32; N]);
        Ok((Reference { begin: BEGIN, ramp, centre, frequency, waves }, limit))
    }
}

/// Following the motion.
pub struct Following;

impl OnPlant for Following {
    fn run<const N: usize>(
        self,
        request: &Request,
        systems: (&SystemOf<N>, &SystemOf<N>),
        trace: &mut Trace,
    ) -> Result<Report, Failure> {
        following(request, systems, &config::<N>(request)?, trace)
    }
}

fn config<const N: usize>(request: &Request) -> Result<TrackConfig<N>, Failure> {
    let Motion { trajectory, law, bandwidth, damping } = request.motion;
    let path = trajectory.as_deref().unwrap_or(Path::new(""));
    let (reference, limit) = request.motion.read::<N>(path)?;
    let mut config = TrackConfig::new(encoders(request), limit, (reference.at(0.0).q, reference));
    config.setup.tick = 1e-3;
    config.law = law.map_or(Law::ComputedTorque, Into::into);
    let Gains { frequency, damping: usual } = config.gains;
    config.gains = Gains { frequency: bandwidth.unwrap_or(frequency), damping: damping.unwrap_or(usual) };
    request.adapt(&mut config.setup)?;
    config.setup.observer.memory = (MEMORY / config.setup.tick).round().clamp(5.0, 255.0) as u8;
    Ok(config)
}
