mod block;
mod coupled;
mod motions;
mod sticking;

use super::Rattle;
use super::points::{Points, add, copy};
use super::stage::{BLOCK, Stage};
use crate::constraints::{Banded, Constrained, ConstraintError, Constraints, Workspace, at};
use crate::linear::{Matrix, add_scaled};
use crate::newton::{Newton, Report};
use crate::particles::Particles;
use crate::scalar::Real;

/// Solver of one step, in the caller's workspace.
pub(super) struct Solver<'m, 'r, R, S, C: ?Sized, const D: usize> {
    mechanism: &'m Constrained<'m, R, S, C, D>,
    newton: &'m Newton<R>,
    /// Workspace of the system, then that of friction that sticks.
    scratch: &'r mut [R],
    /// Positions q + hv, at which A₁ is taken and the constraints must hold; they then become the new q.
    trial: &'r mut [[R; D]],
    trial_carry: &'r mut [[R; D]],
    /// Residual of L_v(v), then the change of v that follows from it.
    update: &'r mut [[R; D]],
    inverses: &'r mut [Matrix<R, D>],
    matrix: Banded<'r, R>,
    /// Residual of the constraints as a velocity, then the change of Λ.
    multipliers: &'r mut [R],
}

impl<'m, 'r, R, S, C, const D: usize> Solver<'m, 'r, R, S, C, D>
where
    R: Real,
    S: Particles<R, D>,
    C: Constraints<R, D> + ?Sized,
{
    pub fn new(
        mechanism: &'m Constrained<'m, R, S, C, D>,
        newton: &'m Newton<R>,
        workspace: &'r mut [R],
    ) -> Result<Self, ConstraintError<R>> {
        let mut workspace = Workspace::new(Rattle::workspace(mechanism), workspace)?;
        let (system, equations) = (mechanism.system(), mechanism.equations());
        let (nodes, begun) = if system.sticks() {
            (system.nodes(), sticking::memory::<D>(system.nodes(), equations))
        } else {
            (coupled(system.nodes(), equations), 0)
        };
        Ok(Self {
            mechanism,
            newton,
            scratch: workspace.numbers(system.workspace() + begun),
            trial: workspace.vectors(nodes),
            trial_carry: workspace.vectors(nodes),
            update: workspace.vectors(nodes),
            inverses: workspace.blocks(nodes),
            matrix: Banded::new(mechanism.band(), workspace.numbers(mechanism.matrix_workspace())),
            multipliers: workspace.numbers(mechanism.equations()),
        })
    }

    /// Completes a state that has q and v, with its velocities projected to A v = 0.
    pub fn start(&mut self, points: &mut Points<R, D>) -> Result<(), ConstraintError<R>> {
        let system = self.mechanism.system();
        copy(self.trial, points.q);
        self.trial_carry.fill([R::zero(); D]);
        points.q_carry.fill([R::zero(); D]);
        points.p_carry.fill([R::zero(); D]);
        points.lambda.fill(R::zero());
        system.momenta(0, points.v, points.p);
        self.l_q(points);
        self.solve(points, Stage::Velocities { half: R::zero() })?;
        self.drag(points, R::zero());
        Ok(())
    }

    /// Takes one step of order 2.
    pub fn step(
        &mut self,
        points: &mut Points<R, D>,
        force: Option<&[[R; D]]>,
        h: R,
    ) -> Result<Report<R>, ConstraintError<R>> {
        self.check_direction(h)?;
        kick(points, force, h.half());
        let positions = self.solve_line(points, Stage::Positions { h }, h.half())?;
        self.rest(points);
        self.drift(points, h);
        Ok(positions.worse(self.end(points, force, h.half())?))
    }

    /// Completes a state that has reached q₁ with the increment w, in `v`, by the second line of a step.
    pub fn arrive(
        &mut self,
        points: &mut Points<R, D>,
        force: Option<&[[R; D]]>,
        h: R,
    ) -> Result<(), ConstraintError<R>> {
        self.mechanism.system().momenta(0, points.v, points.p);
        copy(self.trial, points.q);
        self.trial_carry.fill([R::zero(); D]);
        self.end(points, force, h.half()).map(drop)
    }

    /// The second line of a step, at q₁.
    #[inline(always)]
    fn end(
        &mut self,
        points: &mut Points<R, D>,
        force: Option<&[[R; D]]>,
        half: R,
    ) -> Result<Report<R>, ConstraintError<R>> {
        self.l_q(points);
        kick(points, force, half);
        let report = self.solve_line(points, Stage::Velocities { half }, half)?;
        self.drag(points, half);
        self.rest(points);
        Ok(report)
    }

    /// Friction that sticks gives energy to a motion back in time.
    #[inline(always)]
    pub fn check_direction(&self, h: R) -> Result<(), ConstraintError<R>> {
        let goes = h > R::zero() || !self.mechanism.system().sticks();
        if goes { Ok(()) } else { Err(ConstraintError::Backward { h }) }
    }

    /// L_q at the present positions.
    #[inline(always)]
    fn l_q(&mut self, points: &mut Points<R, D>) {
        let system = self.mechanism.system();
        let scratch = if system.sticks() {
            self.scratch.get_mut(..system.workspace()).unwrap_or_default()
        } else {
            &mut *self.scratch
        };
        system.l_q(points.q, scratch, points.internal);
    }

    /// p += ½h Q(v); Q also joins the internal forces, for the next kick.
    fn drag(&self, points: &mut Points<R, D>, half: R) {
        let momenta = points.p.iter_mut().zip(points.p_carry.iter_mut()).zip(points.internal.iter_mut());
        let mut momenta = momenta.map(|((p, carry), internal)| (p, carry, internal));
        for (block, v) in points.v.chunks(BLOCK).enumerate() {
            let mut drags = [[R::zero(); D]; BLOCK];
            self.mechanism.system().single_valued_drags(block * BLOCK, v, &mut drags);
            for (drag, (p, carry, internal)) in drags.iter().zip(momenta.by_ref()) {
                add(p, carry, &drag.map(|q| half * q));
                *internal = add_scaled(internal, R::one(), drag);
            }
        }
    }

    /// q += hv.
    fn drift(&self, points: &mut Points<R, D>, h: R) {
        if self.mechanism.equations() > 0 {
            copy(points.q, self.trial);
            return copy(points.q_carry, self.trial_carry);
        }
        for ((q, carry), v) in points.q.iter_mut().zip(points.q_carry.iter_mut()).zip(points.v.iter()) {
            add(q, carry, &v.map(|v| h * v));
        }
    }

    /// Solves a line of a step in which friction that sticks gives impulses over the time `half`, s.
    #[inline(always)]
    fn solve_line(
        &mut self,
        points: &mut Points<R, D>,
        stage: Stage<R>,
        half: R,
    ) -> Result<Report<R>, ConstraintError<R>> {
        if self.mechanism.system().sticks() {
            self.solve_sticking(points, stage, half)
        } else {
            self.solve(points, stage)
        }
    }

    fn solve(&mut self, points: &mut Points<R, D>, stage: Stage<R>) -> Result<Report<R>, ConstraintError<R>> {
        if self.mechanism.equations() == 0 {
            self.solve_nodes(points, stage)
        } else {
            self.solve_all(points, stage)
        }
    }
}

/// Workspace of friction that sticks: what lines of a step begin with, and the nodes, which then are solved together.
pub(super) const fn sticking<const D: usize>(nodes: usize, equations: usize) -> usize {
    sticking::memory::<D>(nodes, equations) + (nodes - coupled(nodes, equations)) * solved::<D>()
}

/// Numbers that a node takes which is solved together with others.
pub(super) const fn solved<const D: usize>() -> usize {
    D * (3 + D)
}

/// Number of nodes that are solved together: all if there are constraints, else none.
pub(super) const fn coupled(nodes: usize, equations: usize) -> usize {
    if equations == 0 { 0 } else { nodes }
}

/// p += ½h (internal + f).
fn kick<R: Real, const D: usize>(points: &mut Points<R, D>, force: Option<&[[R; D]]>, half: R) {
    let momenta = points.p.iter_mut().zip(points.p_carry.iter_mut());
    for (node, ((p, carry), internal)) in momenta.zip(points.internal.iter()).enumerate() {
        let total = force.map_or(*internal, |force| add_scaled(internal, R::one(), &at(force, node)));
        add(p, carry, &total.map(|f| half * f));
    }
}
