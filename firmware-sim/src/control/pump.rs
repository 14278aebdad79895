use crate::Mechanism;
use crate::error::{SetupError, require};
use leastaction_core::continuous::ContinuousState;
use leastaction_core::discrete::StepError;
use serde::{Deserialize, Serialize};

/// Energy pumping into a swinging coordinate. Within a band the effort falls off linearly, so noise about zero does not switch it at full
/// strength.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PumpConfig {
    /// Strongest effort: N m for a joint, m/s² for a cart. Positive.
    pub effort: f32,
    /// Missing energy at which the effort is full, as a fraction of the energy between hanging and upright. Positive.
    pub energy_band: f32,
    /// Velocity at which the effort is full, rad/s. Positive.
    pub rate_band: f32,
    /// Rate ω, rad/s, of the critically damped pull that brings a cart back to the middle; unused for a joint. Not negative.
    pub centring: f32,
}

impl PumpConfig {
    pub(crate) fn validate(&self) -> Result<(), SetupError> {
        let positive =
            [("pump effort", self.effort), ("energy band", self.energy_band), ("rate band", self.rate_band)];
        for (what, x) in positive {
            require(what, x, x.is_finite() && x > 0.0, "finite and positive")?;
        }
        let centring = self.centring;
        require(
            "centring frequency",
            centring,
            centring.is_finite() && centring >= 0.0,
            "finite and not negative",
        )
    }

    /// Pumping effort between −1 and 1: with the sign of `rate` if energy is missing, against it if there is too much. A mechanism exactly
    /// at rest is pushed in the positive direction.
    fn drive(&self, missing: f32, rate: f32) -> f32 {
        let direction = if rate == 0.0 { 1.0 } else { unit(rate / self.rate_band) };
        unit(missing / self.energy_band) * direction
    }
}

/// Clamps `x` to ±1.
fn unit(x: f32) -> f32 {
    x.clamp(-1.0, 1.0)
}

/// An energy-based swing-up law, from the model's own energies.
pub trait Pump<const N: usize> {
    /// Force at an estimated state. An error if the model's inverse dynamics is singular.
    fn force<M: Mechanism<N>>(
        &self,
        model: &M,
        state: &ContinuousState<f32, N>,
    ) -> Result<[f32; N], StepError<f32>>;
}

/// Pump for mechanisms that are never brought upright; it has no values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoPump {}

impl<const N: usize> Pump<N> for NoPump {
    fn force<M: Mechanism<N>>(&self, _: &M, _: &ContinuousState<f32, N>) -> Result<[f32; N], StepError<f32>> {
        match *self {}
    }
}

/// Pump for a single joint: u = ±effort with the sign of θ̇ while energy is missing, since Ė = uθ̇.
///
/// Source: K. J. Åström and K. Furuta, "Swinging up a pendulum by energy control", Automatica 36, 2000.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointPump {
    config: PumpConfig,
    upright: f32,
    height: f32,
}

impl JointPump {
    /// Creates a pump towards the model's potential at `upright` (rad); the joint hangs half a turn away.
    pub fn new<M: Mechanism<1>>(model: &M, upright: f32, config: PumpConfig) -> Result<Self, SetupError> {
        config.validate()?;
        let potential = |theta| model.energies(&[theta], &[0.0]).potential;
        let height = positive_height(potential(upright) - potential(upright + core::f32::consts::PI))?;
        Ok(Self { config, upright: potential(upright), height })
    }
}

impl Pump<1> for JointPump {
    fn force<M: Mechanism<1>>(
        &self,
        model: &M,
        state: &ContinuousState<f32, 1>,
    ) -> Result<[f32; 1], StepError<f32>> {
        let energies = model.energies(&state.q, &state.v);
        let missing = (self.upright - energies.kinetic - energies.potential) / self.height;
        Ok([self.config.effort * self.config.drive(missing, state.v[0])])
    }
}

/// Pump for a pole, by accelerating the cart that carries it; q = (x, θ), the force acts on the cart alone.
///
/// The pole gains Ė = −M₁₂ẍθ̇ in the frame of the cart, so ẍ takes the sign of −M₁₂θ̇ while energy is missing; a critically damped pull
/// keeps the cart near the middle. The force for a wanted ẍ follows from the model's inverse dynamics with the pole left free. Sources:
/// Åström and Furuta, as above; M. W. Spong, "Partial feedback linearization of underactuated mechanical systems", IROS 1994.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CartPump {
    config: PumpConfig,
    upright: f32,
    height: f32,
}

impl CartPump {
    /// Creates a pump towards the model's potential at the angle `upright` (rad); the pole hangs half a turn away.
    pub fn new<M: Mechanism<2>>(model: &M, upright: f32, config: PumpConfig) -> Result<Self, SetupError> {
        config.validate()?;
        let potential = |theta| model.energies(&[0.0, theta], &[0.0; 2]).potential;
        let height = positive_height(potential(upright) - potential(upright + core::f32::consts::PI))?;
        Ok(Self { config, upright, height })
    }

    /// Missing energy of the pole in the frame of the cart, as a fraction of the height. Both potentials are taken at
    /// the cart's present position, because a learned potential may be a little higher or lower there than elsewhere.
    fn missing<M: Mechanism<2>>(&self, model: &M, [x, theta]: [f32; 2], theta_dot: f32) -> f32 {
        let now = model.energies(&[x, theta], &[0.0, theta_dot]);
        let upright = model.energies(&[x, self.upright], &[0.0; 2]).potential;
        (upright - now.kinetic - now.potential) / self.height
    }

    /// Wanted acceleration of the cart, m/s².
    fn acceleration<M: Mechanism<2>>(&self, model: &M, state: &ContinuousState<f32, 2>) -> f32 {
        let ([x, theta], [x_dot, theta_dot]) = (state.q, state.v);
        let [_, coupling] = model.inertial_force(&state.q, &[1.0, 0.0]);
        let [_, pole] = model.inertial_force(&state.q, &[0.0, 1.0]);
        let missing = self.missing(model, [x, theta], theta_dot);
        let swing = self.config.effort * self.config.drive(missing, -theta_dot * coupling / pole);
        let omega = self.config.centring;
        swing - omega * omega * x - 2.0 * omega * x_dot
    }
}

impl Pump<2> for CartPump {
    fn force<M: Mechanism<2>>(
        &self,
        model: &M,
        state: &ContinuousState<f32, 2>,
    ) -> Result<[f32; 2], StepError<f32>> {
        let x_ddot = self.acceleration(model, state);
        let [_, on_pole] = model.inverse_dynamics(&state.q, &state.v, &[x_ddot, 0.0])?;
        let [_, pole] = model.inertial_force(&state.q, &[0.0, 1.0]);
        let [force, _] = model.inverse_dynamics(&state.q, &state.v, &[x_ddot, -on_pole / pole])?;
        Ok([force, 0.0])
    }
}

/// Checks the energy difference between upright and hanging, which must be positive.
fn positive_height(height: f32) -> Result<f32, SetupError> {
    let sensible = height.is_finite() && height > 0.0;
    require(
        "potential of the model, upright minus hanging",
        height,
        sensible,
        "positive, J: is upright at q = 0?",
    )?;
    Ok(height)
}
