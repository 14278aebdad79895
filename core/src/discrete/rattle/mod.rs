//! RATTLE: the variational step of particles with holonomic constraints, of order 2, and of order 4 by composition.
//!
//! The discrete Lagrangian is trapezoidal, L_d = h [T((q₁ − q₀)/h) − ½V(q₀) − ½V(q₁)], so the DEL equation in position–momentum form is
//! explicit except for the constraints. With the external force f and drag Q as impulses at both ends, one step solves
//!
//! - p½ = p₀ + ½h [L_q(q₀) + Q(v₀) + f] + A(q₀)ᵀ Λ₀,  L_v(w) = p½,  q₁ = q₀ + hw,  φ(q₁) = 0;
//! - p₁ = p½ + ½h [L_q(q₁) + Q(v₁) + f] + A(q₁)ᵀ Λ₁,  L_v(v₁) = p₁,  A(q₁) v₁ = 0.
//!
//! Without constraints this is the Störmer–Verlet method, in linear time. Newton's method solves each line for velocities and impulses
//! together: if the kinetic energy is quadratic, only φ is nonlinear, and the second line is linear.
//!
//! Positions and momenta are summed with compensation, and φ is evaluated at position and carry
//! ([`Positions`](crate::constraints::Positions)), because the step divides φ by h.
//!
//! # Dry friction that sticks
//!
//! Dry friction ([`Gripped`](crate::particles::Gripped)) is a set-valued law with two impulses a step. Λ⁻ joins the first line and belongs to w,
//! Λ⁺ the second and belongs to v₁: with the levels c⁺ and c⁻ of [`Grip`](crate::forces::Grip) and the breakaway ratio s, for each coordinate i
//!
//! - it sticks: w_i = 0 in place of its equation of momentum, and −½h s c⁺ ≤ Λ⁻_i ≤ ½h s c⁻; Λ⁻_i is what balances it, rods included;
//! - or it slides: Λ⁻_i = −½h c⁺ and w_i ≥ 0, or Λ⁻_i = ½h c⁻ and w_i ≤ 0;
//!
//! and the same for Λ⁺ and v₁. A coordinate that sticks leaves M⁻¹, so that A₁ M⁻¹ A₀ᵀ is that of the others: it has w_i = 0 to the last bit, and
//! so a body at rest keeps every bit of its state. An equation that the others cannot change, as that of a rod between two nodes at rest, or that
//! follows from equations before it, gets no impulse: any would do, as friction balances it, and 0 is the one that loads friction with the outer
//! forces alone. If friction cannot hold these, what exceeds its level slides at it, and the rod has an equation again; what rods then keep in
//! place has w_i = 0 too, where velocities are no more than rounding. If the others move such an equation off 0, its multiplier would
//! have no bound, and what sticks along it slides.
//!
//! Motions are found by an active set: for n coordinates, the first 2n revisions replace all that contradict the solution; those after them
//! go down the convex function ½wᵀMw − pᵀw + Σ½hc|w| from rest, one coordinate at a time, twice. After 14n revisions in a line the step is an
//! error ([`ConstraintError::NotConverged`]), and the state unchanged.
//!
//! Λ⁻·w ≤ 0 and Λ⁺·v₁ ≤ 0. With V = 0, no force and a quadratic T, T₁ − T₀ = Λ⁻·w + Λ⁺·v₁ + Λ₀·A₀w − ½|w − v₀|² − ½|v₁ − w|² in the norm of M:
//! without rods energy never grows, and with rods friction takes what remains beside RATTLE's own error of energy, which is of
//! order h³ in a step. Between events steps are of order 2; at an event, the instant is off by a part of the step. Order 4 steps
//! back in time, where friction that sticks has no unique solution, and is refused ([`ConstraintError::Backward`]). Particles have no end stops.
//!
//! # Order 4
//!
//! Order 4 is Suzuki's composition of five such steps. The composition is symmetric like the step itself. Its
//! order is therefore even, and it keeps constraints, momentum and reversibility.
//!
//! Sources: Andersen, "Rattle", J. Comput. Phys. 1983; Marsden and West, Acta Numerica 2001, section 3.5; Hairer, Lubich,
//! Wanner, "Geometric Numerical Integration", sections VII.1.4 and V.3.2; Moreau, "Unilateral contact and dry friction in finite freedom
//! dynamics", 1988.

mod points;
mod shot;
mod solver;
mod stage;

pub use points::ParticleState;

use super::{Newton, Order, Report};
use crate::constraints::{Banded, Constrained, ConstraintError, Constraints};
use crate::particles::Particles;
use crate::scalar::Real;
use points::{Points, check_start};
use shot::Shot;
use solver::{Solver, coupled};

/// The integrator: the step h, the order, and the bounds of Newton's method.
#[derive(Clone, Copy, Debug)]
pub struct Rattle<R> {
    h: R,
    order: Order,
    newton: Newton<R>,
}

impl<R: Real> Rattle<R> {
    /// Creates an integrator of step h > 0, s, with [`Rattle::default_newton`].
    pub fn new(h: R, order: Order) -> Self {
        Self::with_newton(h, order, Self::default_newton())
    }

    /// Default bounds of Newton's method: at most 12 updates, down to the limit of rounding (a quarter of ε). A
    /// φ left by fewer updates would have the same sign at every step, and over 10⁶ steps in f32 the energy
    /// would drift.
    pub fn default_newton() -> Newton<R> {
        let stop = R::EPSILON * R::constant(0.25);
        Newton { max_iterations: 12, stop, accept: R::EPSILON.sqrt() }
    }

    /// Creates an integrator with the caller's bounds of Newton's method. Residuals are relative: those of the
    /// momenta to the size of the terms in their sums, those of the constraints (φ/h or A v) to the largest
    /// velocity.
    pub const fn with_newton(h: R, order: Order, newton: Newton<R>) -> Self {
        Self { h, order, newton }
    }

    /// Replaces the bounds of Newton's method.
    pub(crate) const fn newton(self, newton: Newton<R>) -> Self {
        Self { newton, ..self }
    }

    /// Step size h, s.
    pub const fn h(&self) -> R {
        self.h
    }

    /// Workspace length of [`Rattle::step`] and [`ParticleState::new`], not counting the state.
    pub fn workspace<S, C, const D: usize>(mechanism: &Constrained<R, S, C, D>) -> usize
    where
        S: Particles<R, D>,
        C: Constraints<R, D> + ?Sized,
    {
        let (system, equations) = (mechanism.system(), mechanism.equations());
        let most = Self::workspace_of::<D>(system.nodes(), equations, mechanism.band(), system.workspace());
        if system.sticks() {
            most + Self::sticking_workspace_of::<D>(system.nodes(), equations)
        } else {
            most
        }
    }

    /// [`Rattle::workspace`] from the numbers it depends on, usable as an array length: nodes, constraint equations, the band of A M⁻¹ Aᵀ
    /// (1 for a chain in order), and the workspace of the system itself. Without constraints, every node is solved on its own and takes no
    /// workspace.
    pub const fn workspace_of<const D: usize>(
        nodes: usize,
        equations: usize,
        band: usize,
        system: usize,
    ) -> usize {
        system
            + coupled(nodes, equations) * solver::solved::<D>()
            + Banded::<R>::workspace(equations, band)
            + equations
    }

    /// Numbers that [`Rattle::workspace_of`] leaves out for particles with friction that sticks ([`Particles::sticks`]).
    pub const fn sticking_workspace_of<const D: usize>(nodes: usize, equations: usize) -> usize {
        solver::sticking::<D>(nodes, equations)
    }

    /// Advances `state` by one step under an external force on each node, N, constant over the step.
    ///
    /// The report holds the largest number of updates that a stage took and the largest remaining residual. An
    /// error leaves the state unchanged.
    pub fn step<S, C, const D: usize>(
        &self,
        mechanism: &Constrained<R, S, C, D>,
        state: &mut ParticleState<R, D>,
        force: Option<&[[R; D]]>,
        workspace: &mut [R],
    ) -> Result<Report<R>, ConstraintError<R>>
    where
        S: Particles<R, D>,
        C: Constraints<R, D> + ?Sized,
    {
        if let Some(force) = force {
            mechanism.check_nodes(force)?;
        }
        let mut solver = Solver::new(mechanism, &self.newton, workspace)?;
        let next = state.copied(mechanism)?;
        let report = self.substeps(&mut solver, next, force)?;
        next.finish(self.h)?;
        state.swap();
        Ok(report)
    }

    /// Returns the state at q₁ from q₀ and q₁, m, the positions at the start and the end of one step, and the
    /// external force during that step, N. Both positions must satisfy the constraints. No velocity is needed.
    /// `state` is the memory of the state ([`ParticleState::workspace`]); `workspace` is used only during the
    /// call.
    ///
    /// # Errors
    /// See [`ConstraintError`]; `NotConverged` if no velocity is found because h is too long for this motion.
    pub fn start<'a, S, C, const D: usize>(
        &self,
        mechanism: &Constrained<R, S, C, D>,
        [q0, q1]: [&[[R; D]]; 2],
        force: Option<&[[R; D]]>,
        state: &'a mut [R],
        workspace: &mut [R],
    ) -> Result<ParticleState<'a, R, D>, ConstraintError<R>>
    where
        S: Particles<R, D>,
        C: Constraints<R, D> + ?Sized,
    {
        let mut all = ParticleState::over(mechanism, state)?;
        self.restart(mechanism, [q0, q1], force, &mut all, workspace)?;
        Ok(all)
    }

    /// [`Rattle::start`] in the memory of an existing state, which is lost on error.
    pub(crate) fn restart<S, C, const D: usize>(
        &self,
        mechanism: &Constrained<R, S, C, D>,
        [q0, q1]: [&[[R; D]]; 2],
        force: Option<&[[R; D]]>,
        state: &mut ParticleState<R, D>,
        workspace: &mut [R],
    ) -> Result<(), ConstraintError<R>>
    where
        S: Particles<R, D>,
        C: Constraints<R, D> + ?Sized,
    {
        check_start(mechanism, q0)?;
        check_start(mechanism, q1)?;
        force.map_or(Ok(()), |force| mechanism.check_nodes(force))?;
        let mut solver = Solver::new(mechanism, &self.newton, workspace)?;
        if mechanism.system().sticks() {
            self.arrive(&mut solver, &mut state.next, [q0, q1], force)?;
        } else {
            Shot::new(self, solver, state, [q0, q1], force).hit()?;
        }
        state.next.finish(self.h)?;
        state.swap();
        Ok(())
    }

    /// The end of a step between given positions. Friction that sticks would hide from a shot how fast it must be; but at order 2, the only one it
    /// is stepped with, the increment tells the momentum between both lines.
    fn arrive<S, C, const D: usize>(
        &self,
        solver: &mut Solver<R, S, C, D>,
        next: &mut Points<R, D>,
        [q0, q1]: [&[[R; D]]; 2],
        force: Option<&[[R; D]]>,
    ) -> Result<(), ConstraintError<R>>
    where
        S: Particles<R, D>,
        C: Constraints<R, D> + ?Sized,
    {
        self.order.substeps(self.h).try_for_each(|h| solver.check_direction(h))?;
        next.begin_at(q1);
        for (v, (q0, q1)) in next.v.iter_mut().zip(q0.iter().zip(q1)) {
            *v = core::array::from_fn(|i| (q1[i] - q0[i]) / self.h);
        }
        solver.arrive(next, force, self.h)?;
        next.lambda.fill(R::zero());
        Ok(())
    }

    fn substeps<S, C, const D: usize>(
        &self,
        solver: &mut Solver<R, S, C, D>,
        next: &mut Points<R, D>,
        force: Option<&[[R; D]]>,
    ) -> Result<Report<R>, ConstraintError<R>>
    where
        S: Particles<R, D>,
        C: Constraints<R, D> + ?Sized,
    {
        let mut report = Report::nothing();
        for h in self.order.substeps(self.h) {
            report = report.worse(solver.step(next, force, h)?);
        }
        Ok(report)
    }
}

impl Order {
    /// Lengths, s, of the steps of order 2 that make up one step of length h, in order; they add up to h.
    pub fn substeps<R: Real>(self, h: R) -> impl Iterator<Item = R> {
        // γ = 1/(4 − ∛4) and 1 − 4γ. The second is computed from the first, so the five lengths add up to h.
        let outer = h * R::constant(0.414_490_771_794_375_7);
        let middle = h - R::constant(4.0) * outer;
        let (lengths, count) = match self {
            Self::Two => ([h; 5], 1),
            Self::Four => ([outer, outer, middle, outer, outer], 5),
        };
        lengths.into_iter().take(count)
    }
}
