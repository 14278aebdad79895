use super::Solver;
use crate::constraints::{ConstraintError, Constraints, Positions, Rows, inverse};
use crate::discrete::rattle::points::{Points, add};
use crate::discrete::rattle::stage::{BLOCK, Scale, Stage, largest, size, worse};
use crate::linear::{add_scaled, multiply};
use crate::newton::{Equations, Report, relative};
use crate::particles::Particles;
use crate::scalar::Real;

impl<R, S, C, const D: usize> Solver<'_, '_, R, S, C, D>
where
    R: Real,
    S: Particles<R, D>,
    C: Constraints<R, D> + ?Sized,
{
    /// Solves for velocities and impulses together.
    #[inline(never)]
    pub(super) fn solve_all(
        &mut self,
        points: &mut Points<R, D>,
        stage: Stage<R>,
    ) -> Result<Report<R>, ConstraintError<R>> {
        let newton = self.newton;
        newton.solve(&mut Coupled::new(self, points, stage))
    }

    /// Writes the residuals of both equations, and returns the largest relative to the size of its terms.
    pub(super) fn residual(&mut self, points: &Points<R, D>, stage: Stage<R>, scale: Scale<R>) -> R {
        let (system, mut worst) = (self.mechanism.system(), R::zero());
        let mut terms = [R::zero(); BLOCK];
        let blocks = points.v.chunks(BLOCK).zip(points.p.chunks(BLOCK)).zip(self.update.chunks_mut(BLOCK));
        for (block, ((v, p), r)) in blocks.enumerate() {
            stage.imbalances(system, block * BLOCK, (v, p), (&mut *r, &mut terms));
            for (r, terms) in r.iter().zip(&terms) {
                worst = worse(worst, relative(size(r), *terms + scale.impulse));
            }
        }
        if let Stage::Positions { h } = stage {
            self.move_trial(points, h);
        }
        let (constraints, x) =
            (self.mechanism.constraints(), Positions::with_carry(self.trial, self.trial_carry));
        for (k, c) in self.multipliers.iter_mut().enumerate() {
            *c = match stage {
                Stage::Positions { h } => constraints.value(k, x) / h,
                Stage::Velocities { .. } => Rows { constraints, x }.times(k, points.v),
            };
            worst = worse(worst, relative(c.abs(), scale.velocity));
        }
        worst
    }

    /// Sets the trial positions q + hv.
    pub(super) fn move_trial(&mut self, points: &Points<R, D>, h: R) {
        let start = points.q.iter().zip(points.q_carry.iter()).zip(points.v.iter());
        let trial = self.trial.iter_mut().zip(self.trial_carry.iter_mut());
        for ((q, carry), ((q0, carry0), v)) in trial.zip(start) {
            (*q, *carry) = (*q0, *carry0);
            add(q, carry, &v.map(|v| h * v));
        }
    }

    /// Inverts M for each node, and factors A₁ M⁻¹ A₀ᵀ.
    fn linearise(&mut self, points: &Points<R, D>, stage: Stage<R>) -> Result<(), ConstraintError<R>> {
        self.invert_masses(points, stage)?;
        self.couple(points, true);
        self.matrix.factor().map_err(|constraint| ConstraintError::Redundant { constraint })
    }

    /// Inverts M for each node.
    #[inline(always)]
    pub(super) fn invert_masses(
        &mut self,
        points: &Points<R, D>,
        stage: Stage<R>,
    ) -> Result<(), ConstraintError<R>> {
        let system = self.mechanism.system();
        let blocks = points.v.chunks(BLOCK).zip(self.inverses.chunks_mut(BLOCK));
        for (block, (v, masses)) in blocks.enumerate() {
            stage.effective_masses(system, block * BLOCK, v, masses);
        }
        for (node, mass) in self.inverses.iter_mut().enumerate() {
            *mass = inverse(*mass).ok_or(ConstraintError::Mass { node })?;
        }
        Ok(())
    }

    /// Writes A₁ W A₀ᵀ with the present blocks W of the nodes; `sizes`: whether pivots are judged by it.
    #[inline(always)]
    pub(super) fn couple(&mut self, points: &Points<R, D>, sizes: bool) {
        let (constraints, inverses) = (self.mechanism.constraints(), &self.inverses);
        let left = Rows { constraints, x: Positions::with_carry(self.trial, self.trial_carry) };
        let right = Rows { constraints, x: points.positions() };
        self.matrix.set(sizes, |k, l| left.coupling(k, inverses, &right, l));
    }

    /// Turns residuals into changes: M u = r for each node, then (A₁ M⁻¹ A₀ᵀ) dΛ = −(c + A₁ u).
    fn changes(&mut self) {
        for (update, inverse) in self.update.iter_mut().zip(self.inverses.iter()) {
            *update = multiply(inverse, update);
        }
        let x = Positions::with_carry(self.trial, self.trial_carry);
        let left = Rows { constraints: self.mechanism.constraints(), x };
        for (k, c) in self.multipliers.iter_mut().enumerate() {
            *c = -(*c + left.times(k, self.update));
        }
        self.matrix.solve(self.multipliers);
    }

    /// v += u + M⁻¹ A₀ᵀ dΛ, p += A₀ᵀ dΛ, Λ += dΛ.
    fn apply(&self, points: &mut Points<R, D>) {
        for (v, update) in points.v.iter_mut().zip(self.update.iter()) {
            *v = add_scaled(v, R::one(), update);
        }
        let Points { q, q_carry, p, p_carry, v, lambda, .. } = points;
        let (constraints, x) = (self.mechanism.constraints(), Positions::with_carry(q, q_carry));
        Rows { constraints, x }.transposed_times(self.multipliers, |node, impulse| {
            debug_assert!(node < p.len(), "node {node} of {}", p.len());
            if let (Some(p), Some(carry)) = (p.get_mut(node), p_carry.get_mut(node)) {
                add(p, carry, &impulse);
            }
            if let (Some(v), Some(inverse)) = (v.get_mut(node), self.inverses.get(node)) {
                *v = add_scaled(v, R::one(), &multiply(inverse, &impulse));
            }
        });
        for (lambda, change) in lambda.iter_mut().zip(self.multipliers.iter()) {
            *lambda += *change;
        }
    }
}

/// The velocities and impulses of all nodes, coupled by constraints.
pub(super) struct Coupled<'e, 'm, 'r, 'p, R, S, C: ?Sized, const D: usize> {
    pub solver: &'e mut Solver<'m, 'r, R, S, C, D>,
    pub points: &'e mut Points<'p, R, D>,
    pub stage: Stage<R>,
    /// `None` before the first update.
    pub scale: Option<Scale<R>>,
    /// Whether the next update keeps the matrix. For velocities it does as long as the residual falls, since
    /// their equations are linear if the energies are quadratic. For positions it never does: the residual that
    /// an old matrix leaves has the same sign at every step, and in f32 the energy would drift ten times as
    /// far.
    keeps_matrix: bool,
    /// The last residual.
    before: R,
}

impl<'e, 'm, 'r, 'p, R, S, C, const D: usize> Coupled<'e, 'm, 'r, 'p, R, S, C, D>
where
    R: Real,
    S: Particles<R, D>,
    C: Constraints<R, D> + ?Sized,
{
    pub fn new(
        solver: &'e mut Solver<'m, 'r, R, S, C, D>,
        points: &'e mut Points<'p, R, D>,
        stage: Stage<R>,
    ) -> Self {
        Self { solver, points, stage, scale: None, keeps_matrix: false, before: R::one() }
    }

    /// Moves the unknowns, after [`Solver::linearise`]; `impulse` is the size of the residuals of the momenta if it becomes the scale.
    #[inline(always)]
    pub fn advance(&mut self, impulse: R) {
        self.solver.changes();
        if self.scale.is_none() {
            let velocity = worse(largest(self.points.v), largest(self.solver.update));
            self.scale = Some(Scale { impulse, velocity });
        }
        self.solver.apply(self.points);
    }
}

impl<R, S, C, const D: usize> Equations<R> for Coupled<'_, '_, '_, '_, R, S, C, D>
where
    R: Real,
    S: Particles<R, D>,
    C: Constraints<R, D> + ?Sized,
{
    type Error = ConstraintError<R>;

    fn residual(&mut self) -> R {
        let scale = self.scale.unwrap_or(Scale::ones());
        let residual = self.solver.residual(self.points, self.stage, scale);
        if self.scale.is_none() {
            return unmeasured(residual);
        }
        let velocities = matches!(self.stage, Stage::Velocities { .. });
        self.keeps_matrix = velocities && R::constant(16.0) * residual < self.before;
        self.before = residual;
        residual
    }

    fn update(&mut self) -> Result<(), ConstraintError<R>> {
        let impulse = if self.scale.is_none() { largest(self.solver.update) } else { R::zero() };
        if !self.keeps_matrix {
            self.solver.linearise(self.points, self.stage)?;
        }
        self.advance(impulse);
        Ok(())
    }
}

/// 1, or NaN if a residual is not finite: before the first update there is no scale to measure it by.
pub(super) fn unmeasured<R: Real>(residual: R) -> R {
    R::one() + residual * R::zero()
}
