//! The protocol of ModLaNet's experiments (Lu et al., ICML 2022), as in the authors' program.

use super::logged::{GenerationError, Horizon, Start, logged};
use super::{BadMechanism, Bodies, Chain, ExactMotion};
use leastaction_data::Dataset;
use leastaction_data::modlanet::{ModlanetRows, ModlanetSet};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::{FRAC_PI_2, PI, SQRT_2, TAU};
/// Radii of the circle on which the bodies start, m.
const RADII: std::ops::Range<f64> = 1.0..5.0;
/// Largest relative disturbance of each velocity component of a body.
const DISTURBANCE: f64 = 0.5;

/// A system of ModLaNet's experiments: any number of equal elements; all masses, lengths and k are 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ManyBody {
    /// Pendulums, each hanging from the one above.
    Pendulum(usize),
    /// Bodies in the plane.
    Bodies(usize),
}

impl ManyBody {
    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pendulum(_) => "n-pendulum",
            Self::Bodies(_) => "n-body",
        }
    }

    /// Number of coordinates: an angle per pendulum, two per body.
    pub fn coordinates(self) -> usize {
        match self {
            Self::Pendulum(count) => count,
            Self::Bodies(count) => 2 * count,
        }
    }

    /// Number of elements.
    pub fn count(self) -> usize {
        match self {
            Self::Pendulum(count) | Self::Bodies(count) => count,
        }
    }

    /// The exact motion.
    ///
    /// # Errors
    /// [`BadMechanism`] if there are no elements.
    pub fn motion(self) -> Result<Box<dyn ExactMotion>, BadMechanism> {
        Ok(match self {
            Self::Pendulum(count) => Box::new(Chain::uniform(count)?),
            Self::Bodies(count) => Box::new(Bodies::uniform(count)?),
        })
    }
}

/// Settings of the generated data.
#[derive(Clone, Debug, PartialEq)]
pub struct ModlanetSettings {
    /// System.
    pub system: ManyBody,
    /// Number of trajectories.
    pub trajectories: usize,
    /// Number of states in each trajectory.
    pub samples: usize,
    /// Time between states, s.
    pub h: f64,
    /// Range of the initial velocities of pendulums, ±, rad/s; not used for bodies.
    pub speed: f64,
    /// Standard deviation of the noise on positions and velocities.
    pub noise: f64,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl ModlanetSettings {
    /// The authors' settings: 101 states per trajectory, at 10 Hz for pendulums and 20 Hz for bodies; 100 trajectories
    /// for two pendulums, 200 for three bodies, and 20 for any other number of elements, to which a trained model is
    /// extended. Two pendulums start at up to ±10 rad/s, any other number at up to ±8 rad/s.
    pub fn published(system: ManyBody, seed: u64) -> Self {
        let (trajectories, h, speed) = match system {
            ManyBody::Pendulum(2) => (100, 0.1, 10.0),
            ManyBody::Pendulum(_) => (20, 0.1, 8.0),
            ManyBody::Bodies(3) => (200, 0.05, 0.0),
            ManyBody::Bodies(_) => (20, 0.05, 0.0),
        };
        Self { system, trajectories, samples: 101, h, speed, noise: 0.0, seed }
    }
}

/// The initial states of the trajectories, from one random stream.
///
/// Pendulums: θ ∈ U(0, 2π), θ̇ ∈ U(±speed). Bodies are evenly spaced on a circle of radius U(1, 5) about the origin.
/// Their velocity is √2 times that of the circular orbit, with each of its two components multiplied by its own U(0.5,
/// 1.5). (The components are along the axes, before the rotation by 2πi/n that takes the first body to the i-th.) The
/// factor √2 is the authors' (they have k/2r where [`circular_speed`] has k/4r). The direction of the first body is
/// that of a point drawn from a square, also as in the authors' program.
pub fn starts(settings: &ModlanetSettings) -> Vec<Start> {
    let mut stream = Pcg64::seed_from_u64(settings.seed);
    let one = |_| match settings.system {
        ManyBody::Pendulum(count) => pendulum_start(count, settings.speed, &mut stream),
        ManyBody::Bodies(count) => body_start(count, &mut stream),
    };
    (0..settings.trajectories).map(one).collect()
}

fn pendulum_start(count: usize, speed: f64, stream: &mut Pcg64) -> Start {
    let (q, v) = (0..count).map(|_| (TAU * unit(stream), speed * signed(stream))).unzip();
    Start { q, v }
}

fn body_start(count: usize, stream: &mut Pcg64) -> Start {
    let direction = signed(stream).atan2(signed(stream));
    let r = stream.random_range(RADII);
    let speed = SQRT_2 * circular_speed(count, r);
    let (mut q, mut v) = (Vec::new(), Vec::new());
    for i in 0..count {
        let turn = TAU * i as f64 / count as f64;
        let (s, c) = (direction + turn).sin_cos();
        q.extend([r * c, r * s]);
        let (s, c) = (direction + FRAC_PI_2).sin_cos();
        let disturbed = [c, s].map(|u| speed * u * (1.0 + DISTURBANCE * signed(stream)));
        let (s, c) = turn.sin_cos();
        v.extend([c * disturbed[0] - s * disturbed[1], s * disturbed[0] + c * disturbed[1]]);
    }
    Start { q, v }
}

fn unit(stream: &mut Pcg64) -> f64 {
    stream.random_range(0.0..1.0)
}

fn signed(stream: &mut Pcg64) -> f64 {
    stream.random_range(-1.0..1.0)
}

/// Speed (m/s) at which `count` bodies of mass 1, evenly spaced on a circle of radius `r` (m), orbit its centre for k = 1: v² = (1/4r)
/// Σ_{j=1}^{n−1} 1/sin(πj/n).
///
/// The body that is j places further along the circle is 2r sin(πj/n) away. Its attraction 1/(2r sin(πj/n))² has the
/// component sin(πj/n) towards the centre; the sum of these components is v²/r.
pub fn circular_speed(count: usize, r: f64) -> f64 {
    let sum: f64 = (1..count).map(|j| 1.0 / (PI * j as f64 / count as f64).sin()).sum();
    (sum / (4.0 * r)).sqrt()
}

/// Trajectories with positions, velocities, and the exact accelerations of the noise-free states; t = 0 at each start.
///
/// # Errors
/// [`GenerationError`] for a system without elements, and if the motion cannot be integrated.
pub fn generate_many(settings: &ModlanetSettings) -> Result<Dataset, GenerationError> {
    let motion = settings.system.motion()?;
    let ModlanetSettings { h, samples, noise, seed, .. } = *settings;
    Ok(logged(motion.as_ref(), &starts(settings), Horizon { h, samples }, noise, seed)?)
}

/// A data set by the authors' protocol, [`ModlanetSettings::published`].
///
/// # Errors
/// See [`modlanet_set_of`].
pub fn modlanet_set(system: ManyBody, seed: u64) -> Result<ModlanetSet, GenerationError> {
    modlanet_set_of(&ModlanetSettings::published(system, seed))
}

/// Training and test set: the last tenth of the trajectories, at least one, is the test set.
///
/// # Errors
/// [`GenerationError`] as for [`generate_many`], and for fewer than 2 trajectories.
pub fn modlanet_set_of(settings: &ModlanetSettings) -> Result<ModlanetSet, GenerationError> {
    let data = generate_many(settings)?;
    let motion = settings.system.motion()?;
    let count = data.trajectories.len();
    let (train, test) = data.split(count - (count / 10).max(1).min(count));
    let part = |data| ModlanetRows::from_dataset(data, |q, v| motion.energy(q, v));
    let too_few = GenerationError::TooFew(count);
    Ok(ModlanetSet { train: part(&train).ok_or(too_few)?, test: part(&test).ok_or(too_few)? })
}
