use super::{Balance, BubbleDerivatives, GaussPoint, Interval, Linearised, Path};
use crate::forces::{Forces, System};
use crate::lagrangian::Lagrangian;
use crate::linear::{
    Matrix, SolveError, add_scaled, add_scaled_matrix, dot, multiply, solve, solve_many, transpose,
};
use crate::newton::{Equations, Newton, Report, StepError, relative};
use crate::scalar::{Real, max_abs};

/// The solved path of a step.
#[derive(Clone, Copy, Debug)]
pub struct Solved<R, P, const N: usize> {
    /// The path.
    pub interval: Interval<R, P, N>,
    /// Sums of the path's equations.
    pub balance: Balance<R, N>,
    /// Report of Newton's method.
    pub report: Report<R>,
    /// Residual of the equations.
    pub(super) left: Residual<R, N>,
}

impl<R: Real, P: Path, const N: usize> Linearised<R, P, N> {
    /// Solves momentum_w dw + momentum_s ds = −r_momentum and bubble_w dw + bubble_s ds = −r_bubble for (dw, ds), eliminating ds.
    #[inline(always)]
    fn update(&self, r: &Residual<R, N>) -> Result<Update<R, N>, SolveError> {
        let minus = -R::one();
        let Some(blocks) = self.bubble.as_ref().first() else {
            return Ok((solve(self.momentum_w, r.momentum.map(|r| -r))?, [R::zero(); N]));
        };
        let [free] = solve_many(blocks.bubble_s, [r.bubble])?;
        let (slaved, reduced) = blocks.reduced(&self.momentum_w)?;
        let right = add_scaled(&multiply(&blocks.momentum_s, &free), minus, &r.momentum);
        let dw = solve(reduced, right)?;
        let ds = add_scaled(&free, R::one(), &multiply(&slaved, &dw)).map(|x| -x);
        Ok((dw, ds))
    }
}

impl<R: Real, const N: usize> BubbleDerivatives<R, N> {
    /// X = bubble_s⁻¹ bubble_w (the bubble follows by ds = −X dw), and the reduced matrix momentum_w − momentum_s X.
    pub fn reduced(&self, momentum_w: &Matrix<R, N>) -> Result<(Matrix<R, N>, Matrix<R, N>), SolveError> {
        let columns = solve_many(self.bubble_s, transpose(&self.bubble_w))?;
        let product = core::array::from_fn(|i| multiply(&columns, &self.momentum_s[i]));
        Ok((transpose(&columns), add_scaled_matrix(momentum_w, -R::one(), &product)))
    }
}

impl<R: Real> Newton<R> {
    /// Finds w and s such that p₀ + d1_ld = 0 and dm_ld = 0, from a guess.
    ///
    /// # Errors
    /// See [`Del::step`](super::Del::step).
    pub fn solve_step<L, F, P: Path, const N: usize>(
        &self,
        system: &System<L, F>,
        guess: Interval<R, P, N>,
        p0: &[R; N],
    ) -> Result<Solved<R, P, N>, StepError<R>>
    where
        L: Lagrangian<R, N>,
        F: Forces<R, N>,
    {
        self.solve_target(system, guess, &Target { p0: *p0, left: Residual::zero() })
    }

    /// [`Newton::solve_step`] with the residual that the previous step left over.
    pub(super) fn solve_target<L, F, P: Path, const N: usize>(
        &self,
        system: &System<L, F>,
        guess: Interval<R, P, N>,
        target: &Target<R, N>,
    ) -> Result<Solved<R, P, N>, StepError<R>>
    where
        L: Lagrangian<R, N>,
        F: Forces<R, N>,
    {
        StepEquations::<_, _, _, _, N, false>::new(system, guess, target).solved(self)
    }

    /// Finds s such that dm_ld = 0 on an interval with both ends given.
    ///
    /// # Errors
    /// See [`Del::step`](super::Del::step).
    pub fn solve_bubble<L, F, P: Path, const N: usize>(
        &self,
        system: &System<L, F>,
        guess: Interval<R, P, N>,
    ) -> Result<Solved<R, P, N>, StepError<R>>
    where
        L: Lagrangian<R, N>,
        F: Forces<R, N>,
    {
        if !P::BUBBLE {
            let balance = guess.balance(system);
            // 0, or NaN if a number is not finite.
            let residual = max_abs(&balance.end_momentum()) * R::zero();
            let report = self.accepted(Report { iterations: 0, residual })?;
            return Ok(Solved { interval: guess, balance, report, left: Residual::zero() });
        }
        let target = Target::zero();
        StepEquations::<_, _, _, _, N, true>::new(system, guess, &target).solved(self)
    }
}

/// The equations of a step in w and s; with `ENDS`, both ends are given and s alone is unknown.
pub(super) struct StepEquations<'a, R: Real, L, F, P: Path, const N: usize, const ENDS: bool> {
    pub system: &'a System<L, F>,
    target: &'a Target<R, N>,
    pub interval: Interval<R, P, N>,
    pub linearised: Linearised<R, P, N>,
    pub left: Residual<R, N>,
}

impl<'a, R, L, F, P, const N: usize, const ENDS: bool> StepEquations<'a, R, L, F, P, N, ENDS>
where
    R: Real,
    L: Lagrangian<R, N>,
    F: Forces<R, N>,
    P: Path,
{
    #[inline(always)]
    pub fn new(system: &'a System<L, F>, interval: Interval<R, P, N>, target: &'a Target<R, N>) -> Self {
        Self { system, target, interval, linearised: Linearised::zero(), left: Residual::zero() }
    }

    #[inline(always)]
    fn solved(mut self, newton: &Newton<R>) -> Result<Solved<R, P, N>, StepError<R>> {
        let report = newton.solve(&mut self)?;
        Ok(self.with_report(report))
    }

    #[inline(always)]
    pub fn with_report(self, report: Report<R>) -> Solved<R, P, N> {
        let Self { interval, linearised, left, .. } = self;
        Solved { interval, balance: linearised.balance, report, left }
    }
}

impl<R, L, F, P, const N: usize, const ENDS: bool> StepEquations<'_, R, L, F, P, N, ENDS>
where
    R: Real,
    L: Lagrangian<R, N>,
    F: Forces<R, N>,
    P: Path,
{
    /// Evaluates the equations and their matrix: the evaluation that measures one update also serves the next.
    #[inline(always)]
    pub fn evaluate(&mut self) {
        self.linearised = self.interval.linearise_without_l_qq(self.system);
        self.left = self.target.residual(&self.linearised.balance);
        if ENDS {
            self.left.momentum = [R::zero(); N];
        }
    }

    /// Sizes of the terms in the equations of momentum.
    #[inline(always)]
    pub fn size(&self) -> [R; N] {
        let (scale, p0) = (&self.linearised.scale, &self.target.p0);
        core::array::from_fn(|i| scale[i] + p0[i].abs())
    }

    /// The largest residual relative to the size of its terms.
    #[inline(always)]
    pub fn largest(&self) -> R {
        let (left, size) = (&self.left, self.size());
        max_abs::<R, N>(&core::array::from_fn(|i| {
            relative(left.momentum[i].abs() + left.bubble[i].abs(), size[i])
        }))
    }

    /// The change ds between two given ends.
    ///
    /// A growing bubble speeds up the early Gauss point and slows down the late one. Friction at the late point
    /// therefore works against the bubble, as inertia does, but friction at the early point works for it. Where
    /// friction bends sharply, the residual is no longer monotonic, and an update may lead the wrong way. The
    /// update is then repeated without the derivative of the early friction, which leads the right way, if less
    /// quickly.
    fn between_ends(&self) -> Result<[R; N], SolveError> {
        let right = self.left.bubble.map(|r| -r);
        let Some(BubbleDerivatives { bubble_s: matrix, .. }) = self.linearised.bubble.as_ref().first() else {
            return Ok([R::zero(); N]);
        };
        let ds = solve(*matrix, right);
        if ds.is_ok_and(|ds| dot(&ds, &right) > R::zero()) {
            return ds;
        }
        let early = self.interval.early_force_s(&self.system.forces);
        solve(add_scaled_matrix(matrix, -R::one(), &early), right)
    }
}

impl<R, L, F, P, const N: usize, const ENDS: bool> Equations<R> for StepEquations<'_, R, L, F, P, N, ENDS>
where
    R: Real,
    L: Lagrangian<R, N>,
    F: Forces<R, N>,
    P: Path,
{
    type Error = StepError<R>;

    #[inline(always)]
    fn residual(&mut self) -> R {
        self.evaluate();
        self.largest()
    }

    #[inline(always)]
    fn update(&mut self) -> Result<(), StepError<R>> {
        let (dw, ds) =
            if ENDS { ([R::zero(); N], self.between_ends()?) } else { self.linearised.update(&self.left)? };
        let trusted = |point: &GaussPoint<R>| !(ENDS && point.is_early());
        let part = self.interval.trusted_part(&self.system.forces, (&dw, &ds), trusted);
        self.interval = self.interval.moved_by(part, &dw, &ds);
        Ok(())
    }
}

/// An update (dw, ds).
type Update<R, const N: usize> = ([R; N], [R; N]);

/// Residuals of the two equations of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Residual<R, const N: usize> {
    pub momentum: [R; N],
    pub bubble: [R; N],
}

impl<R: Real, const N: usize> Residual<R, N> {
    pub fn zero() -> Self {
        Self { momentum: [R::zero(); N], bubble: [R::zero(); N] }
    }
}

/// Starting data of a step: p₀, and additions to the two equations, namely the rounding error of p₀ and the
/// residual that Newton's method left in the previous step. Carried over to the next step, these errors do not
/// add up. If they were dropped, they would have the sign of the force at every step, and over 10⁶ steps in f32
/// the energy would drift.
pub(super) struct Target<R, const N: usize> {
    pub p0: [R; N],
    pub left: Residual<R, N>,
}

impl<R: Real, const N: usize> Target<R, N> {
    pub fn zero() -> Self {
        Self { p0: [R::zero(); N], left: Residual::zero() }
    }

    fn residual(&self, balance: &Balance<R, N>) -> Residual<R, N> {
        Residual {
            momentum: core::array::from_fn(|i| self.p0[i] + balance.d1_ld[i] + self.left.momentum[i]),
            bubble: add_scaled(&balance.dm_ld, R::one(), &self.left.bubble),
        }
    }
}
