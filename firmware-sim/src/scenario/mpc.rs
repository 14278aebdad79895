use super::follow::{SPREAD, limits};
use super::run::run_in_place;
use super::setup::CART_AND_POLE;
use super::{Setup, Start};
use crate::control::{Coordinates, MpcSettings, States, Tolerance, blank_nodes};
use crate::devices::{Devices, Drive, EncoderConfig};
use crate::error::SetupError;
use crate::summary::{Goal, Summary};
use crate::tick::{Mode, Tick};
use crate::{Mechanism, Program, Task, Timeline};
use core::f32::consts::PI;
use leastaction_core::model::TrainedStep;
use leastaction_core::plan::Plan;
use leastaction_core::scalar::max_abs;

/// A mechanism that is brought to a posture and held there by decisions at every tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MpcConfig<const N: usize> {
    /// Loop, devices, goal.
    pub setup: Setup<N>,
    /// Settings of the decisions.
    pub settings: MpcSettings<N>,
}

/// Tick, s.
const TICK: f32 = 0.02;
/// Largest angle from upright, rad, over the last 2 s.
const UPRIGHT: f32 = 0.1;
const HOLD: f32 = 2.0;

/// Length of a node of a mechanism that is not known further, s: 25 of them are 2.5 s.
const NODE: f32 = 0.1;
/// Tolerance of forces, as a part of the largest limit.
const EFFORT: f32 = 0.4;

/// Settings for a goal: nodes of `ticks` ticks in a step, 2 iterations, commands at random in every decision.
const fn settings<const N: usize>(goal: [f32; N], ticks: u16) -> MpcSettings<N> {
    MpcSettings {
        goal,
        tolerance: Tolerance { q: [1.0; N], v: [3.0; N], u: 3.0 },
        ticks,
        stride: ticks,
        iterations: 2,
        trials: 12,
        sample_every: 1,
        piece: 6,
        drag: 1.0,
        plan: None,
    }
}

impl MpcConfig<1> {
    /// The pendulum from near hanging, 10 s in ticks of 20 ms, with at most 2 N m (lifting [`PENDULUM`] takes 4.9 N m).
    ///
    /// [`PENDULUM`]: leastaction_core::energy::trigonometric::PENDULUM
    pub const fn pendulum() -> Self {
        let devices = Devices::new([EncoderConfig::rotary()], [2.0]);
        let goal = Goal { tolerance: [UPRIGHT], hold: HOLD, bounds: [f32::INFINITY] };
        let start = Start { q: [PI], q_spread: [0.5], v_spread: [0.5] };
        let mut setup = Setup::new(start, devices, goal);
        setup.tick = TICK;
        Self { setup, settings: settings([0.0], 3) }
    }
}

impl MpcConfig<2> {
    /// The cart-pole from near hanging, 10 s in ticks of 20 ms, with at most 10 N on the cart, on a track of ±2.4 m.
    pub const fn cartpole() -> Self {
        let devices = Devices::new(CART_AND_POLE, [10.0, 0.0]);
        let goal = Goal { tolerance: [f32::INFINITY, UPRIGHT], hold: HOLD, bounds: [2.4, f32::INFINITY] };
        let start = Start { q: [0.0, PI], q_spread: [0.2, 0.5], v_spread: [0.05, 0.5] };
        let mut setup = Setup::new(start, devices, goal);
        setup.tick = TICK;
        Self { setup, settings: settings([0.0; 2], 2) }
    }

    /// The acrobot from near hanging, q = 0, to upright, q = (π, 0): 10 s in ticks of 20 ms, with at most 8 N m at the elbow (lifting the outer
    /// link of [`ACROBOT`] takes 4.9 N m).
    ///
    /// [`ACROBOT`]: leastaction_core::energy::trigonometric::ACROBOT
    pub const fn acrobot() -> Self {
        let devices = Devices::new([EncoderConfig::rotary(); 2], [0.0, 8.0]);
        let goal = Goal { tolerance: [UPRIGHT; 2], hold: HOLD, bounds: [f32::INFINITY; 2] };
        let start = Start { q: [0.0; 2], q_spread: [0.5; 2], v_spread: [0.5; 2] };
        let mut setup = Setup::new(start, devices, goal);
        setup.tick = TICK;
        Self { setup, settings: settings([PI, 0.0], 5) }
    }
}

impl<const N: usize> MpcConfig<N> {
    /// Creates a run of 10 s in ticks of 20 ms from near a posture to a goal posture, which must be held within 0.1 rad or m over the last 2 s:
    /// motions of 2.5 s, forces of a tolerance of .4 of the largest limit (N or N m; 0 for a coordinate that is not driven).
    pub fn new(from: [f32; N], goal: [f32; N], encoders: [EncoderConfig; N], limit: [f32; N]) -> Self {
        let start = Start { q_spread: [SPREAD; N], ..Start::at_rest(from) };
        let held = Goal { tolerance: [UPRIGHT; N], hold: HOLD, bounds: [f32::INFINITY; N] };
        let mut setup = Setup::new(start, Devices::new(encoders, limit), held);
        setup.tick = TICK;
        let mut settings = settings(goal, libm::roundf(NODE / TICK) as u16);
        settings.tolerance.u = EFFORT * max_abs(&limit);
        Self { setup, settings }
    }

    /// The configuration with plans that decisions may take, and their `drive`: goal, limits and tick are those of the first one.
    #[must_use]
    pub fn with_plans(self, plan: &Plan<N, N>, drive: Drive<N>) -> Self {
        let header = plan.file().header();
        let mut along = self.with_tick(header.h);
        along.setup.devices.actuator.limit = limits(header);
        (along.settings.goal, along.settings.plan) = (plan.reference(u32::MAX).q, Some(drive));
        along
    }

    /// The configuration with another tick, s: nodes last about as long, in one step each.
    #[must_use]
    pub fn with_tick(mut self, tick: f32) -> Self {
        let ticks = libm::roundf(f32::from(self.settings.ticks) * self.setup.tick / tick);
        // A cast saturates; a tick out of range is refused with the setup.
        self.settings.ticks = (ticks as u16).max(1);
        (self.setup.tick, self.settings.stride) = (tick, self.settings.ticks);
        self
    }

    /// The configuration for a model that learned its own step, if it did: ticks of that step and order, each stepped alone.
    #[must_use]
    pub fn with_trained(self, trained: Option<TrainedStep>) -> Self {
        let Some(TrainedStep { order, h, .. }) = trained else { return self };
        let mut own = self.with_tick(h);
        (own.settings.stride, own.setup.observer.order) = (1, order);
        own
    }

    /// Program of the firmware.
    pub fn program(&self) -> Program<N> {
        self.setup.program(Task::Mpc(self.settings))
    }
}

/// Counts of the ticks of a run by the way in which their command was found; those in [`Mode::Safe`] are in the summary.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Decided {
    /// Decisions.
    pub decided: u32,
    /// Commands of the last motion, where no motion could be computed.
    pub followed: u32,
    /// Commands against gravity, where there was no last motion either.
    pub floated: u32,
}

impl Decided {
    /// Takes in a tick.
    pub fn update<const N: usize>(&mut self, tick: &Tick<N>) {
        if tick.missed {
            return;
        }
        match tick.mode {
            Mode::Mpc => self.decided += 1,
            Mode::Track => self.followed += 1,
            Mode::Float => self.floated += 1,
            _ => {}
        }
    }
}

/// Brings a mechanism to a posture and holds it there by decisions over a receding horizon, which may take the plans; D is 2N.
///
/// # Errors
/// See [`Program::mpc`]; also a setup out of range.
pub fn mpc<'a, P: Mechanism<N> + 'a, M: Mechanism<N>, const N: usize, const D: usize>(
    plant: impl Into<Timeline<'a, P>>,
    model: &M,
    plans: &[Plan<N, N>],
    config: &MpcConfig<N>,
    mut sink: impl FnMut(&Tick<N>),
) -> Result<(Summary<N>, Decided), SetupError>
where
    Coordinates<N>: States<D>,
{
    config.setup.validate()?;
    let mut nodes = blank_nodes();
    let firmware = config.program().mpc(model, plans, &mut nodes)?;
    let mut decided = Decided::default();
    let summary = run_in_place(plant, (model, firmware), &config.setup, config.settings.goal, |tick| {
        decided.update(tick);
        sink(tick);
    })?;
    Ok((summary, decided))
}
