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
use crate::dual::Dual;
use leastaction_core::discrete::StepError;
use leastaction_core::forces::{Forces, System};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::linear::{Matrix, SolveError, add_scaled, dot, multiply, solve, solve_many, transpose};
use leastaction_core::scalar::{LANES, Lanes, Scalar};
use serde::{Deserialize, Serialize};

/// What is minimised. The discrete losses are those of the DEL integrator, and on rods those of RATTLE.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
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

/// One term of a residual's derivative in the weights.
#[derive(Clone, Copy, Debug)]
pub(super) struct Term<const N: usize> {
    /// Where.
    pub q: [f64; N],
    /// Where.
    pub v: [f64; N],
    /// Weight of F = L_q + Q.
    pub dq: [f64; N],
    /// Weight of L_v; for [`Residual`](TermKind::Residual) the acceleration.
    pub dv: [f64; N],
}

/// Which derivative a term stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TermKind {
    /// ∂/∂θ [F·dq + L_v·dv].
    Along,
    /// ∂/∂θ [(F − d/dt L_v)·dq] at the acceleration dv.
    Residual,
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
    /// One.
    pub one: FamilySystem<'w, F, f64, N>,
    /// Eight side by side.
    pub eight: FamilySystem<'w, F, Lanes, N>,
    weights: &'w [f64],
}

impl<'w, F: Family<N>, const N: usize> Systems<'w, F, N> {
    /// Reads the shape; once for many samples.
    pub fn new(family: &'w F, weights: &'w [f64]) -> Result<Self, Failed> {
        let one = family.system::<f64>(weights).map_err(|_| Failed)?;
        Ok(Self { family, one, eight: family.system::<Lanes>(weights).map_err(|_| Failed)?, weights })
    }

    /// Eight side by side with their derivatives along a direction.
    pub fn moving(&self) -> Result<FamilySystem<'w, F, Dual<Lanes>, N>, Failed> {
        self.family.system::<Dual<Lanes>>(self.weights).map_err(|_| Failed)
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

impl<const N: usize, const M: usize> Components for [[f64; N]; M] {
    const COUNT: usize = N * M;

    fn as_slice(&self) -> &[f64] {
        self.as_flattened()
    }
}

/// A loss over eight samples side by side, with the bits that each has alone.
pub(super) trait GroupLoss<F: Family<N>, const N: usize>: Sync {
    /// Of a sample.
    type Residual: Components;
    /// The kinds of the terms that each component has, in order.
    fn kinds(&self) -> &'static [TermKind];
    /// The residuals.
    fn residuals(&self, systems: &Systems<F, N>, group: &Group<N>)
    -> Result<[Self::Residual; LANES], Failed>;
    /// The residuals, and for every sample and component its terms: `terms[sample][component * kinds + k]`.
    fn linearise_group(
        &self,
        systems: &Systems<F, N>,
        group: &Group<N>,
        terms: &mut [Vec<Term<N>>; LANES],
    ) -> Result<[Self::Residual; LANES], Failed>;
}

/// A loss of one sample at a time: the steps of each take as many iterations as it needs.
pub(super) trait SampleLoss<F: Family<N>, const N: usize>: Sync {
    /// As [`GroupLoss::kinds`].
    fn kinds(&self) -> &'static [TermKind];
    /// The residual.
    fn residual(&self, systems: &Systems<F, N>, sample: &Sample<N>) -> Result<[f64; N], Failed>;
    /// The residual, and for every component its terms.
    fn linearise(
        &self,
        systems: &Systems<F, N>,
        sample: &Sample<N>,
        terms: &mut Vec<Term<N>>,
    ) -> Result<[f64; N], Failed>;
}

/// One sample of a group after the other.
pub(super) struct OneByOne<T>(pub T);

impl<T: SampleLoss<F, N>, F: Family<N>, const N: usize> GroupLoss<F, N> for OneByOne<T> {
    type Residual = [f64; N];

    fn kinds(&self) -> &'static [TermKind] {
        self.0.kinds()
    }

    fn residuals(&self, systems: &Systems<F, N>, group: &Group<N>) -> Result<[[f64; N]; LANES], Failed> {
        let mut residuals = [[0.0; N]; LANES];
        for (residual, sample) in residuals.iter_mut().zip(group) {
            *residual = self.0.residual(systems, sample)?;
        }
        Ok(residuals)
    }

    fn linearise_group(
        &self,
        systems: &Systems<F, N>,
        group: &Group<N>,
        terms: &mut [Vec<Term<N>>; LANES],
    ) -> Result<[[f64; N]; LANES], Failed> {
        let mut residuals = [[0.0; N]; LANES];
        for ((residual, sample), terms) in residuals.iter_mut().zip(group).zip(terms) {
            *residual = self.0.linearise(systems, sample, terms)?;
        }
        Ok(residuals)
    }
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
pub(super) fn equation<L, Q, S: Scalar, const N: usize>(
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

    fn kinds(&self) -> &'static [TermKind] {
        &[TermKind::Residual]
    }

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
            terms[lane].extend(compliance.map(|y| Term { q: *q, v: *v, dq: y, dv: acceleration }));
            residuals[lane] = add_scaled(&acceleration, -1.0, a);
        }
        Ok(residuals)
    }
}

/// Takes the direction of a constraint out of a symmetric matrix: Π − Πa (a·Πa)⁻¹ (Πa)ᵀ; returns Πa/(a·Πa). `definite`: whether Π
/// must be positive along it.
pub(super) fn take_out<const N: usize>(
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
pub(super) fn identity<const N: usize>() -> [[f64; N]; N] {
    std::array::from_fn(|i| std::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }))
}
