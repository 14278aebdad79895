//! Simulation of a robot, log by log.

use super::linkage::Terms;
use super::settings::{RobotError, RobotSettings};
use super::{RobotLog, Sines};
use leastaction_core::continuous::{ContinuousState, acceleration, rk4_step};
use leastaction_core::energy::trigonometric::Trigonometric;
use leastaction_core::forces::{Coulomb, DryFriction, System, Viscous};
use leastaction_data::Rows;
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// Longest integration step, s.
const LONGEST: f64 = 2.5e-4;
/// Longest integration step relative to the time constant of friction.
const STIFFEST: f64 = 0.1;

/// Purpose of random numbers; each has its own stream.
#[derive(Clone, Copy)]
enum Purpose {
    Start,
    Control,
    Zeros,
    Noise,
    Jitter,
    Drive,
}

/// Random streams of one log.
#[derive(Clone, Copy)]
struct Streams {
    seed: u64,
    log: usize,
}

impl Streams {
    fn of(self, purpose: Purpose) -> Pcg64 {
        Pcg64::new(u128::from(self.seed), ((self.log as u128) << 3) | purpose as u128)
    }
}

/// A robot that is started anew for every log.
pub(super) struct Robot<'a, const N: usize> {
    settings: &'a RobotSettings,
    system: System<Trigonometric<'a, N>, (Viscous<f64, N>, Coulomb<f64, N>)>,
    gain: [f64; N],
    /// Integration step, s.
    fine: f64,
}

impl<'a, const N: usize> Robot<'a, N> {
    pub(super) fn new(settings: &'a RobotSettings, terms: &'a Terms<N>) -> Result<Self, RobotError> {
        let friction =
            |of: fn(&super::JointFriction) -> f64| std::array::from_fn(|i| of(&settings.friction[i]));
        let (constants, widths): ([f64; N], [f64; N]) = (friction(|f| f.coulomb), friction(|f| f.width));
        let coordinates = std::array::from_fn(|i| DryFriction {
            constant: constants[i],
            width: widths[i],
            ..DryFriction::none()
        });
        let viscous = Viscous { coefficients: friction(|f| f.viscous) };
        let (lagrangian, gain) = (terms.lagrangian(), std::array::from_fn(|i| settings.drives.gain[i]));
        let system = System { lagrangian, forces: (viscous, Coulomb { coordinates }) };
        let mut robot = Self { settings, system, gain, fine: LONGEST };
        robot.fine = LONGEST.min(STIFFEST / robot.stiffness()?);
        Ok(robot)
    }

    /// The fastest rate at which friction stops a coordinate in the hanging position, 1/s.
    fn stiffness(&self) -> Result<f64, RobotError> {
        let hanging = self.settings.machine.hanging();
        let mass = self.system.lagrangian.mass_matrix(&std::array::from_fn(|i| hanging[i]));
        let dry = self.system.forces.1.stiffness(2.0, mass, &[0.0; N]);
        let dry = dry.map_err(|_| RobotError::Diverged { log: 0, t: 0.0 })?;
        let viscous = self.system.forces.0.coefficients;
        let rates = (0..N).map(|i| dry[i] + viscous[i] / mass[i][i]);
        Ok(rates.fold(f64::MIN_POSITIVE, f64::max))
    }

    /// Simulates one log, independently of the others.
    pub(super) fn log(&self, id: usize) -> Result<RobotLog, RobotError> {
        let streams = Streams { seed: self.settings.seed, log: id };
        let times = self.times(&mut streams.of(Purpose::Jitter));
        let commands = self.commands(&times, &mut streams.of(Purpose::Control));
        let driven = self.driven(&commands, &mut streams.of(Purpose::Drive));
        let mut motion = Motion { robot: self, times: &times, driven: &driven, ..self.rest(streams) };
        let (mut q, mut v, mut a, mut torques) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for t in &times {
            let diverged = RobotError::Diverged { log: id, t: *t };
            a.push(motion.advance(*t).ok_or(diverged)?);
            q.push(motion.state.q);
            v.push(motion.state.v);
            torques.push(motion.torque);
        }
        let zeros = self.zeros(&mut streams.of(Purpose::Zeros));
        let readings = self.readings(&q, &zeros, &mut streams.of(Purpose::Noise));
        let [readings, commands, torques, q, v, a] =
            [&readings, &commands, &torques, &q, &v, &a].map(|rows| Rows::from_arrays(rows));
        Ok(RobotLog { id: id as i64, times, readings, commands, torques, q, v, a, zeros: zeros.to_vec() })
    }

    /// Sampling instants, s; the first is 0.
    fn times(&self, stream: &mut Pcg64) -> Vec<f64> {
        let RobotSettings { h, samples, sensors, .. } = self.settings;
        let late =
            |k: usize| if k == 0 { 0.0 } else { sensors.jitter * (2.0 * stream.random::<f64>() - 1.0) };
        (0..*samples).map(late).enumerate().map(|(k, late)| k as f64 * h + late).collect()
    }

    fn commands(&self, times: &[f64], stream: &mut Pcg64) -> Vec<[f64; N]> {
        let RobotSettings { excitation, drives, .. } = self.settings;
        let sines: [Sines; N] = std::array::from_fn(|_| Sines::draw(excitation, stream));
        let at = |t: &f64| std::array::from_fn(|i| if drives.driven[i] { sines[i].at(*t) } else { 0.0 });
        times.iter().map(at).collect()
    }

    /// Torques of the drives under the commands.
    fn driven(&self, commands: &[[f64; N]], stream: &mut Pcg64) -> Vec<[f64; N]> {
        let drives = &self.settings.drives;
        let mut noise = |i: usize| if drives.driven[i] { drives.noise * normal(stream) } else { 0.0 };
        commands.iter().map(|u| std::array::from_fn(|i| self.gain[i] * u[i] + noise(i))).collect()
    }

    /// The start of a motion, near rest in the hanging position.
    fn rest(&self, streams: Streams) -> Motion<'_, N> {
        let (spread, hanging) = (self.settings.start, self.settings.machine.hanging());
        let mut stream = streams.of(Purpose::Start);
        let mut within = |limit: f64| limit * (2.0 * stream.random::<f64>() - 1.0);
        let q = std::array::from_fn(|i| hanging[i] + within(spread.q));
        let state = ContinuousState { q, v: std::array::from_fn(|_| within(spread.v)) };
        Motion { robot: self, times: &[], driven: &[], state, torque: [0.0; N], t: 0.0, arrived: 0 }
    }

    fn zeros(&self, stream: &mut Pcg64) -> [f64; N] {
        std::array::from_fn(|_| self.settings.sensors.zeros * normal(stream))
    }

    fn readings(&self, q: &[[f64; N]], zeros: &[f64; N], stream: &mut Pcg64) -> Vec<[f64; N]> {
        let (noise, grid) = (self.settings.sensors.noise, self.settings.sensors.grid);
        let on_grid = |x: f64| if grid > 0.0 { (x / grid).round() * grid } else { x };
        let mut read = |q: f64, zero: f64| on_grid(q + zero + noise * normal(stream));
        q.iter().map(|q| std::array::from_fn(|i| read(q[i], zeros[i]))).collect()
    }
}

fn normal(stream: &mut Pcg64) -> f64 {
    StandardNormal.sample(stream)
}

/// A robot under the torques of one log.
struct Motion<'r, const N: usize> {
    robot: &'r Robot<'r, N>,
    /// Times of the commands, s.
    times: &'r [f64],
    /// Torques of the drives, of which each acts from its command's arrival on.
    driven: &'r [[f64; N]],
    state: ContinuousState<f64, N>,
    /// Current torque τ.
    torque: [f64; N],
    /// Current time, s.
    t: f64,
    /// Number of commands that have taken effect.
    arrived: usize,
}

impl<const N: usize> Motion<'_, N> {
    /// Advances to a time, from the arrival of one command to that of the next; returns v̇ at this time.
    fn advance(&mut self, t: f64) -> Option<[f64; N]> {
        let delay = self.robot.settings.drives.delay;
        while let (Some(given), Some(torque)) = (self.times.get(self.arrived), self.driven.get(self.arrived))
        {
            let arrival = given + delay;
            if arrival > t {
                break;
            }
            self.coast(arrival)?;
            self.torque = *torque;
            self.arrived += 1;
        }
        self.coast(t)?;
        acceleration(&self.robot.system, &self.state.q, &self.state.v, &self.torque).ok()
    }

    /// Advances under the current torque.
    fn coast(&mut self, to: f64) -> Option<()> {
        let steps = ((to - self.t) / self.robot.fine).ceil();
        for _ in 0..steps as usize {
            let h = (to - self.t) / steps;
            self.state = rk4_step(&self.robot.system, &self.state, &self.torque, h).ok()?;
        }
        self.t = to;
        Some(())
    }
}
