use crate::Mechanism;
use crate::angle::difference;
use crate::error::{Range, SetupError, require};
use crate::observer::{Integrator, Order};
use crate::wire::array;
use leastaction_core::continuous::ContinuousState;
use leastaction_core::control::riccati::{Weights, stationary};
use leastaction_core::control::{Stepped, Transition};
use leastaction_core::discrete::{Del, Galerkin, Midpoint, Path, StepError};
use leastaction_core::forces::Actuator;
use leastaction_core::linear::dot;
use serde::{Deserialize, Serialize};

/// Tolerances: deviations of equal cost to the regulator (Bryson's rule); each weight is the inverse square of its tolerance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tolerance<const N: usize> {
    /// Tolerance of positions, rad or m, > 0.
    #[serde(with = "array")]
    pub q: [f32; N],
    /// Tolerance of velocities, rad/s or m/s, > 0.
    #[serde(with = "array")]
    pub v: [f32; N],
    /// Tolerance of the force, N or N m, > 0.
    pub u: f32,
}

impl<const N: usize> Tolerance<N> {
    pub(crate) fn validate(&self) -> Result<(), SetupError> {
        for x in self.q.iter().chain(&self.v).chain([&self.u]) {
            require("regulator tolerance", *x, x.is_finite() && *x > 0.0, "finite and positive")?;
        }
        Ok(())
    }

    /// Weights of the state and of the force.
    fn weights<const D: usize>(&self) -> Weights<f32, D, 1> {
        let weight = |x: f32| 1.0 / (x * x);
        Weights { x: joined(&self.q, &self.v).map(weight), u: [weight(self.u)] }
    }
}

/// Linear-quadratic feedback about an equilibrium, through one coordinate's actuator: u = u₀ − K_q(q − q₀) − K_v v.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Regulator<const N: usize> {
    /// Equilibrium position q₀.
    pub target: [f32; N],
    /// Index of the actuated coordinate.
    pub input: usize,
    /// Bias u₀, the force at which the model stands still at q₀.
    pub bias: f32,
    /// Position gains K_q.
    pub gain_q: [f32; N],
    /// Velocity gains K_v.
    pub gain_v: [f32; N],
}

impl<const N: usize> Regulator<N> {
    /// Designs the feedback from the derivatives of the very step that the firmware takes; D is 2N.
    ///
    /// # Errors
    /// Tolerances that are not positive and an input that is no coordinate ([`SetupError::OutOfRange`]);
    /// [`SetupError::SingularInertia`]; [`SetupError::NotStabilisable`] if the input cannot hold the model at rest at `target`.
    pub fn design<M: Mechanism<N>, const D: usize>(
        model: &M,
        target: [f32; N],
        input: usize,
        tolerance: &Tolerance<N>,
        step: &Integrator<f32>,
    ) -> Result<Self, SetupError> {
        tolerance.validate()?;
        let (what, range) =
            ("actuated coordinate of the regulator", Range::Words("one of the model's, from 0"));
        let no_input = SetupError::OutOfRange { what, value: input as f32, range };
        let rest = [0.0; N];
        model.velocity(&target, &rest).map_err(|_| SetupError::SingularInertia)?;
        let held = model.inverse_dynamics(&target, &rest, &rest).map_err(|_| SetupError::NotStabilisable)?;
        let bias = *held.get(input).ok_or(no_input)?;
        let tick = linearise::<M, N, D>(model, step, &target, (input, bias));
        let regulator = stationary(&tick.map_err(|_| SetupError::NotStabilisable)?, &tolerance.weights());
        let [gain] = regulator.map_err(|_| SetupError::NotStabilisable)?.gain;
        Ok(Self { target, input, bias, gain_q: part(&gain, 0), gain_v: part(&gain, N) })
    }

    /// Force at a state, N or N m, without limits; `angle` marks the coordinates that are angles.
    pub fn force(&self, state: &ContinuousState<f32, N>, angle: &[bool; N]) -> f32 {
        let deviation = difference(&state.q, &self.target, angle);
        self.bias - dot(&self.gain_q, &deviation) - dot(&self.gain_v, &state.v)
    }
}

/// Linearises the tick that begins at rest at a position, under the force of one coordinate that holds it there.
fn linearise<M: Mechanism<N>, const N: usize, const D: usize>(
    model: &M,
    step: &Integrator<f32>,
    at: &[f32; N],
    force: (usize, f32),
) -> Result<Transition<f32, D, 1>, StepError<f32>> {
    match step.order() {
        Order::Two => linearise_by(model, Del::<f32, Midpoint>::new(step.h()), at, force),
        Order::Four => linearise_by(model, Del::<f32, Galerkin>::new(step.h()), at, force),
    }
}

fn linearise_by<M: Mechanism<N>, P: Path, const N: usize, const D: usize>(
    model: &M,
    del: Del<f32, P>,
    at: &[f32; N],
    (input, force): (usize, f32),
) -> Result<Transition<f32, D, 1>, StepError<f32>> {
    let system = model.system();
    Stepped { system, del, actuator: Actuator::ideal(), inputs: [input], stride: 1 }
        .linearise_rest(at, (1, &[force]))
}

/// Joins positions and velocities to a state.
pub(super) fn joined<T: Copy, const N: usize, const D: usize>(q: &[T; N], v: &[T; N]) -> [T; D] {
    const { assert!(D == 2 * N, "the state has N positions and N velocities") };
    core::array::from_fn(|i| if i < N { q[i] } else { v[i - N] })
}

/// N numbers of a state, starting at `from`.
fn part<const D: usize, const N: usize>(state: &[f32; D], from: usize) -> [f32; N] {
    debug_assert!(from + N <= D, "a part of the state");
    core::array::from_fn(|i| state.get(from + i).copied().unwrap_or(f32::NAN))
}
