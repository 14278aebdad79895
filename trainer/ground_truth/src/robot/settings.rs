use super::linkage::{Linkage, Terms};
use crate::motion::BadMechanism;
use crate::{Exact, Mechanism};
use std::f64::consts::PI;
use thiserror::Error;

/// The mechanism that is driven.
#[derive(Clone, Debug, PartialEq)]
pub enum Machine {
    /// One of SyMo's mechanisms, in its coordinates.
    Named(Mechanism),
    /// Links on joints.
    Linkage(Linkage),
}

/// Friction of a joint: Q = −b v − c tanh(v/ε).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointFriction {
    /// Viscous friction b ≥ 0, N m s/rad or N s/m.
    pub viscous: f64,
    /// Coulomb friction c ≥ 0, N m or N.
    pub coulomb: f64,
    /// Width ε > 0, rad/s or m/s.
    pub width: f64,
}

/// Encoders and the clock that samples them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensors {
    /// Standard deviation σ of the noise before quantisation, rad or m.
    pub noise: f64,
    /// Encoder count, rad or m; 0: no quantisation.
    pub grid: f64,
    /// Standard deviation of the zero offsets z, one per encoder and log, rad or m.
    pub zeros: f64,
    /// Largest deviation of sampling instants from their nominal time, s, uniformly distributed; less than h/2.
    pub jitter: f64,
}

/// The drives.
#[derive(Clone, Debug, PartialEq)]
pub struct Drives {
    /// Gain g of every coordinate.
    pub gain: Vec<f64>,
    /// Delay d, s.
    pub delay: f64,
    /// Standard deviation of the torque of a driven coordinate about the commanded one, drawn anew for every command, N m or N.
    pub noise: f64,
    /// Whether each coordinate has a drive.
    pub driven: Vec<bool>,
}

/// Control: a sum of sines for every driven coordinate and log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excitation {
    /// Number of sines in a sum.
    pub sines: usize,
    /// Least and greatest frequency, Hz.
    pub frequency: [f64; 2],
    /// Least and greatest amplitude of a sine, N m or N.
    pub amplitude: [f64; 2],
}

/// Distribution of the starts: uniform about rest in the hanging position.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StartSpread {
    /// Range of q, ±, rad or m.
    pub q: f64,
    /// Range of v, ±, rad/s or m/s.
    pub v: f64,
}

/// Settings of simulated logs.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotSettings {
    /// Mechanism.
    pub machine: Machine,
    /// Friction of every coordinate.
    pub friction: Vec<JointFriction>,
    /// Encoders and clock.
    pub sensors: Sensors,
    /// Drives.
    pub drives: Drives,
    /// Control.
    pub excitation: Excitation,
    /// Distribution of the starts.
    pub start: StartSpread,
    /// Number of logs.
    pub logs: usize,
    /// Number of samples in each log.
    pub samples: usize,
    /// Mean time between samples, s.
    pub h: f64,
    /// Seed of all random numbers.
    pub seed: u64,
}

/// The reason why there are no logs.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum RobotError {
    /// The mechanism is invalid.
    #[error(transparent)]
    Machine(#[from] BadMechanism),
    /// There are too many joints.
    #[error("{joints} joints; a robot has 1 to 4")]
    Joints {
        /// Requested number of joints.
        joints: usize,
    },
    /// A list has the wrong length.
    #[error("{what}: {found} values for {coordinates} coordinates")]
    Count {
        /// Name of the list.
        what: &'static str,
        /// Length of the list.
        found: usize,
        /// Coordinates of the machine.
        coordinates: usize,
    },
    /// A number is out of range.
    #[error("{what} {value}: it must be {range}")]
    Setting {
        /// Name of the number.
        what: &'static str,
        /// Given value.
        value: f64,
        /// Valid range, in words.
        range: &'static str,
    },
    /// The motion diverged.
    #[error("log {log}: the motion cannot be followed beyond {t} s; lower the forces or the speeds")]
    Diverged {
        /// Log, from 0.
        log: usize,
        /// Time, s.
        t: f64,
    },
}

impl Machine {
    /// Number of coordinates.
    pub fn coordinates(&self) -> usize {
        match self {
            Self::Named(mechanism) => mechanism.coordinates().len(),
            Self::Linkage(linkage) => linkage.joints.len(),
        }
    }

    /// The hanging position: θ = 0 is upright for SyMo's pendulum and pole.
    pub fn hanging(&self) -> Vec<f64> {
        match self {
            Self::Named(Mechanism::Pendulum) => vec![PI],
            Self::Named(Mechanism::Cartpole) => vec![0.0, PI],
            _ => vec![0.0; self.coordinates()],
        }
    }

    /// Whether each coordinate is driven by default: all are, except that a cart-pole drives only its cart.
    pub fn driven(&self) -> Vec<bool> {
        match self {
            Self::Named(Mechanism::Cartpole) => vec![true, false],
            _ => vec![true; self.coordinates()],
        }
    }

    /// The terms of the energies, for N coordinates.
    pub(super) fn terms<const N: usize>(&self) -> Result<Terms<N>, RobotError> {
        match self {
            Self::Linkage(linkage) => Ok(linkage.terms()?),
            Self::Named(mechanism) => {
                let terms = match mechanism.exact() {
                    Exact::One(exact) => resized(&Terms::of(&exact)),
                    Exact::Two(exact) => resized(&Terms::of(&exact)),
                };
                terms.ok_or(RobotError::Joints { joints: N })
            }
        }
    }
}

/// The terms as terms for N coordinates; `None` if they have another number of coordinates.
fn resized<const M: usize, const N: usize>(terms: &Terms<M>) -> Option<Terms<N>> {
    use leastaction_core::energy::trigonometric::Wave;
    let wave = |wave: &Wave<M>| {
        let numbers = <[f64; N]>::try_from(wave.wave.as_slice()).ok()?;
        Some(Wave { amplitude: wave.amplitude, wave: numbers })
    };
    let inertia = terms.inertia.iter().map(|(i, j, term)| Some((*i, *j, wave(term)?)));
    let potential = terms.potential.iter().map(wave);
    Some(Terms { inertia: inertia.collect::<Option<_>>()?, potential: potential.collect::<Option<_>>()? })
}

impl RobotSettings {
    /// Checks that every number is in its range.
    ///
    /// # Errors
    /// [`RobotError`] for the first number out of range.
    pub fn check(&self) -> Result<(), RobotError> {
        let Self { sensors, drives, excitation, start, h, .. } = self;
        self.check_lists()?;
        above("step", *h)?;
        for joint in &self.friction {
            not_below("viscous friction", joint.viscous)?;
            not_below("Coulomb friction", joint.coulomb)?;
            above("width of Coulomb friction", joint.width)?;
        }
        not_below("encoder noise", sensors.noise)?;
        not_below("encoder grid", sensors.grid)?;
        not_below("deviation of the zeros", sensors.zeros)?;
        not_below("jitter", sensors.jitter)?;
        require("jitter", sensors.jitter, sensors.jitter < 0.5 * h, "less than half the step, s")?;
        not_below("delay of the drives", drives.delay)?;
        not_below("noise of the drives", drives.noise)?;
        drives.gain.iter().try_for_each(|gain| require("gain", *gain, gain.is_finite(), "finite"))?;
        rising("frequency", excitation.frequency)?;
        rising("amplitude", excitation.amplitude)?;
        not_below("spread of the starts", start.q)?;
        not_below("speed of the starts", start.v)
    }

    fn check_lists(&self) -> Result<(), RobotError> {
        let coordinates = self.machine.coordinates();
        let lists = [
            ("friction", self.friction.len()),
            ("gain", self.drives.gain.len()),
            ("driven", self.drives.driven.len()),
        ];
        match lists.into_iter().find(|(_, found)| *found != coordinates) {
            Some((what, found)) => Err(RobotError::Count { what, found, coordinates }),
            None => Ok(()),
        }
    }
}

fn require(what: &'static str, value: f64, good: bool, range: &'static str) -> Result<(), RobotError> {
    if good { Ok(()) } else { Err(RobotError::Setting { what, value, range }) }
}

fn above(what: &'static str, value: f64) -> Result<(), RobotError> {
    require(what, value, value.is_finite() && value > 0.0, "finite and above 0")
}

fn not_below(what: &'static str, value: f64) -> Result<(), RobotError> {
    require(what, value, value.is_finite() && value >= 0.0, "finite and not below 0")
}

fn rising(what: &'static str, [least, greatest]: [f64; 2]) -> Result<(), RobotError> {
    not_below(what, least)?;
    require(what, greatest, greatest.is_finite() && greatest >= least, "finite and not below the least")
}
