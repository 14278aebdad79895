//! Dry friction that sticks, in both lines of a step with constraints.

use super::Solver;
use super::coupled::{Coupled, unmeasured};
use crate::constraints::{ConstraintError, Constraints, Workspace, at};
use crate::discrete::contact::slack;
use crate::discrete::motion::Motion;
use crate::discrete::rattle::points::{Points, add, copy};
use crate::discrete::rattle::stage::{BLOCK, Scale, Stage, largest, size, worse};
use crate::forces::Grip;
use crate::linear::{Matrix, add_scaled};
use crate::newton::{Equations, Newton, Report, StepError, relative};
use crate::particles::Particles;
use crate::scalar::Real;

/// Numbers of the workspace in which a line of a step with friction begins anew.
pub(in crate::discrete::rattle) const fn memory<const D: usize>(nodes: usize, equations: usize) -> usize {
    4 * nodes * D + equations
}

/// Momenta, velocities and impulses with which a line of a step begins, and the motions that it is solved for.
pub(super) struct Begun<'f, R, const D: usize> {
    pub v: &'f mut [[R; D]],
    p: &'f mut [[R; D]],
    p_carry: &'f mut [[R; D]],
    pub lambda: &'f mut [R],
    /// The sign of a coordinate's motion, by half where that of the opposite direction was contradicted; 0 where it sticks.
    pub direction: &'f mut [[R; D]],
}

impl<'f, R: Real, const D: usize> Begun<'f, R, D> {
    fn new(points: &Points<R, D>, memory: &'f mut [R]) -> Result<Self, ConstraintError<R>> {
        let (nodes, equations) = (points.v.len(), points.lambda.len());
        let mut pieces = Workspace::new(self::memory::<D>(nodes, equations), memory)?;
        let [v, p, p_carry, direction] = core::array::from_fn(|_| pieces.vectors(nodes));
        let mut own = Self { v, p, p_carry, lambda: pieces.numbers(equations), direction };
        let from = [&*points.v, points.p, points.p_carry];
        for (to, from) in [&mut *own.v, own.p, own.p_carry].into_iter().zip(from) {
            copy(to, from);
        }
        own.look();
        own.lambda.iter_mut().zip(points.lambda.iter()).for_each(|(to, from)| *to = *from);
        Ok(own)
    }

    /// Sets the motions that the velocities show.
    fn look(&mut self) {
        for (direction, v) in self.direction.iter_mut().zip(self.v.iter()) {
            *direction = v.map(sign);
        }
    }
}

/// Equations of a line of a step with friction, for motions that they revise.
pub(super) struct Sticking<'e, 'm, 'r, 'p, 'f, R, S, C: ?Sized, const D: usize> {
    pub coupled: Coupled<'e, 'm, 'r, 'p, R, S, C, D>,
    pub begun: Begun<'f, R, D>,
    /// Time, s, over which friction gives its impulse.
    half: R,
    /// The last residual since the motions were revised.
    before: R,
    /// Number of revisions.
    pub revisions: usize,
    /// Whether the last evaluation revised the motions.
    revised: bool,
}

impl<R, S, C, const D: usize> Solver<'_, '_, R, S, C, D>
where
    R: Real,
    S: Particles<R, D>,
    C: Constraints<R, D> + ?Sized,
{
    /// Solves for velocities, impulses and motions together.
    #[inline(never)]
    pub(super) fn solve_sticking(
        &mut self,
        points: &mut Points<R, D>,
        stage: Stage<R>,
        half: R,
    ) -> Result<Report<R>, ConstraintError<R>> {
        let scratch = core::mem::take(&mut self.scratch);
        let memory = scratch.get_mut(self.mechanism.system().workspace()..).unwrap_or_default();
        let newton = self.newton;
        let report = Begun::new(points, memory).and_then(|begun| {
            let coupled = Coupled::new(self, points, stage);
            let before = R::one();
            Sticking { coupled, begun, half, before, revisions: 0, revised: false }.solve(newton)
        });
        self.scratch = scratch;
        report
    }

    /// Gives coordinates at rest that have friction the momentum of rest: L_v(v)_i, to the last bit.
    #[inline(always)]
    pub(super) fn rest(&self, points: &mut Points<R, D>) {
        let system = self.mechanism.system();
        if !system.sticks() {
            return;
        }
        let mut momenta = points.p.iter_mut().zip(points.p_carry.iter_mut());
        for (block, v) in points.v.chunks(BLOCK).enumerate() {
            let mut l_v = [[R::zero(); D]; BLOCK];
            let l_v = l_v.get_mut(..v.len()).unwrap_or_default();
            system.momenta(block * BLOCK, v, l_v);
            let nodes = (block * BLOCK..).zip(v.iter().zip(l_v));
            for ((node, (v, l_v)), (p, carry)) in nodes.zip(momenta.by_ref()) {
                let grips = system.grips(node);
                for i in (0..D).filter(|i| v[*i] == R::zero() && has_friction(&grips[*i])) {
                    (p[i], carry[i]) = (l_v[i], R::zero());
                }
            }
        }
    }
}

pub(super) fn has_friction<R: Real>(grip: &Grip<R>) -> bool {
    Motion::shown(grip, R::zero()) == Motion::Sticks
}

impl<R, S, C, const D: usize> Sticking<'_, '_, '_, '_, '_, R, S, C, D>
where
    R: Real,
    S: Particles<R, D>,
    C: Constraints<R, D> + ?Sized,
{
    /// Solves the line. Rest that lasts takes one evaluation and no update.
    fn solve(&mut self, newton: &Newton<R>) -> Result<Report<R>, ConstraintError<R>> {
        self.begin();
        if self.all_rest() {
            if !self.evaluated().is_finite() {
                return Err(ConstraintError::NotFinite);
            }
            if !self.revise() {
                return Ok(Report::nothing());
            }
            self.begin();
        }
        let report = newton.solve(self)?;
        if self.revised || self.revise() {
            return Err(StepError::NotConverged(report).into());
        }
        self.settle();
        Ok(report)
    }

    /// Number of coordinates.
    pub fn coordinates(&self) -> usize {
        self.begun.v.len() * D
    }

    /// Largest impulses and motions of a node.
    #[inline(always)]
    pub fn motions(&self, node: usize) -> ([Grip<R>; D], [Motion; D]) {
        let grips = self.coupled.solver.mechanism.system().grips(node).map(|grip| grip.over(self.half));
        let direction = at(self.begun.direction, node);
        (grips, core::array::from_fn(|i| Motion::shown(&grips[i], direction[i])))
    }

    fn all_rest(&self) -> bool {
        (0..self.begun.v.len()).all(|node| self.motions(node).1 == [Motion::Sticks; D])
    }

    /// Begins the line anew with the present motions: what slides has its impulse, and what sticks has no velocity.
    fn begin(&mut self) {
        for node in 0..self.begun.v.len() {
            let (grips, motions) = self.motions(node);
            let impulse = core::array::from_fn(|i| motions[i].sliding(&grips[i]));
            let (begun, points) = (&self.begun, &mut *self.coupled.points);
            let places = (points.v.get_mut(node), points.p.get_mut(node), points.p_carry.get_mut(node));
            let (Some(v), Some(p), Some(carry)) = places else { return };
            (*v, *p, *carry) = (at(begun.v, node), at(begun.p, node), at(begun.p_carry, node));
            add(p, carry, &impulse);
            for i in (0..D).filter(|i| motions[*i] == Motion::Sticks) {
                v[i] = R::zero();
            }
        }
        let lambda = self.coupled.points.lambda.iter_mut();
        lambda.zip(self.begun.lambda.iter()).for_each(|(to, from)| *to = *from);
        self.coupled.scale = None;
    }

    /// Writes the residuals of all equations, of those too that do not hold where a coordinate sticks, and returns the largest of those that
    /// hold; not finite if any is not.
    fn evaluated(&mut self) -> R {
        let Coupled { solver, points, stage, scale, .. } = &mut self.coupled;
        let all = solver.residual(points, *stage, scale.unwrap_or(Scale::ones()));
        self.measured(all)
    }

    /// Replaces the equation of momentum of what sticks: its velocity, 0, does not change.
    fn hold(&mut self) {
        for node in 0..self.begun.v.len() {
            let r = self.moving(node, &at(self.coupled.solver.update, node));
            if let Some(place) = self.coupled.solver.update.get_mut(node) {
                *place = r;
            }
        }
    }

    /// The largest relative residual of the equations that hold, from the residuals of all; 1 before the first update.
    fn measured(&self, all: R) -> R {
        let Coupled { solver, points, scale, .. } = &self.coupled;
        let Some(scale) = scale else { return unmeasured(all) };
        let momenta = solver.update.iter().zip(points.p.iter()).enumerate();
        let worst = momenta.fold(all * R::zero(), |worst, (node, (r, p))| {
            let r = self.moving(node, r);
            worse(worst, relative(size(&r), size(p) + size(p) + scale.impulse))
        });
        let rods = solver.multipliers.iter().enumerate().filter(|(k, _)| !solver.matrix.is_dependent(*k));
        rods.fold(worst, |worst, (_, c)| worse(worst, relative(c.abs(), scale.velocity)))
    }

    /// Components of a node's vector where it does not stick.
    #[inline(always)]
    fn moving(&self, node: usize, x: &[R; D]) -> [R; D] {
        let motions = self.motions(node).1;
        core::array::from_fn(|i| if motions[i] == Motion::Sticks { R::zero() } else { x[i] })
    }

    /// Velocity, m/s, that rounding hides.
    pub fn still(&self) -> R {
        let velocity = self.coupled.scale.map_or(R::zero(), |scale| scale.velocity);
        R::constant(4.0) * slack(velocity)
    }

    /// Removes the coordinates that stick from the blocks M⁻¹, and factors A₁ M⁻¹ A₀ᵀ. An equation that no coordinate can solve any more, or
    /// that follows from others, gets no impulse.
    fn linearise(&mut self) -> Result<(), ConstraintError<R>> {
        let Coupled { solver, points, stage, .. } = &mut self.coupled;
        solver.invert_masses(points, *stage)?;
        solver.couple(points, true);
        for node in 0..self.begun.v.len() {
            let motions = self.motions(node).1;
            if let Some(inverse) = self.coupled.solver.inverses.get_mut(node) {
                for i in (0..D).filter(|i| motions[*i] == Motion::Sticks) {
                    *inverse = without(inverse, i);
                }
            }
        }
        let Coupled { solver, points, .. } = &mut self.coupled;
        solver.couple(points, false);
        solver.matrix.factor_independent().map_err(|_| ConstraintError::NotFinite)
    }

    /// Sets velocities that are no more than rounding to 0: rods hold these coordinates, with friction at its level.
    fn settle(&mut self) {
        let still = self.still();
        for node in 0..self.begun.v.len() {
            let (grips, _) = self.motions(node);
            if let Some(v) = self.coupled.points.v.get_mut(node) {
                *v = core::array::from_fn(|i| {
                    let rests = v[i].abs() <= still && has_friction(&grips[i]);
                    if rests { R::zero() } else { v[i] }
                });
            }
        }
        let Coupled { solver, points, stage, .. } = &mut self.coupled;
        if let Stage::Positions { h } = *stage {
            solver.move_trial(points, h);
        }
    }
}

/// −1, 0 or 1.
pub(super) fn sign<R: Real>(x: R) -> R {
    if x > R::zero() {
        R::one()
    } else if x < R::zero() {
        -R::one()
    } else {
        R::zero()
    }
}

/// The inverse of M without row and column i, from that of M: 0 in row and column i.
fn without<R: Real, const D: usize>(inverse: &Matrix<R, D>, i: usize) -> Matrix<R, D> {
    core::array::from_fn(|row| {
        let left = add_scaled(&inverse[row], -inverse[row][i] / inverse[i][i], &inverse[i]);
        core::array::from_fn(|column| if row == i || column == i { R::zero() } else { left[column] })
    })
}

impl<R, S, C, const D: usize> Equations<R> for Sticking<'_, '_, '_, '_, '_, R, S, C, D>
where
    R: Real,
    S: Particles<R, D>,
    C: Constraints<R, D> + ?Sized,
{
    type Error = ConstraintError<R>;

    fn residual(&mut self) -> R {
        let residual = self.evaluated();
        let before = core::mem::replace(&mut self.before, residual);
        // A descent judges solutions alone: what Newton's method still leaves may look like a motion.
        let solved = !self.descends() || residual > before.half() || residual <= R::EPSILON;
        let judged = self.coupled.scale.is_some() && self.revisions < self.most_revisions();
        self.revised = judged && solved && self.revise();
        if !self.revised {
            return residual;
        }
        self.begin();
        self.before = R::one();
        self.evaluated()
    }

    fn revised(&self) -> bool {
        self.revised
    }

    fn update(&mut self) -> Result<(), ConstraintError<R>> {
        self.hold();
        let impulse = largest(self.coupled.solver.update);
        self.linearise()?;
        self.coupled.advance(impulse);
        Ok(())
    }
}
