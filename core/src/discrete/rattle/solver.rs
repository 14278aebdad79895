use super::Rattle;
use super::points::{Points, add, copy};
use super::stage::{BLOCK, Scale, Stage, largest, size, worse};
use crate::constraints::{
    Banded, Constrained, ConstraintError, Constraints, Positions, Rows, Workspace, at, inverse,
};
use crate::linear::{Matrix, add_scaled, multiply, solve_definite};
use crate::newton::{Equations, Newton, Report, relative};
use crate::particles::Particles;
use crate::scalar::Real;

/// One step in the caller's workspace.
pub(super) struct Solver<'m, 'r, R, S, C: ?Sized, const D: usize> {
    mechanism: &'m Constrained<'m, R, S, C, D>,
    newton: &'m Newton<R>,
    scratch: &'r mut [R],
    /// Where the constraints are to hold, of A₁: q + hv, and then the q that it has become.
    trial: &'r mut [[R; D]],
    trial_carry: &'r mut [[R; D]],
    /// Residual of L_v(v), then the change of v that it asks for.
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

    /// Fills a state, its velocities projected to A v = 0.
    pub fn start(
        &mut self,
        points: &mut Points<R, D>,
        q: &[[R; D]],
        v: &[[R; D]],
    ) -> Result<(), ConstraintError<R>> {
        let system = self.mechanism.system();
        copy(points.q, q);
        copy(points.v, v);
        copy(self.trial, q);
        self.trial_carry.fill([R::zero(); D]);
        points.q_carry.fill([R::zero(); D]);
        points.p_carry.fill([R::zero(); D]);
        points.lambda.fill(R::zero());
        system.momenta(0, v, points.p);
        system.l_q(q, self.scratch, points.internal);
        self.solve(points, Stage::Velocities { half: R::zero() })?;
        self.drag(points, R::zero());
        Ok(())
    }

    /// One step of order 2.
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

    /// p += ½h Q(v); and Q joins the internal forces, for the next kick.
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

    /// Block by block, where nothing couples nodes.
    #[inline(never)]
    fn solve_nodes(
        &self,
        points: &mut Points<R, D>,
        stage: Stage<R>,
    ) -> Result<Report<R>, ConstraintError<R>> {
        let mut worst = Report::nothing();
        for (block, (v, p)) in points.v.chunks_mut(BLOCK).zip(points.p.chunks(BLOCK)).enumerate() {
            let mut block = Block::new(self.mechanism.system(), stage, block * BLOCK, v, p);
            worst = worst.worse(self.newton.solve(&mut block)?);
        }
        Ok(worst)
    }

    /// Velocities and impulses together.
    #[inline(never)]
    fn solve_all(
        &mut self,
        points: &mut Points<R, D>,
        stage: Stage<R>,
    ) -> Result<Report<R>, ConstraintError<R>> {
        let newton = self.newton;
        newton.solve(&mut Coupled {
            solver: self,
            points,
            stage,
            scale: None,
            keeps_matrix: false,
            before: R::one(),
        })
    }

    /// Writes what is left of both equations; the largest relative to the size of its terms.
    fn residual(&mut self, points: &Points<R, D>, stage: Stage<R>, scale: Scale<R>) -> R {
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

    /// Trial positions q + hv.
    fn move_trial(&mut self, points: &Points<R, D>, h: R) {
        let start = points.q.iter().zip(points.q_carry.iter()).zip(points.v.iter());
        let trial = self.trial.iter_mut().zip(self.trial_carry.iter_mut());
        for ((q, carry), ((q0, carry0), v)) in trial.zip(start) {
            (*q, *carry) = (*q0, *carry0);
            add(q, carry, &v.map(|v| h * v));
        }
    }

    /// Inverts M for each node, and factors A₁ M⁻¹ A₀ᵀ.
    fn linearise(&mut self, points: &Points<R, D>, stage: Stage<R>) -> Result<(), ConstraintError<R>> {
        let system = self.mechanism.system();
        let blocks = points.v.chunks(BLOCK).zip(self.inverses.chunks_mut(BLOCK));
        for (block, (v, masses)) in blocks.enumerate() {
            stage.effective_masses(system, block * BLOCK, v, masses);
        }
        for (node, mass) in self.inverses.iter_mut().enumerate() {
            *mass = inverse(*mass).ok_or(ConstraintError::Mass { node })?;
        }
        let (constraints, inverses) = (self.mechanism.constraints(), &self.inverses);
        let left = Rows { constraints, x: Positions::with_carry(self.trial, self.trial_carry) };
        let right = Rows { constraints, x: points.positions() };
        self.matrix.set(|k, l| left.coupling(k, inverses, &right, l));
        self.matrix.factor().map_err(|constraint| ConstraintError::Redundant { constraint })
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
struct Coupled<'e, 'm, 'r, 'p, R, S, C: ?Sized, const D: usize> {
    solver: &'e mut Solver<'m, 'r, R, S, C, D>,
    points: &'e mut Points<'p, R, D>,
    stage: Stage<R>,
    /// None before the first update.
    scale: Option<Scale<R>>,
    /// Whether the next update keeps the matrix: for velocities as long as the residual falls, for of quadratic energies they
    /// are linear; never for positions, where what an old matrix leaves has one sign and in f32 the energy drifts ten times
    /// as far.
    keeps_matrix: bool,
    /// The last residual.
    before: R,
}

impl<R, S, C, const D: usize> Equations<R> for Coupled<'_, '_, '_, '_, R, S, C, D>
where
    R: Real,
    S: Particles<R, D>,
    C: Constraints<R, D> + ?Sized,
{
    type Error = ConstraintError<R>;

    fn residual(&mut self) -> R {
        let scale = self.scale.unwrap_or(Scale { impulse: R::one(), velocity: R::one() });
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
        self.solver.changes();
        if self.scale.is_none() {
            let velocity = worse(largest(self.points.v), largest(self.solver.update));
            self.scale = Some(Scale { impulse, velocity });
        }
        self.solver.apply(self.points);
        Ok(())
    }
}

/// 1, or not a number where a residual is not finite: before the first update there is no scale to measure it with.
fn unmeasured<R: Real>(residual: R) -> R {
    R::one() + residual * R::zero()
}

/// Nodes that are evaluated side by side.
struct Block<'e, R, S, const D: usize> {
    system: &'e S,
    stage: Stage<R>,
    /// Number of the first node.
    first: usize,
    v: &'e mut [[R; D]],
    p: &'e [[R; D]],
    /// What is left of the momenta, and the size of its terms.
    r: [[R; D]; BLOCK],
    terms: [R; BLOCK],
    /// The largest size of terms so far, and of what was left.
    scale: [R; BLOCK],
}

impl<'e, R: Real, S, const D: usize> Block<'e, R, S, D> {
    fn new(system: &'e S, stage: Stage<R>, first: usize, v: &'e mut [[R; D]], p: &'e [[R; D]]) -> Self {
        let zero = [R::zero(); BLOCK];
        Self { system, stage, first, v, p, r: [[R::zero(); D]; BLOCK], terms: zero, scale: zero }
    }
}

impl<R: Real, S: Particles<R, D>, const D: usize> Equations<R> for Block<'_, R, S, D> {
    type Error = ConstraintError<R>;

    #[inline(always)]
    fn residual(&mut self) -> R {
        let Self { system, stage, first, v, p, r, terms, scale } = self;
        stage.imbalances(*system, *first, (v, p), (&mut *r, &mut *terms));
        let mut worst = R::zero();
        for (((r, terms), scale), _) in r.iter().zip(&*terms).zip(scale).zip(&**v) {
            *scale = worse(*scale, *terms + size(r));
            worst = worse(worst, relative(size(r), *scale));
        }
        worst
    }

    /// v += M⁻¹r.
    #[inline(always)]
    fn update(&mut self) -> Result<(), ConstraintError<R>> {
        let mut masses = [[[R::zero(); D]; D]; BLOCK];
        self.stage.effective_masses(self.system, self.first, self.v, &mut masses);
        for (node, (v, (mass, r))) in (self.first..).zip(self.v.iter_mut().zip(masses.iter().zip(&self.r))) {
            let [change] = solve_definite(*mass, [*r]).map_err(|_| ConstraintError::Mass { node })?;
            *v = add_scaled(v, R::one(), &change);
        }
        Ok(())
    }
}

/// Nodes that are solved together: all where there are constraints.
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
