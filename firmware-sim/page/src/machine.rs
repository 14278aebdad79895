//! The mechanisms of the page: exact plants, drives and devices, in the configurations of `leastaction simulate --scenario mpc`.

use leastaction_core::energy::trigonometric::{ACROBOT, CARTPOLE, PENDULUM, Trigonometric};
use leastaction_core::forces::{Coulomb, DryFriction, System, Viscous};
use leastaction_core::model::{ActuatorBytes, ModelError};
use leastaction_firmware_sim::devices::LearnedActuator;
use leastaction_firmware_sim::observer::LearnZeros;
use leastaction_firmware_sim::scenario::{MpcConfig, Setup};
use leastaction_firmware_sim::trajectory::reference::Friction;

/// Exact mechanism with friction.
pub type Plant<const N: usize> = System<Trigonometric<'static, N>, Friction<N>>;

/// A mechanism and the run that brings it up.
pub struct Machine<const N: usize> {
    /// Name in sentences.
    pub name: &'static str,
    /// The exact mechanism.
    pub plant: Plant<N>,
    /// Drives, devices and decisions.
    pub config: MpcConfig<N>,
}

/// A mechanism of the page by its number of coordinates.
pub enum AnyMachine {
    /// One coordinate.
    One(Machine<1>),
    /// Two coordinates.
    Two(Machine<2>),
}

impl AnyMachine {
    /// The mechanism with a number: pendulum, cart-pole, cart-pole with friction, acrobot, pendubot.
    pub fn numbered(number: u32) -> Option<Self> {
        let acrobot = MpcConfig::<2>::acrobot();
        Some(match number {
            0 => Self::One(Machine::ideal("pendulum", PENDULUM, MpcConfig::<1>::pendulum())),
            1 => Self::Two(Machine::ideal("cart-pole", CARTPOLE, MpcConfig::<2>::cartpole())),
            2 => Self::Two(Machine::dry_cartpole()),
            3 => Self::Two(Machine::ideal("acrobot", ACROBOT, acrobot)),
            4 => Self::Two(Machine::ideal("pendubot", ACROBOT, driven_at_shoulder(acrobot))),
            _ => return None,
        })
    }
}

/// The acrobot's drive at its shoulder instead.
fn driven_at_shoulder(mut acrobot: MpcConfig<2>) -> MpcConfig<2> {
    acrobot.setup.devices.actuator.limit = [8.0, 0.0];
    acrobot
}

impl<const N: usize> Machine<N> {
    fn ideal(name: &'static str, exact: Trigonometric<'static, N>, config: MpcConfig<N>) -> Self {
        let forces = (Viscous { coefficients: [0.0; N] }, dry([0.0; N]));
        Self { name, plant: System { lagrangian: exact, forces }, config }
    }
}

impl Machine<2> {
    /// The cart-pole with friction, a weak and late drive and encoder offsets, as in `firmware-sim/chip/hil.sh`.
    fn dry_cartpole() -> Self {
        let ideal = Self::ideal("cart-pole with friction", CARTPOLE, MpcConfig::<2>::cartpole());
        let Self { name, mut plant, mut config } = ideal;
        plant.forces.1 = dry([0.5, 0.0]);
        let setup = &mut config.setup;
        setup.devices.actuator.drive.gain = [0.9, 1.0];
        setup.devices.actuator.delay = (8e-3 / f64::from(setup.tick)) as f32;
        for encoder in &mut setup.devices.encoders {
            (encoder.zero, encoder.noise) = (0.02, 0.001);
        }
        setup.observer.zeros = Some(LearnZeros { deviation: 0.02, innovation: 3e-3 });
        Self { name, plant, config }
    }
}

/// Dry friction with these constants.
fn dry<const N: usize>(constants: [f32; N]) -> Coulomb<f32, N> {
    let law = |constant| DryFriction { constant, width: 0.05, ..DryFriction::none() };
    Coulomb { coordinates: constants.map(law) }
}

/// Lets the firmware know the actuator of its model's file, else the true one.
pub fn know<const N: usize>(setup: &mut Setup<N>, learned: Option<ActuatorBytes>) -> Result<(), ModelError> {
    let truth = setup.devices.actuator;
    (setup.known_drive, [setup.observer.delay, setup.observer.lag]) = match learned {
        None => (truth.drive, [truth.delay, truth.lag]),
        Some(file) => {
            let LearnedActuator { drive, delay, lag } = LearnedActuator::new(&file, setup.tick)?;
            (drive, [delay, lag])
        }
    };
    Ok(())
}
