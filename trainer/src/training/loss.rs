//! The losses, sample by sample: a residual of n components, and each component's derivative in the weights as a short
//! sum of derivatives of the Lagrangian.
//!
//! By the chain rule through an implicit step the derivative of every residual component in θ is
//! Σ ∂/∂θ [F(q, v)·δq + L_v(q, v)·δv] over the Gauss points of the intervals involved, with F = L_q + Q; the implicit
//! function theorem only chooses the δq and δv. That of an acceleration is ∂/∂θ (F − d/dt L_v)·y. Two kernels in core do the
//! rest.

use super::residuals::Failed;
use super::samples::Sample;
use crate::architecture::{Family, FamilySystem};
use leastaction_core::discrete::StepError;
use leastaction_core::forces::{Forces, System};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::linear::{Matrix, SolveError, add_scaled, dot, multiply, solve, solve_many, transpose};
use leastaction_core::scalar::{LANES, Lanes, Scalar};
use serde::{Deserialize, Serialize};

/// What is minimised. The discrete losses are those of the DEL integrator, and on rods those of RATTLE.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LossKind {
    /// The residual of the three-point DEL equation at logged positions (SyMo), in units of momentum.
    DelResidual,
    /// The next position that the implicit step gives (E2E-SyMo), by the implicit function theorem.
    NextPosition,
    /// The acceleration at logged positions and velocities.
    Acceleration,
    /// Position and velocity after an explicit Runge–Kutta step from logged ones (L-NODE); without rods.
    NextState,
}

impl LossKind {
    /// Whether it is one of the DEL integrator: positions and controls suffice.
    pub fn is_discrete(self) -> bool {
        matches!(self, Self::DelResidual | Self::NextPosition)
    }
}

/// A residual component's derivative in the weights: ∂/∂θ [(F − d/dt L_v)·y] at an acceleration.
#[derive(Clone, Copy, Debug)]
pub(super) struct Term<const N: usize> {
    /// Position.
    pub q: [f64; N],
    /// Velocity.
    pub v: [f64; N],
    /// Weight of F − d/dt L_v.
    pub y: [f64; N],
    /// The acceleration.
    pub a: [f64; N],
}

impl From<StepError<f64>> for Failed {
    fn from(_: StepError<f64>) -> Self {
        Self
    }
}

impl From<SolveError> for Failed {
    fn from(_: SolveError) -> Self {
        Self
    }
}

/// Eight samples.
pub(super) type Group<const N: usize> = [Sample<N>; LANES];

/// A model over its weights, for one sample and for eight.
pub(super) struct Systems<'w, F: Family<N>, const N: usize> {
    /// The shape.
    pub family: &'w F,
    /// Eight side by side.
    pub eight: FamilySystem<'w, F, Lanes, N>,
}

impl<'w, F: Family<N>, const N: usize> Systems<'w, F, N> {
    /// Reads the shape; once for many samples.
    pub fn new(family: &'w F, weights: &'w [f64]) -> Result<Self, Failed> {
        Ok(Self { family, eight: family.system::<Lanes>(weights).map_err(|_| Failed)? })
    }
}

/// The residual components of a sample.
pub(super) trait Components: Copy {
    /// How many.
    const COUNT: usize;
    /// In order.
    fn as_slice(&self) -> &[f64];
}

impl<const N: usize> Components for [f64; N] {
    const COUNT: usize = N;

    fn as_slice(&self) -> &[f64] {
        self
    }
}

/// A loss over eight samples side by side, with the bits that each has alone.
pub(super) trait GroupLoss<F: Family<N>, const N: usize>: Sync {
    /// Of a sample.
    type Residual: Components;
    /// The residuals.
    fn residuals(&self, systems: &Systems<F, N>, group: &Group<N>)
    -> Result<[Self::Residual; LANES], Failed>;
    /// The residuals, and for every sample and component its term: `terms[sample][component]`.
    fn linearise_group(
        &self,
        systems: &Systems<F, N>,
        group: &Group<N>,
        terms: &mut [Vec<Term<N>>; LANES],
    ) -> Result<[Self::Residual; LANES], Failed>;
}

/// v̇(q, v, u) − a.
pub(super) struct AccelerationLoss;

/// M v̇ = f + Aᵀλ, A v̇ = −Ȧv.
struct Equation<const N: usize> {
    mass: [[f64; N]; N],
    force: [f64; N],
    /// Rows of A, and Ȧv.
    constraints: Vec<([f64; N], f64)>,
}

/// What solves it: v̇, and how it moves with f.
struct Solution<const N: usize> {
    acceleration: [f64; N],
    /// Π = M⁻¹ − M⁻¹Aᵀ(A M⁻¹Aᵀ)⁻¹A M⁻¹, symmetric; M⁻¹ without constraints.
    compliance: [[f64; N]; N],
}

impl<const N: usize> Equation<N> {
    fn acceleration(self, definite: bool) -> Result<[f64; N], Failed> {
        if self.constraints.is_empty() {
            return Ok(solve(self.mass, self.force)?);
        }
        Ok(self.solution(definite)?.acceleration)
    }

    /// One constraint after the other, as if the rest were not there: each takes its own direction out of Π.
    fn solution(self, definite: bool) -> Result<Solution<N>, Failed> {
        let mut compliance = solve_many(transpose(&self.mass), identity())?;
        let mut acceleration = solve(self.mass, self.force)?;
        for (row, bend) in &self.constraints {
            let missing = -(dot(row, &acceleration) + bend);
            acceleration = add_scaled(&acceleration, missing, &take_out(&mut compliance, row, definite)?);
        }
        Ok(Solution { acceleration, compliance })
    }
}

/// M and f = L_q − L_vq v + Q + u.
fn equation<L, Q, S: Scalar, const N: usize>(
    System { lagrangian, forces }: &System<L, Q>,
    q: &[S; N],
    v: &[S; N],
    u: &[S; N],
) -> (Matrix<S, N>, [S; N])
where
    L: Lagrangian<S, N>,
    Q: Forces<S, N>,
{
    let (d, drag) = (lagrangian.dynamics(q, v), forces.force(q, v, u));
    (d.mass, std::array::from_fn(|i| d.l_q[i] - d.l_vq_v[i] + drag[i] + u[i]))
}

/// The equations of motion of eight samples.
fn equations<F: Family<N>, const N: usize>(
    Systems { eight: system, family, .. }: &Systems<F, N>,
    group: &Group<N>,
) -> [Equation<N>; LANES] {
    let lanes = |pick: fn(&Sample<N>) -> &[f64; N]| -> [Lanes; N] {
        std::array::from_fn(|i| Lanes(std::array::from_fn(|lane| pick(&group[lane])[i])))
    };
    let (q, v, u) = (lanes(|s| &s.states[0]), lanes(|s| &s.states[1]), lanes(|s| &s.controls[0]));
    let (mass, force) = equation(system, &q, &v, &u);
    let constraints = |[q, v, _]: &[[f64; N]; 3]| {
        let constraints = family.constraints(q).into_iter();
        constraints.map(|constraint| (constraint.gradient, constraint.curvature(v))).collect()
    };
    std::array::from_fn(|lane| Equation {
        mass: mass.map(|row| row.map(|entry| entry.0[lane])),
        force: force.map(|force| force.0[lane]),
        constraints: constraints(&group[lane].states),
    })
}

impl<F: Family<N>, const N: usize> GroupLoss<F, N> for AccelerationLoss {
    type Residual = [f64; N];

    fn residuals(&self, systems: &Systems<F, N>, group: &Group<N>) -> Result<[[f64; N]; LANES], Failed> {
        let mut residuals = [[0.0; N]; LANES];
        for ((residual, equation), sample) in residuals.iter_mut().zip(equations(systems, group)).zip(group) {
            let [_, _, a] = &sample.states;
            *residual = add_scaled(&equation.acceleration(F::DEFINITE)?, -1.0, a);
        }
        Ok(residuals)
    }

    /// ∂v̇ = Π ∂(L_q + Q − d/dt L_v) with v̇ held on the right.
    fn linearise_group(
        &self,
        systems: &Systems<F, N>,
        group: &Group<N>,
        terms: &mut [Vec<Term<N>>; LANES],
    ) -> Result<[[f64; N]; LANES], Failed> {
        let mut residuals = [[0.0; N]; LANES];
        for (lane, (equation, sample)) in equations(systems, group).into_iter().zip(group).enumerate() {
            let [q, v, a] = &sample.states;
            let Solution { acceleration, compliance } = equation.solution(F::DEFINITE)?;
            terms[lane].extend(compliance.map(|y| Term { q: *q, v: *v, y, a: acceleration }));
            residuals[lane] = add_scaled(&acceleration, -1.0, a);
        }
        Ok(residuals)
    }
}

/// Takes the direction of a constraint out of a symmetric matrix: Π − Πa (a·Πa)⁻¹ (Πa)ᵀ; returns Πa/(a·Πa). `definite`: whether Π
/// must be positive along it.
fn take_out<const N: usize>(
    matrix: &mut [[f64; N]; N],
    row: &[f64; N],
    definite: bool,
) -> Result<[f64; N], Failed> {
    let along = multiply(matrix, row);
    let flexibility = dot(row, &along);
    // Not a number where a weight has left its range.
    if flexibility.is_nan() || flexibility == 0.0 || (definite && flexibility < 0.0) {
        return Err(Failed);
    }
    for (i, entries) in matrix.iter_mut().enumerate() {
        *entries = add_scaled(entries, -along[i] / flexibility, &along);
    }
    Ok(along.map(|x| x / flexibility))
}

/// I.
fn identity<const N: usize>() -> [[f64; N]; N] {
    std::array::from_fn(|i| std::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }))
}
