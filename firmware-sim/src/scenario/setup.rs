use crate::devices::{ActuatorConfig, Device, Devices, Drive, EncoderConfig, Stream};
use crate::error::{SetupError, require, require_finite};
use crate::observer::ObserverConfig;
use crate::summary::Goal;
use crate::{Program, Task};
use leastaction_core::continuous::ContinuousState;

/// Longest run, ticks: beyond it, f32 no longer distinguishes the times of successive ticks.
const MAX_TICKS: f32 = 16_777_216.0;

/// Start of a run: each component uniform in centre ± spread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start<const N: usize> {
    /// Centre of the position, rad or m.
    pub q: [f32; N],
    /// Spread of the position, rad or m.
    pub q_spread: [f32; N],
    /// Spread of the velocity about rest, rad/s or m/s.
    pub v_spread: [f32; N],
}

impl<const N: usize> Start<N> {
    /// Start at rest at a position.
    pub const fn at_rest(q: [f32; N]) -> Self {
        Self { q, q_spread: [0.0; N], v_spread: [0.0; N] }
    }

    /// Draws the initial state that belongs to a seed.
    pub fn draw(&self, seed: u64) -> ContinuousState<f32, N> {
        let mut stream = Stream::new(seed, Device::Start);
        let q = core::array::from_fn(|i| self.q[i] + self.q_spread[i] * stream.symmetric());
        ContinuousState { q, v: self.v_spread.map(|spread| spread * stream.symmetric()) }
    }

    fn validate(&self) -> Result<(), SetupError> {
        for x in self.q.iter().chain(&self.q_spread).chain(&self.v_spread) {
            require("start", *x, x.is_finite(), "finite")?;
        }
        Ok(())
    }
}

/// Forces that push the mechanism for a while, unknown to the firmware.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Push<const N: usize> {
    /// Beginning, s.
    pub begin: f32,
    /// End, s.
    pub end: f32,
    /// Bound of each force, which is uniform within ± this, N or N m.
    pub most: [f32; N],
}

impl<const N: usize> Push<N> {
    /// No push.
    pub const fn none() -> Self {
        Self { begin: 0.0, end: 0.0, most: [0.0; N] }
    }

    /// Draws the forces that belong to a seed.
    pub fn draw(&self, seed: u64) -> [f32; N] {
        let mut stream = Stream::new(seed, Device::Push);
        self.most.map(|most| most * stream.symmetric())
    }

    /// Whether the push acts over the tick that begins at time t, s.
    pub(super) fn acts(&self, t: f32) -> bool {
        (self.begin..self.end).contains(&t)
    }

    fn validate(&self) -> Result<(), SetupError> {
        require_finite("push", &[self.begin, self.end])?;
        require_finite("push", &self.most)
    }
}

/// Settings that all scenarios share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup<const N: usize> {
    /// Seed of all random numbers.
    pub seed: u64,
    /// The tick h > 0, s.
    pub tick: f32,
    /// Length of the run, s; at least one tick.
    pub seconds: f32,
    /// Number of integration steps of the plant in a tick, at least 1.
    pub substeps: u16,
    /// The initial state.
    pub start: Start<N>,
    /// Encoders, actuators and clock.
    pub devices: Devices<N>,
    /// Disturbance of the mechanism.
    pub push: Push<N>,
    /// Whether brakes hold the mechanism until the first command takes effect.
    pub brakes: bool,
    /// Gain and offset of the actuators that the firmware assumes.
    pub known_drive: Drive<N>,
    /// Configuration of the model's steps and of the state estimate.
    pub observer: ObserverConfig,
    /// Goal of the run.
    pub goal: Goal<N>,
}

impl<const N: usize> Setup<N> {
    /// Creates a run of 10 s in ticks of 10 ms from `start`, undisturbed, without brakes; the firmware assumes gain 1 and offset 0 of the
    /// actuators.
    pub const fn new(start: Start<N>, devices: Devices<N>, goal: Goal<N>) -> Self {
        Self {
            seed: 0,
            tick: 0.01,
            seconds: 10.0,
            substeps: 8,
            start,
            devices,
            push: Push::none(),
            brakes: false,
            known_drive: Drive::ideal(),
            observer: ObserverConfig::new(),
            goal,
        }
    }

    /// Number of ticks of the run.
    pub fn ticks(&self) -> u32 {
        libm::roundf(self.seconds / self.tick) as u32
    }

    /// The run with ideal devices, and a firmware that knows of no delay.
    #[must_use]
    pub fn perfect(self) -> Self {
        let observer = ObserverConfig { delay: 0.0, lag: 0.0, ..self.observer };
        Self { devices: self.devices.perfect(), observer, ..self }
    }

    /// Program that the firmware gets for a task.
    pub(super) fn program(&self, task: Task<N>) -> Program<N> {
        let Self { tick, devices, known_drive: drive, observer, .. } = *self;
        let actuator = ActuatorConfig { drive, ..devices.actuator };
        Program { tick, angle: devices.angles(), actuator, observer, task }
    }

    /// Checks that every number is in its range.
    ///
    /// # Errors
    /// The first number that is out of range.
    pub fn validate(&self) -> Result<(), SetupError> {
        require("tick", self.tick, self.tick.is_finite() && self.tick > 0.0, "finite and positive, s")?;
        let ticks = self.seconds / self.tick;
        let sensible = (1.0..=MAX_TICKS).contains(&ticks);
        require("length of the run", self.seconds, sensible, "from 1 to 16,777,216 ticks, in s")?;
        require("plant substeps", f32::from(self.substeps), self.substeps > 0, "at least 1")?;
        self.start.validate()?;
        self.devices.validate()?;
        self.push.validate()?;
        self.observer.validate()?;
        self.goal.validate()
    }
}

/// The encoders of a cart and a pole.
pub(super) const CART_AND_POLE: [EncoderConfig; 2] = [EncoderConfig::linear(), EncoderConfig::rotary()];
