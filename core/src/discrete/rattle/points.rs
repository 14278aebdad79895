use super::Rattle;
use super::solver::Solver;
use crate::constraints::{Constrained, ConstraintError, Constraints, Positions, Workspace, check_length};
use crate::particles::Particles;
use crate::scalar::{Compensated, Real, all_finite};

/// Positions and momenta of all nodes, both summed with compensation, and the quantities that follow from them.
#[derive(Debug)]
pub(super) struct Points<'a, R, const D: usize> {
    pub q: &'a mut [[R; D]],
    pub q_carry: &'a mut [[R; D]],
    pub p: &'a mut [[R; D]],
    pub p_carry: &'a mut [[R; D]],
    /// Velocities v, L_v(v) = p.
    pub v: &'a mut [[R; D]],
    /// Internal forces L_q(q) + Q(v), N; within a step L_q alone.
    pub internal: &'a mut [[R; D]],
    /// Constraint impulses during the step, N s; mean forces after it, N.
    pub lambda: &'a mut [R],
}

/// Adds to a vector that is stored as value and carry.
#[inline(always)]
pub(super) fn add<R: Real, const D: usize>(value: &mut [R; D], carry: &mut [R; D], increment: &[R; D]) {
    for i in 0..D {
        let sum = Compensated::from_parts(value[i], carry[i]).plus(increment[i]);
        (value[i], carry[i]) = (sum.value(), sum.carry());
    }
}

/// Copies vectors up to the end of the shorter slice.
pub(super) fn copy<R: Real, const D: usize>(to: &mut [[R; D]], from: &[[R; D]]) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to = *from);
}

impl<'a, R: Real, const D: usize> Points<'a, R, D> {
    /// q with its carry.
    #[inline(always)]
    pub fn positions(&self) -> Positions<'_, R, D> {
        Positions::with_carry(self.q, self.q_carry)
    }

    const fn workspace(nodes: usize, equations: usize) -> usize {
        6 * nodes * D + equations
    }

    fn over(nodes: usize, equations: usize, workspace: &mut Workspace<'a, R>) -> Self {
        let [q, q_carry, p, p_carry, v, internal] = core::array::from_fn(|_| workspace.vectors(nodes));
        Self { q, q_carry, p, p_carry, v, internal, lambda: workspace.numbers(equations) }
    }

    /// Sets positions, and all sums to begin anew.
    pub fn begin_at(&mut self, q: &[[R; D]]) {
        copy(self.q, q);
        self.q_carry.fill([R::zero(); D]);
        self.p_carry.fill([R::zero(); D]);
        self.lambda.fill(R::zero());
    }

    pub fn copy(&mut self, other: &Self) {
        let from = [&*other.q, other.q_carry, other.p, other.p_carry, other.v, other.internal];
        let to = [&mut *self.q, self.q_carry, self.p, self.p_carry, self.v, self.internal];
        for (to, from) in to.into_iter().zip(from) {
            copy(to, from);
        }
    }

    /// Turns impulses into mean forces over h, and checks that the result of the step is finite.
    pub fn finish(&mut self, h: R) -> Result<(), ConstraintError<R>> {
        self.lambda.iter_mut().for_each(|lambda| *lambda = *lambda / h);
        let finite = self.q.iter().all(all_finite)
            && self.p.iter().all(all_finite)
            && self.internal.iter().all(all_finite)
            && self.lambda.iter().all(|lambda| lambda.is_finite());
        if finite { Ok(()) } else { Err(ConstraintError::NotFinite) }
    }
}

/// State of one constrained system, in the caller's workspace. On the chip the workspace is an array of length
/// [`ParticleState::workspace`], on the host a vector.
#[derive(Debug)]
pub struct ParticleState<'a, R, const D: usize> {
    pub(super) now: Points<'a, R, D>,
    /// Memory in which the next step is made.
    pub(super) next: Points<'a, R, D>,
}

impl<'a, R: Real, const D: usize> ParticleState<'a, R, D> {
    /// Workspace length of a state.
    pub const fn workspace(nodes: usize, equations: usize) -> usize {
        2 * Points::<R, D>::workspace(nodes, equations)
    }

    /// Creates a state at positions q, m, that satisfy the constraints, with velocities v, m/s. The first step
    /// removes a remaining φ of up to √ε of its length. The part of v that violates A v = 0 is removed at once,
    /// by impulses of the constraints.
    ///
    /// `state` is the memory of the state ([`ParticleState::workspace`]); `workspace` is used only during the call ([`Rattle::workspace`]).
    pub fn new<S, C>(
        mechanism: &Constrained<R, S, C, D>,
        q: &[[R; D]],
        v: &[[R; D]],
        state: &'a mut [R],
        workspace: &mut [R],
    ) -> Result<Self, ConstraintError<R>>
    where
        S: Particles<R, D>,
        C: Constraints<R, D> + ?Sized,
    {
        let mut all = Self::over(mechanism, state)?;
        all.restart(mechanism, [q, v], workspace)?;
        Ok(all)
    }

    /// Creates an unknown state: positions are NaN, and every step is refused.
    pub(crate) fn unknown<S, C>(
        mechanism: &Constrained<R, S, C, D>,
        state: &'a mut [R],
    ) -> Result<Self, ConstraintError<R>>
    where
        S: Particles<R, D>,
        C: Constraints<R, D> + ?Sized,
    {
        let mut all = Self::over(mechanism, state)?;
        all.forget();
        Ok(all)
    }

    /// Makes the state unknown.
    pub(crate) fn forget(&mut self) {
        for vectors in [&mut *self.now.q, self.now.p, self.now.v] {
            vectors.fill([R::constant(f64::NAN); D]);
        }
    }

    /// [`ParticleState::new`] in the memory of this state, which is unchanged after an error.
    pub(crate) fn restart<S, C>(
        &mut self,
        mechanism: &Constrained<R, S, C, D>,
        [q, v]: [&[[R; D]]; 2],
        workspace: &mut [R],
    ) -> Result<(), ConstraintError<R>>
    where
        S: Particles<R, D>,
        C: Constraints<R, D> + ?Sized,
    {
        check_start(mechanism, q)?;
        mechanism.check_nodes(v)?;
        copy(self.next.q, q);
        copy(self.next.v, v);
        Solver::new(mechanism, &Rattle::default_newton(), workspace)?.start(&mut self.next)?;
        self.next.finish(R::one())?;
        self.next.lambda.fill(R::zero());
        self.swap();
        Ok(())
    }

    /// Lays an uninitialised state over the memory `state`.
    pub(super) fn over<S, C>(
        mechanism: &Constrained<R, S, C, D>,
        state: &'a mut [R],
    ) -> Result<Self, ConstraintError<R>>
    where
        S: Particles<R, D>,
        C: Constraints<R, D> + ?Sized,
    {
        let (nodes, equations) = (mechanism.system().nodes(), mechanism.equations());
        let mut pieces = Workspace::new(Self::workspace(nodes, equations), state)?;
        let now = Points::over(nodes, equations, &mut pieces);
        Ok(Self { now, next: Points::over(nodes, equations, &mut pieces) })
    }

    /// Length of a saved state, in numbers.
    pub const fn saved(nodes: usize, equations: usize) -> usize {
        Points::<R, D>::workspace(nodes, equations)
    }

    /// Writes the present state as numbers from which [`ParticleState::resume`] continues with the same bits: q
    /// (m) and its carry, p (kg m/s) and its carry, v (m/s), L_q(q) + Q(v) (N), each of them node by node, then
    /// λ (N).
    ///
    /// # Errors
    /// [`ConstraintError::Shape`] unless `numbers` has the length [`ParticleState::saved`].
    pub fn save(&self, numbers: &mut [R]) -> Result<(), ConstraintError<R>> {
        let now = &self.now;
        check_length(numbers, Self::saved(now.q.len(), now.lambda.len()))?;
        let vectors = [&*now.q, now.q_carry, now.p, now.p_carry, now.v, now.internal];
        let all = vectors.into_iter().flat_map(|x| x.as_flattened()).chain(now.lambda.iter());
        numbers.iter_mut().zip(all).for_each(|(to, from)| *to = *from);
        Ok(())
    }

    /// Restores a state of this system that [`ParticleState::save`] wrote; `state` is its memory ([`ParticleState::workspace`]). The
    /// constraints are not checked again.
    ///
    /// # Errors
    /// [`ConstraintError::Shape`] if the length of `numbers` does not fit the system, [`ConstraintError::NotFinite`] if a number is
    /// infinite or NaN, [`ConstraintError::Workspace`] if `state` is too short.
    pub fn resume<S, C>(
        mechanism: &Constrained<R, S, C, D>,
        numbers: &[R],
        state: &'a mut [R],
    ) -> Result<Self, ConstraintError<R>>
    where
        S: Particles<R, D>,
        C: Constraints<R, D> + ?Sized,
    {
        check_length(numbers, Self::saved(mechanism.system().nodes(), mechanism.equations()))?;
        if !numbers.iter().all(|x| x.is_finite()) {
            return Err(ConstraintError::NotFinite);
        }
        // The present state lies at the front, in the order of the numbers.
        state.iter_mut().zip(numbers).for_each(|(to, from)| *to = *from);
        Self::over(mechanism, state)
    }

    /// Positions q, m.
    pub fn q(&self) -> &[[R; D]] {
        self.now.q
    }

    /// Carry of q, the part lost to rounding, m: the exact sum is close to q + carry.
    pub fn q_carry(&self) -> &[[R; D]] {
        self.now.q_carry
    }

    /// Velocities v, m/s: L_v(v) = p.
    pub fn v(&self) -> &[[R; D]] {
        self.now.v
    }

    /// Momenta p, kg m/s.
    pub fn p(&self) -> &[[R; D]] {
        self.now.p
    }

    /// Carry of p, the part lost to rounding, kg m/s.
    pub fn p_carry(&self) -> &[[R; D]] {
        self.now.p_carry
    }

    /// Multipliers λ, N, means over the last step: Aᵀλ are the constraint forces. Zero before the first step.
    pub fn lambda(&self) -> &[R] {
        self.now.lambda
    }

    /// Copies the present state to the memory of the next step and returns that memory; an error if the state
    /// belongs to another system.
    pub(super) fn copied<S, C>(
        &mut self,
        mechanism: &Constrained<R, S, C, D>,
    ) -> Result<&mut Points<'a, R, D>, ConstraintError<R>>
    where
        S: Particles<R, D>,
        C: Constraints<R, D> + ?Sized,
    {
        mechanism.check_nodes(self.now.q)?;
        mechanism.check_equations(self.now.lambda)?;
        self.next.copy(&self.now);
        self.next.lambda.fill(R::zero());
        Ok(&mut self.next)
    }

    /// Makes the next step the present one.
    pub(super) fn swap(&mut self) {
        core::mem::swap(&mut self.now, &mut self.next);
    }
}

/// Checks positions at a start: an error if |φ| is more than √ε of its length, or not finite.
pub(super) fn check_start<R, S, C, const D: usize>(
    mechanism: &Constrained<R, S, C, D>,
    q: &[[R; D]],
) -> Result<(), ConstraintError<R>>
where
    R: Real,
    S: Particles<R, D>,
    C: Constraints<R, D> + ?Sized,
{
    mechanism.check_nodes(q)?;
    let (constraints, x) = (mechanism.constraints(), Positions::new(q));
    let (mut constraint, mut residual) = (0, R::zero());
    for k in 0..constraints.equations() {
        let off = constraints.value(k, x).abs() / constraints.size(k);
        if !off.is_finite() {
            return Err(ConstraintError::NotFinite);
        }
        if off > residual {
            (constraint, residual) = (k, off);
        }
    }
    if residual > R::EPSILON.sqrt() { Err(ConstraintError::Off { constraint, residual }) } else { Ok(()) }
}
