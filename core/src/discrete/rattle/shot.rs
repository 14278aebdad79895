use super::Rattle;
use super::points::{ParticleState, copy};
use super::solver::Solver;
use super::stage::{size, worse};
use crate::constraints::{ConstraintError, Constraints};
use crate::linear::add_scaled;
use crate::newton::{Equations, Newton, Report, relative};
use crate::particles::Particles;
use crate::scalar::Real;

/// Search for the velocity at q₀ from which a step arrives at q₁.
///
/// A step moves the positions by about h times their velocity, so an update adds the miss divided by h:
/// Newton's method with ∂q₁/∂v₀ ≈ h. The miss falls by a factor of (hω)²/6 per update, with ω, rad/s, the
/// fastest rate of the system.
pub(super) struct Shot<'e, 'm, 'r, 'a, R, S, C: ?Sized, const D: usize> {
    rattle: &'e Rattle<R>,
    solver: Solver<'m, 'r, R, S, C, D>,
    /// The state: q₀ in `now`, the point of arrival in `next`.
    state: &'e mut ParticleState<'a, R, D>,
    target: &'e [[R; D]],
    force: Option<&'e [[R; D]]>,
}

impl<'e, 'm, 'r, 'a, R: Real, S, C: ?Sized, const D: usize> Shot<'e, 'm, 'r, 'a, R, S, C, D> {
    /// Starts the search at rest, before any step.
    pub fn new(
        rattle: &'e Rattle<R>,
        solver: Solver<'m, 'r, R, S, C, D>,
        state: &'e mut ParticleState<'a, R, D>,
        [q0, q1]: [&'e [[R; D]]; 2],
        force: Option<&'e [[R; D]]>,
    ) -> Self {
        for points in [&mut state.now, &mut state.next] {
            copy(points.q, q0);
            points.q_carry.fill([R::zero(); D]);
            points.v.fill([R::zero(); D]);
        }
        Self { rattle, solver, state, target: q1, force }
    }
}

impl<R, S, C, const D: usize> Shot<'_, '_, '_, '_, R, S, C, D>
where
    R: Real,
    S: Particles<R, D>,
    C: Constraints<R, D> + ?Sized,
{
    /// Iterates until the positions reach q₁ as closely as rounding allows. Positions carry their rounding errors, so
    /// the miss is known to about ε².
    pub fn hit(&mut self) -> Result<Report<R>, ConstraintError<R>> {
        Newton { stop: R::EPSILON * R::EPSILON, ..Newton::new() }.solve(self)
    }
}

impl<R, S, C, const D: usize> Equations<R> for Shot<'_, '_, '_, '_, R, S, C, D>
where
    R: Real,
    S: Particles<R, D>,
    C: Constraints<R, D> + ?Sized,
{
    type Error = ConstraintError<R>;

    fn residual(&mut self) -> R {
        let next = &self.state.next;
        let nodes = self.target.iter().zip(next.q.iter()).zip(next.q_carry.iter());
        nodes.fold(R::zero(), |worst, ((to, q), carry)| {
            worse(worst, relative(size(&missed(to, q, carry)), size(to) + size(q)))
        })
    }

    fn update(&mut self) -> Result<(), ConstraintError<R>> {
        let ParticleState { now, next } = &mut *self.state;
        let arrived = self.target.iter().zip(next.q.iter()).zip(next.q_carry.iter());
        for (v, ((to, q), carry)) in now.v.iter_mut().zip(arrived) {
            *v = add_scaled(v, R::one() / self.rattle.h, &missed(to, q, carry));
        }
        self.solver.start(now)?;
        next.copy(now);
        next.lambda.fill(R::zero());
        self.rattle.substeps(&mut self.solver, next, self.force).map(drop)
    }
}

/// The miss: from q + carry to the target.
#[inline(always)]
fn missed<R: Real, const D: usize>(to: &[R; D], q: &[R; D], carry: &[R; D]) -> [R; D] {
    core::array::from_fn(|i| (to[i] - q[i]) - carry[i])
}
