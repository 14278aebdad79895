use super::run::run_in_place;
use super::setup::CART_AND_POLE;
use super::{Setup, Start};
use crate::control::{Catch, PumpConfig, Tolerance};
use crate::devices::{Devices, EncoderConfig};
use crate::error::SetupError;
use crate::summary::{Goal, Summary};
use crate::tick::Tick;
use crate::{Mechanism, Program, Task, Timeline};
use core::f32::consts::PI;

/// A swing-up: a pendulum by a joint too weak to lift it, or a pole by the cart that carries it. Upright is θ = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SwingUpConfig<const N: usize> {
    /// Loop, devices, goal.
    pub setup: Setup<N>,
    /// Settings of the energy pump.
    pub pump: PumpConfig,
    /// Tolerances of the regulator.
    pub tolerance: Tolerance<N>,
    /// Conditions under which the regulator takes over.
    pub catch: Catch,
}

/// Largest angle from upright, rad, over the last 2 s.
const UPRIGHT: f32 = 0.1;
const HOLD: f32 = 2.0;

impl SwingUpConfig<1> {
    /// The pendulum from near hanging, 10 s in ticks of 10 ms, with at most 2 N m (lifting [`PENDULUM`] takes 4.9 N m).
    ///
    /// [`PENDULUM`]: leastaction_core::energy::trigonometric::PENDULUM
    pub const fn pendulum() -> Self {
        let devices = Devices::new([EncoderConfig::rotary()], [2.0]);
        let goal = Goal { tolerance: [UPRIGHT], hold: HOLD, bounds: [f32::INFINITY] };
        let setup = Setup::new(Start { q: [PI], q_spread: [0.5], v_spread: [0.5] }, devices, goal);
        Self {
            setup,
            pump: PumpConfig { effort: 2.0, energy_band: 0.02, rate_band: 0.3, centring: 0.0 },
            tolerance: Tolerance { q: [0.2], v: [0.6], u: 0.5 },
            catch: Catch { angle: 0.5, force: 1.5, release: 1.0 },
        }
    }
}

impl SwingUpConfig<2> {
    /// The cart-pole from near hanging, 10 s in ticks of 10 ms, with at most 10 N on the cart, on a track of ±2.4 m.
    pub const fn cartpole() -> Self {
        let devices = Devices::new(CART_AND_POLE, [10.0, 0.0]);
        let goal = Goal { tolerance: [f32::INFINITY, UPRIGHT], hold: HOLD, bounds: [2.4, f32::INFINITY] };
        let setup =
            Setup::new(Start { q: [0.0, PI], q_spread: [0.2, 0.5], v_spread: [0.05, 0.5] }, devices, goal);
        Self {
            setup,
            pump: PumpConfig { effort: 5.0, energy_band: 0.02, rate_band: 0.3, centring: 1.6 },
            tolerance: Tolerance { q: [0.3, 0.2], v: [0.6, 0.6], u: 1.2 },
            catch: Catch { angle: 0.5, force: 1.5, release: 1.0 },
        }
    }
}

impl<const N: usize> SwingUpConfig<N> {
    /// Program of the firmware.
    pub fn program(&self) -> Program<N> {
        self.setup.program(Task::SwingUp { pump: self.pump, tolerance: self.tolerance, catch: self.catch })
    }
}

/// Swings a pendulum up by its joint and holds it, by energies and derivatives of the model alone. q = θ, upright at 0.
///
/// # Errors
/// See [`Program::start`]; also a setup out of range.
pub fn swing_up_pendulum<'a, P: Mechanism<1> + 'a, M: Mechanism<1>>(
    plant: impl Into<Timeline<'a, P>>,
    model: &M,
    config: &SwingUpConfig<1>,
    sink: impl FnMut(&Tick<1>),
) -> Result<Summary<1>, SetupError> {
    config.setup.validate()?;
    run_in_place(plant, (model, config.program().start(model)?), &config.setup, [0.0], sink)
}

/// Swings a pole up by the cart that carries it and holds it, by energies and derivatives of the model alone.
/// q = (x, θ), upright at 0.
///
/// # Errors
/// See [`Program::start`]; also a setup out of range.
pub fn swing_up_cartpole<'a, P: Mechanism<2> + 'a, M: Mechanism<2>>(
    plant: impl Into<Timeline<'a, P>>,
    model: &M,
    config: &SwingUpConfig<2>,
    sink: impl FnMut(&Tick<2>),
) -> Result<Summary<2>, SetupError> {
    config.setup.validate()?;
    run_in_place(plant, (model, config.program().start(model)?), &config.setup, [0.0; 2], sink)
}
