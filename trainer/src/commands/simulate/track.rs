//! The scenario `track`: following a motion from a file, with the model of one file on the plant of another.

use super::plant::{OnPlant, Systems, encoders};
use super::reference::{Followed, is_series};
use super::scenario::{closed_loop, following, misused};
use super::{Report, Request, Trace};
use clap::{Args, ValueEnum};
use leastaction::cli::Failure;
use leastaction::cli::arguments::positive_f32;
use leastaction_firmware_sim::control::{Gains, Law, Trajectory};
use leastaction_firmware_sim::scenario::TrackConfig;
use std::path::{Path, PathBuf};

/// Options for following a motion.
#[derive(Args, Default)]
#[command(next_help_heading = "Following a motion (track)")]
pub struct TrackArgs {
    /// A motion of all coordinates: a log of one motion (.csv, .npz), followed once by a smooth curve through its positions, and entered
    /// from rest over 2 s if it does not begin at rest; or, periodic, a .toml with `frequency` (Hz), `centre` (rad or m), `cosine` and
    /// `sine` (rad or m, each with a row of at most five harmonics per coordinate), `limit` (largest forces, N m or N), and `ramp` (time in
    /// which the motion is entered from rest, s; default 2).
    #[arg(long, value_name = "FILE", requires = "plant")]
    trajectory: Option<PathBuf>,
    /// The controller [default: computed-torque].
    #[arg(long, value_enum)]
    law: Option<LawName>,
    /// Bandwidth ω of the feedback −ω²e − 2ζωė (as an acceleration, equal for all coordinates), rad/s [default: 8].
    #[arg(long, value_name = "RAD/S", value_parser = positive_f32)]
    bandwidth: Option<f32>,
    /// Damping ratio ζ of the feedback; 1 does not overshoot [default: 1].
    #[arg(long, value_name = "ZETA", value_parser = positive_f32)]
    damping: Option<f32>,
    /// Memory of the observer, s, from 5 to 255 ticks: a longer one smooths the encoders' noise more, and follows a wrong model longer
    /// [default: 0.05].
    #[arg(long, value_name = "S", value_parser = positive_f32)]
    memory: Option<f32>,
    /// Cut-off frequency of the velocity filter of pd-encoders, Hz [default: 50].
    #[arg(long, value_name = "HZ", value_parser = positive_f32)]
    cut_off: Option<f32>,
}

/// A controller, by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LawName {
    /// The model's inverse dynamics along the motion, with feedback through its inertia matrix.
    ComputedTorque,
    /// Gravity compensation by the model, and PD feedback joint by joint.
    PdGravity,
    /// Like pd-gravity but without the observer, from encoder readings and their filtered differences; on this machine only.
    PdEncoders,
}

impl LawName {
    /// The firmware's law with an observer; `None` if the law has none.
    fn observed(self) -> Option<Law> {
        match self {
            Self::ComputedTorque => Some(Law::ComputedTorque),
            Self::PdGravity => Some(Law::PdGravity),
            Self::PdEncoders => None,
        }
    }
}

/// Default memory of the observer, s.
pub(super) const MEMORY: f32 = 0.05;
/// Default cut-off frequency of the velocity filter without an observer, Hz.
const CUT_OFF: f32 = 50.0;

impl TrackArgs {
    /// Arguments for the motion of a file, a law, and the bandwidth ω of its feedback (rad/s).
    pub fn along(file: PathBuf, law: LawName, bandwidth: f32) -> Self {
        Self {
            trajectory: Some(file),
            law: Some(law),
            bandwidth: Some(bandwidth),
            damping: None,
            memory: None,
            cut_off: None,
        }
    }

    /// Refuses these options if the scenario has its own motion.
    pub fn check(&self, is_followed: bool, config: Option<&Path>) -> Result<(), Failure> {
        let is_log = self.trajectory.as_deref().is_some_and(|file| !is_series(file));
        if config.is_some() && !is_log {
            return Err(Failure::Input("--config is of a log, to --replay or as --trajectory".to_owned()));
        }
        let by_encoders = self.law == Some(LawName::PdEncoders);
        if self.cut_off.is_some() && !by_encoders {
            return Err(Failure::Input("--cut-off is of --law pd-encoders".to_owned()));
        }
        match (is_followed, &self.trajectory, self.is_tuned()) {
            (true, None, _) => {
                Err(Failure::Input("track with a --plant follows the motion of --trajectory FILE; name one, or leave out --plant".to_owned()))
            }
            (false, Some(_), _) | (false, None, true) => {
                let reason =
                    "--trajectory, --law, --bandwidth, --damping, --memory and --cut-off are of --scenario track with a --plant";
                Err(Failure::Input(reason.to_owned()))
            }
            _ => Ok(()),
        }
    }

    fn is_tuned(&self) -> bool {
        self.law.is_some()
            || [self.bandwidth, self.damping, self.memory, self.cut_off].iter().any(Option::is_some)
    }
}

/// Task of following a motion on the plant of another model file.
pub struct Following;

impl OnPlant for Following {
    fn run<const N: usize>(
        self,
        request: &Request,
        systems: Systems<N>,
        trace: &mut Trace,
    ) -> Result<Report, Failure> {
        let path = request.motion.trajectory.as_deref().unwrap_or(Path::new(""));
        let (motion, limit) = Followed::read(request, path)?;
        let config = config(request, &motion, limit)?;
        if request.motion.law == Some(LawName::PdEncoders) {
            return by_encoders(request, systems, &config, trace);
        }
        following(request, systems, &config, trace)
    }
}

/// Follows the motion without an observer, by the encoder readings.
fn by_encoders<const N: usize>(
    request: &Request,
    (plant, model): Systems<N>,
    config: &TrackConfig<N, &Followed<N>>,
    trace: &mut Trace,
) -> Result<Report, Failure> {
    if request.on.is_some() {
        let reason = "the boards' images have no --law pd-encoders; leave out --on, or take pd-gravity";
        return Err(Failure::Input(reason.to_owned()));
    }
    config.validate().map_err(misused)?;
    let firmware = config.by_encoders(model, request.motion.cut_off.unwrap_or(CUT_OFF));
    let program = config.program();
    closed_loop(request, (plant, model), (&config.setup, &config.reference), (&program, firmware), |tick| {
        trace.push(tick)
    })
}

fn config<'m, const N: usize>(
    request: &Request,
    motion: &'m Followed<N>,
    limit: [f32; N],
) -> Result<TrackConfig<N, &'m Followed<N>>, Failure> {
    let TrackArgs { law, bandwidth, damping, memory, .. } = request.motion;
    let mut config = TrackConfig::new(encoders(request), limit, (motion.at(0.0).q, motion));
    config.setup.tick = 1e-3;
    config.setup.seconds = motion.end().unwrap_or(config.setup.seconds);
    config.law = law.and_then(LawName::observed).unwrap_or_default();
    let Gains { frequency, damping: usual } = config.gains;
    config.gains = Gains { frequency: bandwidth.unwrap_or(frequency), damping: damping.unwrap_or(usual) };
    request.adapt(&mut config.setup)?;
    config.setup.observer.memory = samples(memory.unwrap_or(MEMORY), config.setup.tick);
    Ok(config)
}

/// Number of samples in a time, limited to what an observer can hold.
pub(super) fn samples(seconds: f32, h: f32) -> u8 {
    (seconds / h).round().clamp(5.0, 255.0) as u8
}
