//! Friction and devices of the mechanism that a scenario acts on.

use super::changes::{Changes, undrifted};
use super::over_time::OverTime;
use super::scenario::Request;
use super::{Plant, Scenario};
use clap::Args;
use leastaction::cli::Failure;
use leastaction::cli::arguments::{finite, not_negative, positive};
use leastaction_core::energy::trigonometric::Trigonometric;
use leastaction_core::forces::{Coulomb, DryFriction, Sticking, StickingFriction, System, Viscous};
use leastaction_core::model::ActuatorBytes;
use leastaction_firmware_sim::devices::{Drive, LearnedActuator};
use leastaction_firmware_sim::observer::LearnZeros;
use leastaction_firmware_sim::scenario::Setup;
use leastaction_ground_truth::Waves;
use leastaction_models::{ChangeError, Model};

/// Deviations of the mechanism from what the firmware would like. Lists have one value per coordinate, or one for all.
#[derive(Args, Clone, Default)]
#[command(next_help_heading = "Friction and devices of the mechanism")]
pub struct World {
    /// Viscous friction b, N m s/rad or N s/m.
    #[arg(long, value_name = "B,…", value_delimiter = ',', allow_negative_numbers = true, value_parser = not_negative)]
    viscous: Vec<f64>,
    /// Coulomb friction c of −c tanh(v/ε), N m or N.
    #[arg(long, value_name = "C,…", value_delimiter = ',', allow_negative_numbers = true, value_parser = not_negative)]
    coulomb: Vec<f64>,
    /// Width ε of Coulomb friction, rad/s or m/s [default: 0.05].
    #[arg(long, value_name = "E,…", value_delimiter = ',', value_parser = positive, requires = "coulomb")]
    width: Vec<f64>,
    /// Whether Coulomb friction sticks at rest instead of creeping.
    #[arg(long, requires = "coulomb", conflicts_with = "width")]
    sticking: bool,
    /// Zero offsets of the encoders (reading minus true position), rad or m [default: 0].
    #[arg(long, value_name = "Z,…", value_delimiter = ',', allow_negative_numbers = true, value_parser = finite)]
    zeros: Vec<f64>,
    /// Standard deviation of the encoders' noise, rad or m [default: 0.001 rad, 0.0002 m].
    #[arg(long, value_name = "SD,…", value_delimiter = ',', allow_negative_numbers = true, value_parser = not_negative)]
    noise: Vec<f64>,
    /// Gain of the drives: the force for a command of 1, not 0 [default: that of the plant's file, else 1]. The firmware assumes the gain
    /// of the model file, else the true one.
    #[arg(long, value_name = "G,…", value_delimiter = ',', allow_negative_numbers = true, value_parser = finite)]
    gain: Vec<f64>,
    /// Offset of the drives: the force without a command, N or N m [default: that of the plant's file, else 0]. The firmware assumes it as
    /// it does the gain.
    #[arg(long, value_name = "O,…", value_delimiter = ',', allow_negative_numbers = true, value_parser = finite)]
    offset: Vec<f64>,
    /// Largest forces of the drives, N m or N [default: those of the motion's file or of the scenario, else the largest in the training
    /// data].
    #[arg(long, value_name = "F,…", value_delimiter = ',', allow_negative_numbers = true, value_parser = not_negative)]
    limit: Vec<f64>,
    /// Delay from a command to its effect, ms, at most 8 ticks [default: 1 tick].
    #[arg(long, value_name = "MS", allow_negative_numbers = true, value_parser = not_negative)]
    delay: Option<f64>,
    /// Delay that the firmware assumes, ms [default: that of the model file, else the true one].
    #[arg(long, value_name = "MS", allow_negative_numbers = true, value_parser = not_negative)]
    known_delay: Option<f64>,
    /// Time constant of a lag of the drives behind the delay, ms, at most 8 ticks [default: that of the plant's file, else 0].
    #[arg(long, value_name = "MS", allow_negative_numbers = true, value_parser = not_negative)]
    lag: Option<f64>,
    /// Lag that the firmware assumes, ms [default: that of the model file, else the true one].
    #[arg(long, value_name = "MS", allow_negative_numbers = true, value_parser = not_negative)]
    known_lag: Option<f64>,
    /// Largest lateness of ticks, ms; less than a tick [default: 0].
    #[arg(long, value_name = "MS", allow_negative_numbers = true, value_parser = not_negative)]
    jitter: Option<f64>,
    /// Learn the encoders' zero offsets in the firmware, with this prior standard deviation, rad or m.
    #[arg(long, value_name = "SD", allow_negative_numbers = true, value_parser = positive)]
    learn_zeros: Option<f64>,
    #[command(flatten)]
    pub(super) changes: Changes,
}

/// Friction of an exact mechanism, of which either the smooth or the sticking dry friction is 0.
pub type Friction<const N: usize> = (Viscous<f32, N>, (Coulomb<f32, N>, Sticking<f32, N>));

/// Default width of Coulomb friction.
const WIDTH: f64 = 0.05;
/// Standard deviation of an innovation while zeros are learned, rad or m; it includes noise and model errors.
const INNOVATION: f32 = 3e-3;

impl World {
    /// A mechanism with dry friction (N m or N, changing its sign over `width`, rad/s or m/s) whose drives are late by `delay`, s.
    pub fn dry_and_late(coulomb: Vec<f64>, width: f64, delay: f64) -> Self {
        Self { coulomb, width: vec![width], delay: Some(1e3 * delay), ..Self::default() }
    }

    /// Deviations of a mechanism that stays as it is.
    #[must_use]
    pub(super) fn unchanged(&self) -> Self {
        Self { changes: Changes::default(), ..self.clone() }
    }

    /// Refuses options that have no meaning for a scenario.
    pub fn check(&self, request: &Request) -> Result<(), Failure> {
        let friction = !self.viscous.is_empty() || !self.coulomb.is_empty();
        let devices = [&self.zeros, &self.noise, &self.gain, &self.offset, &self.limit]
            .iter()
            .any(|list| !list.is_empty())
            || self.times().iter().chain([&self.learn_zeros]).any(Option::is_some);
        if devices && request.scenario == Scenario::Predict {
            return Err(Failure::Input(
                "predict has no encoders, no drives and no clock; leave out what is said of them, or take track or \
                 swing-up"
                    .to_owned(),
            ));
        }
        if friction && matches!(request.plant, Plant::Model { .. }) {
            let reason =
                "a mechanism from a file has the friction of its file; leave out --viscous and --coulomb";
            return Err(Failure::Input(reason.to_owned()));
        }
        self.changes.check(request)
    }

    /// The standard deviation of zero offsets to be learned along a log. Refuses all other options, since a log already
    /// contains its own friction and devices.
    pub fn only_zeros(&self) -> Result<Option<f32>, Failure> {
        let Self { viscous, coulomb, width, zeros, noise, gain, offset, limit, .. } = self;
        let lists = [viscous, coulomb, width, zeros, noise, gain, offset, limit];
        if lists.iter().any(|list| !list.is_empty()) || self.times().iter().any(Option::is_some) {
            let reason = "--replay takes friction, delay and noise as they are in the log; of the options for them it \
                          knows --learn-zeros alone";
            return Err(Failure::Input(reason.to_owned()));
        }
        if !self.changes.are_none() {
            let reason = "--replay takes loads and friction as they are in the log; leave out --payload and --friction-drift";
            return Err(Failure::Input(reason.to_owned()));
        }
        Ok(self.learn_zeros.map(|deviation| deviation as f32))
    }

    fn times(&self) -> [Option<f64>; 5] {
        [self.delay, self.known_delay, self.lag, self.known_lag, self.jitter]
    }

    /// The systems of an exact mechanism with its friction.
    pub(super) fn systems<'w, const N: usize>(
        &self,
        waves: &'w OverTime<(Waves<N>, f64)>,
    ) -> Result<OverTime<System<Trigonometric<'w, N>, Friction<N>>>, Failure> {
        if self.changes.drift().is_some() && !self.viscous.iter().chain(&self.coulomb).any(|x| *x > 0.0) {
            return Err(undrifted(ChangeError::NoFriction));
        }
        waves.map(|(waves, factor)| {
            Ok(System { lagrangian: waves.lagrangian(), forces: self.friction(*factor as f32)? })
        })
    }

    /// The friction of an exact mechanism, grown by a factor.
    fn friction<const N: usize>(&self, factor: f32) -> Result<Friction<N>, Failure> {
        let viscous: [f32; N] = for_all("--viscous", &self.viscous, 0.0)?;
        let constants: [f32; N] = for_all("--coulomb", &self.coulomb, 0.0)?;
        let [viscous, constants] = [viscous, constants].map(|each| each.map(|number| factor * number));
        let widths: [f32; N] = for_all("--width", &self.width, WIDTH)?;
        let smooth =
            |i: usize| DryFriction { constant: constants[i], width: widths[i], ..DryFriction::none() };
        let sticking = |i: usize| StickingFriction { constant: constants[i], ..StickingFriction::none() };
        let (mut coulomb, mut stuck) = ([DryFriction::none(); N], [StickingFriction::none(); N]);
        match self.sticking {
            true => stuck = std::array::from_fn(sticking),
            false => coulomb = std::array::from_fn(smooth),
        }
        let dry = (Coulomb { coordinates: coulomb }, Sticking { coordinates: stuck });
        Ok((Viscous { coefficients: viscous }, dry))
    }

    /// The largest forces of the drives, if given.
    pub fn limit<const N: usize>(&self) -> Result<Option<[f32; N]>, Failure> {
        (!self.limit.is_empty()).then(|| for_all("--limit", &self.limit, 0.0)).transpose()
    }

    /// Sets the devices of a setup, and what the firmware knows of them.
    pub fn adapt<const N: usize>(
        &self,
        setup: &mut Setup<N>,
        (plant, model): (Plant, &Model),
    ) -> Result<(), Failure> {
        self.encoders(setup)?;
        self.actuators(setup, (plant, model))?;
        if let Some(jitter) = self.jitter {
            let clock = &mut setup.devices.clock;
            (clock.late, clock.jitter) = (1.0, (1e-3 * jitter / f64::from(setup.tick)) as f32);
        }
        Ok(())
    }

    fn encoders<const N: usize>(&self, setup: &mut Setup<N>) -> Result<(), Failure> {
        let zeros: [f32; N] = for_all("--zeros", &self.zeros, 0.0)?;
        let noises: [f32; N] = for_all("--noise", &self.noise, 0.0)?;
        for (i, encoder) in setup.devices.encoders.iter_mut().enumerate() {
            encoder.zero = zeros[i];
            encoder.noise = if self.noise.is_empty() { encoder.noise } else { noises[i] };
        }
        setup.observer.zeros = self
            .learn_zeros
            .map(|deviation| LearnZeros { deviation: deviation as f32, innovation: INNOVATION });
        Ok(())
    }

    fn actuators<const N: usize>(
        &self,
        setup: &mut Setup<N>,
        (plant, model): (Plant, &Model),
    ) -> Result<(), Failure> {
        let (h, truth) = (setup.tick, &mut setup.devices.actuator);
        let ticks = |ms: f64| (1e-3 * ms / f64::from(h)) as f32;
        truth.delay = self.delay.map_or(truth.delay, ticks);
        truth.lag = self.lag.map_or(truth.lag, ticks);
        truth.limit = self.limit()?.unwrap_or(truth.limit);
        truth.drive = Drive {
            gain: for_all("--gain", &self.gain, 1.0)?,
            offset: for_all("--offset", &self.offset, 0.0)?,
        };
        if let Plant::Model { model, .. } = plant
            && let Some(LearnedActuator { drive, lag, .. }) = known_actuator::<N>(model, h)?
        {
            truth.lag = if self.lag.is_none() { lag } else { truth.lag };
            truth.drive.gain = if self.gain.is_empty() { drive.gain } else { truth.drive.gain };
            truth.drive.offset = if self.offset.is_empty() { drive.offset } else { truth.drive.offset };
        }
        let known = known_actuator::<N>(model, h)?;
        setup.known_drive = known.map_or(truth.drive, |known| known.drive);
        let [delay, lag] = known.map_or([truth.delay, truth.lag], |known| [known.delay, known.lag]);
        setup.observer.delay = self.known_delay.map_or(delay, ticks);
        setup.observer.lag = self.known_lag.map_or(lag, ticks);
        Ok(())
    }
}

/// The actuator of a model file for steps of h seconds; `None` if the command is the force.
pub fn known_actuator<const N: usize>(model: &Model, h: f32) -> Result<Option<LearnedActuator<N>>, Failure> {
    let bytes = model.facts.actuator.to_bytes();
    let Ok(file) = ActuatorBytes::new(&bytes) else { return Ok(None) };
    LearnedActuator::new(&file, h).map(Some).map_err(|error| Failure::Input(error.to_string()))
}

/// Replaces `values` by those of an option, if the option is given.
pub(super) fn replace<const N: usize>(
    option: &str,
    list: &[f64],
    values: &mut [f32; N],
) -> Result<(), Failure> {
    if !list.is_empty() {
        *values = for_all(option, list, 0.0)?;
    }
    Ok(())
}

/// Expands a list to one value per coordinate.
pub(super) fn for_all<const N: usize>(option: &str, list: &[f64], default: f64) -> Result<[f32; N], Failure> {
    match list {
        [] => Ok([default as f32; N]),
        [one] => Ok([*one as f32; N]),
        some if some.len() == N => Ok(std::array::from_fn(|i| some[i] as f32)),
        some => {
            let found = some.len();
            Err(Failure::Input(format!(
                "{option} has {found} values; give one, or {N}, one for each coordinate"
            )))
        }
    }
}
