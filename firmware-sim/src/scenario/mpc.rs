use super::run::run_in_place;
use super::setup::CART_AND_POLE;
use super::{Setup, Start};
use crate::control::{Coordinates, MpcSettings, States, Tolerance, blank_nodes};
use crate::devices::{Devices, EncoderConfig};
use crate::error::SetupError;
use crate::summary::{Goal, Summary};
use crate::tick::{Mode, Tick};
use crate::{Mechanism, Program, Task};
use core::f32::consts::PI;
use leastaction_core::plan::Plan;

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

/// Settings for a goal of zeros: nodes of `ticks` ticks in a step, 2 iterations, commands at random in every decision.
const fn settings<const N: usize>(ticks: u16) -> MpcSettings<N> {
    MpcSettings {
        goal: [0.0; N],
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
        Self { setup, settings: settings(3) }
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
        Self { setup, settings: settings(2) }
    }
}

impl<const N: usize> MpcConfig<N> {
    /// The configuration with another tick, s: nodes last about as long, in one step each.
    #[must_use]
    pub fn with_tick(mut self, tick: f32) -> Self {
        let ticks = libm::roundf(f32::from(self.settings.ticks) * self.setup.tick / tick);
        // A cast saturates; a tick out of range is refused with the setup.
        self.settings.ticks = (ticks as u16).max(1);
        (self.setup.tick, self.settings.stride) = (tick, self.settings.ticks);
        self
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

/// Brings a mechanism to a posture and holds it there by decisions over a receding horizon, which may take the plan; D is 2N.
///
/// # Errors
/// See [`Program::mpc`]; also a setup out of range.
pub fn mpc<P: Mechanism<N>, M: Mechanism<N>, const N: usize, const D: usize>(
    plant: &P,
    model: &M,
    plan: Option<&Plan<N, N>>,
    config: &MpcConfig<N>,
    mut sink: impl FnMut(&Tick<N>),
) -> Result<(Summary<N>, Decided), SetupError>
where
    Coordinates<N>: States<D>,
{
    config.setup.validate()?;
    let mut nodes = blank_nodes();
    let firmware = config.program().mpc(model, plan, &mut nodes)?;
    let mut decided = Decided::default();
    let summary = run_in_place(plant, firmware, &config.setup, config.settings.goal, |tick| {
        decided.update(tick);
        sink(tick);
    })?;
    Ok((summary, decided))
}
