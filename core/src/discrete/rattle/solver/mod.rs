mod block;
mod coupled;

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
        let nodes = coupled(mechanism.system().nodes(), mechanism.equations());
        Ok(Self {
            mechanism,
            newton,
            scratch: workspace.numbers(mechanism.system().workspace()),
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
        system.l_q(points.q, self.scratch, points.internal);
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
        let (system, half) = (self.mechanism.system(), h.half());
        kick(points, force, half);
        let positions = self.solve(points, Stage::Positions { h })?;
        self.drift(points, h);
        system.l_q(points.q, self.scratch, points.internal);
        kick(points, force, half);
        let velocities = self.solve(points, Stage::Velocities { half })?;
        self.drag(points, half);
        Ok(positions.worse(velocities))
    }

    /// p += ½h Q(v); Q also joins the internal forces, for the next kick.
    fn drag(&self, points: &mut Points<R, D>, half: R) {
        let momenta = points.p.iter_mut().zip(points.p_carry.iter_mut()).zip(points.internal.iter_mut());
        let mut momenta = momenta.map(|((p, carry), internal)| (p, carry, internal));
        for (block, v) in points.v.chunks(BLOCK).enumerate() {
            let mut drags = [[R::zero(); D]; BLOCK];
            self.mechanism.system().drags(block * BLOCK, v, &mut drags);
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

    fn solve(&mut self, points: &mut Points<R, D>, stage: Stage<R>) -> Result<Report<R>, ConstraintError<R>> {
        if self.mechanism.equations() == 0 {
            self.solve_nodes(points, stage)
        } else {
            self.solve_all(points, stage)
        }
    }
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
