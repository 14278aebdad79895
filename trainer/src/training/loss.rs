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
use leastaction_core::discrete::{
    Control, Del, Interval, Linearised, Newton, Path, Solved, StepError, Variation,
};
use leastaction_core::forces::Forces;
use leastaction_core::forces::System;
use leastaction_core::lagrangian::{DenseMass, Lagrangian};
use leastaction_core::linear::{Singular, add_scaled, dot, multiply, solve, solve_many, transpose};
use leastaction_core::scalar::{LANES, Lanes};
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

impl From<Singular> for Failed {
    fn from(_: Singular) -> Self {
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
}

impl<'w, F: Family<N>, const N: usize> Systems<'w, F, N> {
    /// Reads the shape; once for many samples.
    pub fn new(family: &'w F, weights: &'w [f64]) -> Result<Self, Failed> {
        let one = family.system::<f64>(weights).map_err(|_| Failed)?;
        Ok(Self { family, one, eight: family.system::<Lanes>(weights).map_err(|_| Failed)? })
    }
}

/// A loss over eight samples side by side, with the bits that each has alone.
pub(super) trait GroupLoss<F: Family<N>, const N: usize>: Sync {
    /// The kinds of the terms that each component has, in order.
    fn kinds(&self) -> &'static [TermKind];
    /// The residuals.
    fn residuals(&self, systems: &Systems<F, N>, group: &Group<N>) -> Result<[[f64; N]; LANES], Failed>;
    /// The residuals, and for every sample and component its terms: `terms[sample][component * kinds + k]`.
    fn linearise_group(
        &self,
        systems: &Systems<F, N>,
        group: &Group<N>,
        terms: &mut [Vec<Term<N>>; LANES],
    ) -> Result<[[f64; N]; LANES], Failed>;
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
    fn acceleration(self) -> Result<[f64; N], Failed> {
        if self.constraints.is_empty() {
            return Ok(solve(self.mass, self.force)?);
        }
        Ok(self.solution()?.acceleration)
    }

    /// One constraint after the other, as if the rest were not there: each takes its own direction out of Π.
    fn solution(self) -> Result<Solution<N>, Failed> {
        let mut compliance = solve_many(transpose(&self.mass), identity())?;
        let mut acceleration = solve(self.mass, self.force)?;
        for (row, bend) in &self.constraints {
            let missing = -(dot(row, &acceleration) + bend);
            acceleration = add_scaled(&acceleration, missing, &take_out(&mut compliance, row)?);
        }
        Ok(Solution { acceleration, compliance })
    }
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
    let d = system.lagrangian.dynamics(&q, &v);
    let drag = system.forces.force(&q, &v);
    let force: [Lanes; N] = std::array::from_fn(|i| d.l_q[i] - d.l_vq_v[i] + drag[i] + u[i]);
    let constraints = |[q, v, _]: &[[f64; N]; 3]| {
        let constraints = family.constraints(q).into_iter();
        constraints.map(|constraint| (constraint.gradient, constraint.curvature(v))).collect()
    };
    std::array::from_fn(|lane| Equation {
        mass: d.mass.0.map(|row| row.map(|entry| entry.0[lane])),
        force: force.map(|force| force.0[lane]),
        constraints: constraints(&group[lane].states),
    })
}

impl<F: Family<N>, const N: usize> GroupLoss<F, N> for AccelerationLoss {
    fn kinds(&self) -> &'static [TermKind] {
        &[TermKind::Residual]
    }

    fn residuals(&self, systems: &Systems<F, N>, group: &Group<N>) -> Result<[[f64; N]; LANES], Failed> {
        let mut residuals = [[0.0; N]; LANES];
        for ((residual, equation), sample) in residuals.iter_mut().zip(equations(systems, group)).zip(group) {
            let [_, _, a] = &sample.states;
            *residual = add_scaled(&equation.acceleration()?, -1.0, a);
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
            let Solution { acceleration, compliance } = equation.solution()?;
            terms[lane].extend(compliance.map(|y| Term { q: *q, v: *v, dq: y, dv: acceleration }));
            residuals[lane] = add_scaled(&acceleration, -1.0, a);
        }
        Ok(residuals)
    }
}

/// A loss of three consecutive positions under the discrete dynamics of path P, without constraints.
pub(super) struct DelLoss<P> {
    /// The integrator.
    pub del: Del<f64, P>,
    /// Newton's bounds in training.
    pub newton: Newton<f64>,
    /// Whether the residual is that of the next position; else that of the DEL equation.
    pub next_position: bool,
}

/// The two intervals of a triple, solved as far as the loss wants, and the residual.
struct Pair<P, const N: usize> {
    before: Solved<f64, P, N>,
    after: Solved<f64, P, N>,
    residual: [f64; N],
}

impl<P: Path + Sync> DelLoss<P> {
    fn solve<L, F, const N: usize>(
        &self,
        system: &System<L, F>,
        [q0, q1, q2]: &[[f64; N]; 3],
        [u0, u1, u2]: &[[f64; N]; 3],
    ) -> Result<Pair<P, N>, Failed>
    where
        L: Lagrangian<f64, N>,
        F: Forces<f64, N>,
    {
        let h = self.del.h();
        let increment = |a: &[f64; N], b: &[f64; N]| std::array::from_fn(|i| (b[i] - a[i]) / h);
        let (w0, w1): ([f64; N], [f64; N]) = (increment(q0, q1), increment(q1, q2));
        let before = Interval::new(*q0, w0, h, Control { start: *u0, end: *u1 });
        let before = self.newton.solve_bubble(system, before)?;
        let p = before.balance.end_momentum();
        let after = Interval::new(*q1, w1, h, Control { start: *u1, end: *u2 });
        if self.next_position {
            let after = self.newton.solve_step(system, after, &p)?;
            let w = after.interval.increment();
            return Ok(Pair { before, after, residual: std::array::from_fn(|i| h * (w[i] - w1[i])) });
        }
        let after = self.newton.solve_bubble(system, after)?;
        Ok(Pair { before, after, residual: add_scaled(&p, 1.0, &after.balance.d1_ld) })
    }
}

/// One sample after the other: the steps of each take as many iterations as it needs.
impl<P: Path + Sync, F: Family<N>, const N: usize> GroupLoss<F, N> for DelLoss<P> {
    fn kinds(&self) -> &'static [TermKind] {
        if P::BUBBLE { &[TermKind::Along; 4] } else { &[TermKind::Along; 2] }
    }

    fn residuals(&self, systems: &Systems<F, N>, group: &Group<N>) -> Result<[[f64; N]; LANES], Failed> {
        let mut residuals = [[0.0; N]; LANES];
        for (residual, sample) in residuals.iter_mut().zip(group) {
            *residual = self.solve(&systems.one, &sample.states, &sample.controls)?.residual;
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
            *residual = self.linearise(&systems.one, &sample.states, &sample.controls, terms)?;
        }
        Ok(residuals)
    }
}

impl<P: Path + Sync> DelLoss<P> {
    /// With G = p₁ + d1_ld the DEL residual, dG = ∂G + G_s₀ ds₀ + G_s₁ ds₁ and the bubbles follow their own equations; the
    /// next position follows from 0 = dG + K dw.
    fn linearise<L, F, const N: usize>(
        &self,
        system: &System<L, F>,
        states: &[[f64; N]; 3],
        controls: &[[f64; N]; 3],
        terms: &mut Vec<Term<N>>,
    ) -> Result<[f64; N], Failed>
    where
        L: Lagrangian<f64, N, Mass = DenseMass<f64, N>>,
        F: Forces<f64, N>,
    {
        let pair = self.solve(system, states, controls)?;
        let (before, after) = (&pair.before.interval, &pair.after.interval);
        let ahead = after.linearise(system);
        let rows =
            if self.next_position { next_position_rows::<P, N>(&ahead, self.del.h())? } else { identity() };
        let (mut slaved_before, mut slaved_after) = ([[0.0; N]; N], [[0.0; N]; N]);
        if P::BUBBLE {
            let momentum_s = before.end_momentum_s(system);
            slaved_before = slaved(&momentum_s, &before.linearise(system).bubble_s)?;
            slaved_after = slaved(&ahead.momentum_s, &ahead.bubble_s)?;
        }
        for y in &rows {
            push_terms(before, y, &multiply(&slaved_before, y), Variation::end, self.del.h(), terms);
            push_terms(after, y, &multiply(&slaved_after, y), Variation::start, self.del.h(), terms);
        }
        Ok(pair.residual)
    }
}

/// Takes the direction of a constraint out of a symmetric matrix: Π − Πa (a·Πa)⁻¹ (Πa)ᵀ; returns Πa/(a·Πa).
pub(super) fn take_out<const N: usize>(
    matrix: &mut [[f64; N]; N],
    row: &[f64; N],
) -> Result<[f64; N], Failed> {
    let along = multiply(matrix, row);
    let flexibility = dot(row, &along);
    // Not a number where a weight has left its range.
    if flexibility.is_nan() || flexibility <= 0.0 {
        return Err(Failed);
    }
    for (i, entries) in matrix.iter_mut().enumerate() {
        *entries = add_scaled(entries, -along[i] / flexibility, &along);
    }
    Ok(along.map(|x| x / flexibility))
}

/// Rows y of −h K⁻¹, K = ∂G/∂w with the bubble following.
fn next_position_rows<P: Path, const N: usize>(
    ahead: &Linearised<f64, N>,
    h: f64,
) -> Result<[[f64; N]; N], Singular> {
    let k = if P::BUBBLE { ahead.reduced()?.1 } else { ahead.momentum_w };
    let rows = solve_many(transpose(&k), identity())?;
    Ok(rows.map(|row| row.map(|x| -h * x)))
}

/// (A B⁻¹)ᵀ: applied to y it gives the weight of the bubble's equation.
fn slaved<const N: usize>(a: &[[f64; N]; N], b: &[[f64; N]; N]) -> Result<[[f64; N]; N], Singular> {
    // Rows of A B⁻¹ solve Bᵀx = (row of A).
    Ok(transpose(&solve_many(transpose(b), *a)?))
}

/// The terms of one interval for the weight y of its end's (or start's) momentum and z of its bubble's equation.
fn push_terms<P: Path, const N: usize>(
    interval: &Interval<f64, P, N>,
    y: &[f64; N],
    z: &[f64; N],
    end: fn(&leastaction_core::discrete::Node<f64>, f64) -> Variation<f64>,
    h: f64,
    terms: &mut Vec<Term<N>>,
) {
    for node in P::nodes().as_ref() {
        let (q, v) = interval.point(node);
        let (end, bubble) = (end(node, h), Variation::bubble(node, h));
        let weigh = |end: f64, bubble: f64| -> [f64; N] {
            std::array::from_fn(|i| node.weight * (end * y[i] - bubble * z[i]))
        };
        terms.push(Term {
            q,
            v,
            dq: weigh(end.force, bubble.force),
            dv: weigh(end.momentum, bubble.momentum),
        });
    }
}

pub(super) fn identity<const N: usize>() -> [[f64; N]; N] {
    std::array::from_fn(|i| std::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }))
}
