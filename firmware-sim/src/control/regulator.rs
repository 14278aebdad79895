use super::riccati::{Linear, riccati};
use crate::Mechanism;
use crate::angle::difference;
use crate::error::{Range, SetupError, require};
use crate::wire::array;
use leastaction_core::continuous::ContinuousState;
use leastaction_core::forces::Forces;
use leastaction_core::linear::{dot, solve_many, transpose};
use nalgebra::{SMatrix, SVector};
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

    /// Weight matrix Q.
    fn weights<const D: usize>(&self) -> SMatrix<f32, D, D> {
        const { assert!(D == 2 * N, "the state has N positions and N velocities") };
        let mut tolerances = self.q.iter().chain(&self.v);
        let weights = SVector::from_fn(|_, _| tolerances.next().map_or(0.0, |x| 1.0 / (x * x)));
        SMatrix::from_diagonal(&weights)
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
    /// Designs the feedback for ticks of h seconds from the model's own second derivatives at `target`; D is 2N.
    ///
    /// # Errors
    /// Tolerances that are not positive, an input that is no coordinate, and a model that the input cannot hold at
    /// rest at `target`.
    pub fn design<M: Mechanism<N>, const D: usize>(
        model: &M,
        target: [f32; N],
        input: usize,
        tolerance: &Tolerance<N>,
        h: f32,
    ) -> Result<Self, SetupError> {
        const { assert!(D == 2 * N, "the state has N positions and N velocities") };
        tolerance.validate()?;
        let (what, range) =
            ("actuated coordinate of the regulator", Range::Words("one of the model's, from 0"));
        let no_input = SetupError::OutOfRange { what, value: input as f32, range };
        let rest = [0.0; N];
        let beside = model.system().forces.force(&target, &rest, &rest);
        let weight = model.hessian(&target, &rest).l_q;
        let bias = -(*weight.get(input).ok_or(no_input)? + beside[input]);
        let system = linearise::<M, N, D>(model, &target, input)?.sampled(h);
        let k = riccati(&system, &tolerance.weights(), 1.0 / (tolerance.u * tolerance.u))?;
        Ok(Self { target, input, bias, gain_q: part(&k, 0), gain_v: part(&k, N) })
    }

    /// Force at a state, N or N m, without limits; `angle` marks the coordinates that are angles.
    pub fn force(&self, state: &ContinuousState<f32, N>, angle: &[bool; N]) -> f32 {
        let deviation = difference(&state.q, &self.target, angle);
        self.bias - dot(&self.gain_q, &deviation) - dot(&self.gain_v, &state.v)
    }
}

/// N entries of a column of 2N, starting at `from`.
fn part<const D: usize, const N: usize>(column: &SVector<f32, D>, from: usize) -> [f32; N] {
    debug_assert!(from + N <= D, "a part of the column");
    core::array::from_fn(|i| column.get(from + i).copied().unwrap_or(f32::NAN))
}

/// Linearises the model about a rest at q₀: v̇ = M⁻¹((L_qq + Q_q)δq + Q_v v + u), exactly; L_vq vanishes with v.
fn linearise<M: Mechanism<N>, const N: usize, const D: usize>(
    model: &M,
    target: &[f32; N],
    input: usize,
) -> Result<Linear<D>, SetupError> {
    let rest = [0.0; N];
    let d = model.hessian(target, &rest);
    let (q_q, q_v) = model.damping(target, &rest);
    let stiffness: [[f32; N]; N] =
        core::array::from_fn(|i| core::array::from_fn(|j| d.l_qq[i][j] + q_q[i][j]));
    let unit = core::array::from_fn(|i| if i == input { 1.0 } else { 0.0 });
    let singular = |_| SetupError::SingularInertia;
    let columns_q = solve_many(d.l_vv, transpose(&stiffness)).map_err(singular)?;
    let columns_v = solve_many(d.l_vv, transpose(&q_v)).map_err(singular)?;
    let [column_u] = solve_many(d.l_vv, [unit]).map_err(singular)?;
    let a = SMatrix::from_fn(|i, j| match (i < N, j < N) {
        (true, _) => f32::from(u8::from(j == i + N)),
        (false, true) => columns_q[j][i - N],
        (false, false) => columns_v[j - N][i - N],
    });
    let b = SVector::from_fn(|i, _| if i < N { 0.0 } else { column_u[i - N] });
    Ok(Linear { a, b })
}
