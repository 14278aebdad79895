use super::{Balance, Interval, Linearised, Path};
use crate::forces::{Forces, System};
use crate::lagrangian::Lagrangian;
use crate::linear::{
    Matrix, Singular, add_scaled, add_scaled_matrix, multiply, solve, solve_many, transpose,
};
use crate::scalar::{Real, max_abs};

/// The bounds of Newton's method. Residuals are relative: each component to the size of the terms it is the sum of
/// ([`Linearised::scale`] and the momentum).
///
/// At least one update is taken. Between `accept` and `stop` the iteration also ends where an update no longer halves the
/// residual: rounding allows no more.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Newton<R> {
    /// Updates at most; 0 only checks the guess.
    pub max_iterations: u8,
    /// Of these, updates by a Jacobian of their own, at least one; the others keep the last (the simplified Newton method: an
    /// update then costs a third, and takes an order of the guess's error less). [`Rattle`](super::rattle::Rattle) takes
    /// them all anew.
    pub max_jacobians: u8,
    /// Stop early at this residual; 0 always takes `max_iterations`, for a constant running time.
    pub stop: R,
    /// A step whose residual stays above is an error.
    pub accept: R,
}

impl<R: Real> Default for Newton<R> {
    /// At most 8 updates, each with its Jacobian, stopping at 2 rounding units, accepting up to the square root of one.
    fn default() -> Self {
        Self {
            max_iterations: 8,
            max_jacobians: 8,
            stop: R::constant(2.0) * R::EPSILON,
            accept: R::EPSILON.sqrt(),
        }
    }
}

/// How a step went.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report<R> {
    /// Newton updates taken.
    pub iterations: u8,
    /// Largest relative residual at the end.
    pub residual: R,
}

/// Why a step was refused; the state is as it was before.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepError<R> {
    /// The Newton matrix has no usable pivot.
    Singular(Singular),
    /// Positions, momenta, controls or energies are infinite or not numbers.
    NotFinite,
    /// The residual stayed above what is accepted.
    NotConverged(Report<R>),
}

impl<R> From<Singular> for StepError<R> {
    fn from(singular: Singular) -> Self {
        Self::Singular(singular)
    }
}

/// The solved path of a step.
#[derive(Clone, Copy, Debug)]
pub struct Solved<R, P, const N: usize> {
    /// The path.
    pub interval: Interval<R, P, N>,
    /// Its balance.
    pub balance: Balance<R, N>,
    /// How it was found.
    pub report: Report<R>,
    /// What is left of its equations.
    pub(super) owed: Residual<R, N>,
}

impl<R: Real, const N: usize> Linearised<R, N> {
    /// (dw, ds) with momentum_w dw + momentum_s ds = −r_momentum and bubble_w dw + bubble_s ds = −r_bubble, by eliminating
    /// ds.
    fn update(&self, r: &Residual<R, N>, bubble: bool) -> Result<Update<R, N>, Singular> {
        let minus = -R::one();
        if !bubble {
            return Ok((solve(self.momentum_w, r.momentum.map(|r| -r))?, [R::zero(); N]));
        }
        let [free] = solve_many(self.bubble_s, [r.bubble])?;
        let (slaved, reduced) = self.reduced()?;
        let right = add_scaled(&multiply(&self.momentum_s, &free), minus, &r.momentum);
        let dw = solve(reduced, right)?;
        let ds = add_scaled(&free, R::one(), &multiply(&slaved, &dw)).map(|x| -x);
        Ok((dw, ds))
    }

    /// The size of the terms of the equations from p₀.
    fn scale_beside(&self, p0: &[R; N]) -> [R; N] {
        core::array::from_fn(|i| self.scale[i] + p0[i].abs())
    }

    /// Adds the size of the terms that an update brings; from rest it brings all of them.
    fn add_moved(&self, scale: &mut [R; N], dw: &[R; N], ds: &[R; N]) {
        for (i, scale) in scale.iter_mut().enumerate() {
            for j in 0..N {
                *scale += (self.momentum_w[i][j] * dw[j]).abs() + (self.bubble_s[i][j] * ds[j]).abs();
            }
        }
    }

    /// X = bubble_s⁻¹ bubble_w (the bubble follows as ds = −X dw) and the reduced matrix momentum_w − momentum_s X.
    pub fn reduced(&self) -> Result<(Matrix<R, N>, Matrix<R, N>), Singular> {
        let columns = solve_many(self.bubble_s, transpose(&self.bubble_w))?;
        let product = core::array::from_fn(|i| multiply(&columns, &self.momentum_s[i]));
        Ok((transpose(&columns), add_scaled_matrix(&self.momentum_w, -R::one(), &product)))
    }
}

impl<R: Real> Newton<R> {
    /// Finds w and s such that p₀ + d1_ld = 0 and dm_ld = 0, from a guess.
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
        self.solve_target(system, guess, &Target { p0: *p0, owed: Residual::zero() })
    }

    /// [`Newton::solve_step`] towards equations to which earlier steps owe something.
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
        let residual = |balance: &Balance<R, N>| target.residual(balance);
        self.iterate(system, guess, &target.p0, residual, |linearised, r| linearised.update(r, P::BUBBLE))
    }

    /// Finds s such that dm_ld = 0 on an interval whose two ends are given.
    pub fn solve_bubble<L, F, P: Path, const N: usize>(
        &self,
        system: &System<L, F>,
        guess: Interval<R, P, N>,
    ) -> Result<Solved<R, P, N>, StepError<R>>
    where
        L: Lagrangian<R, N>,
        F: Forces<R, N>,
    {
        let zero = [R::zero(); N];
        if !P::BUBBLE {
            let balance = guess.balance(system);
            // 0, or NaN where a number is not finite.
            let residual = max_abs(&balance.end_momentum()) * R::zero();
            return self.judge(guess, balance, Residual::zero(), Report { iterations: 0, residual });
        }
        let residual = |balance: &Balance<R, N>| Residual { momentum: zero, bubble: balance.dm_ld };
        let update = |linearised: &Linearised<R, N>, r: &Residual<R, N>| {
            Ok((zero, solve(linearised.bubble_s, r.bubble.map(|r| -r))?))
        };
        self.iterate(system, guess, &zero, residual, update)
    }

    /// Linearise, update, measure; again until the residual is small or no longer falls.
    #[inline(always)]
    fn iterate<L, F, P: Path, const N: usize>(
        &self,
        system: &System<L, F>,
        guess: Interval<R, P, N>,
        p0: &[R; N],
        residual: impl Fn(&Balance<R, N>) -> Residual<R, N>,
        update: impl Fn(&Linearised<R, N>, &Residual<R, N>) -> Result<Update<R, N>, Singular>,
    ) -> Result<Solved<R, P, N>, StepError<R>>
    where
        L: Lagrangian<R, N>,
        F: Forces<R, N>,
    {
        let (mut interval, mut iterations) = (guess, 0);
        let mut linearised = interval.linearise(system);
        let mut r = residual(&linearised.balance);
        let mut scale = linearised.scale_beside(p0);
        let mut before = r.relative(&scale);
        while iterations < self.max_iterations && before.is_finite() {
            let (dw, ds) = update(&linearised, &r)?;
            linearised.add_moved(&mut scale, &dw, &ds);
            interval = interval.moved(&dw, &ds);
            iterations += 1;
            let anew = iterations < self.max_jacobians && iterations < self.max_iterations;
            // With a fixed number of updates there is nothing to decide between them.
            if self.stop > R::zero() || !anew {
                linearised.balance = interval.balance(system);
                r = residual(&linearised.balance);
                let after = r.relative(&scale);
                let settled = self.settled(before, after);
                before = after;
                if settled {
                    break;
                }
            }
            if anew {
                linearised = interval.linearise(system);
                r = residual(&linearised.balance);
                scale = linearised.scale_beside(p0);
                before = r.relative(&scale);
            }
        }
        self.judge(interval, linearised.balance, r, Report { iterations, residual: before })
    }

    /// Whether another update would be in vain: the residual is small enough, or acceptable and an update no longer
    /// halves it (rounding has the last word).
    pub(super) fn settled(&self, before: R, after: R) -> bool {
        let floor = after <= self.accept && after > before.half();
        self.stop > R::zero() && (after <= self.stop || floor)
    }

    fn judge<P: Path, const N: usize>(
        &self,
        interval: Interval<R, P, N>,
        balance: Balance<R, N>,
        owed: Residual<R, N>,
        report: Report<R>,
    ) -> Result<Solved<R, P, N>, StepError<R>> {
        if report.residual <= self.accept {
            Ok(Solved { interval, balance, report, owed })
        } else if report.residual.is_finite() {
            Err(StepError::NotConverged(report))
        } else {
            Err(StepError::NotFinite)
        }
    }
}

/// (dw, ds).
type Update<R, const N: usize> = ([R; N], [R; N]);

/// What is left of the two equations of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Residual<R, const N: usize> {
    pub momentum: [R; N],
    pub bubble: [R; N],
}

impl<R: Real, const N: usize> Residual<R, N> {
    pub fn zero() -> Self {
        Self { momentum: [R::zero(); N], bubble: [R::zero(); N] }
    }

    /// The largest component of both relative to the size of their terms; NaN where any is not finite.
    fn relative(&self, scale: &[R; N]) -> R {
        let tiny = R::EPSILON * R::EPSILON * R::EPSILON;
        let ratios = core::array::from_fn(|i| {
            // An infinite scale must not make a residual look like 0.
            let size = scale[i] + tiny;
            (self.momentum[i].abs() + self.bubble[i].abs() + size * R::zero()) / size
        });
        max_abs::<R, N>(&ratios)
    }
}

/// What a step starts from: p₀, and what its two equations are to have beside it: the rounding of p₀ and what Newton's
/// method left over one step before. Paid back in this way, neither adds up; without, it has the sign of the force at
/// every step, and over 10⁶ steps in f32 the energy drifts.
pub(super) struct Target<R, const N: usize> {
    pub p0: [R; N],
    pub owed: Residual<R, N>,
}

impl<R: Real, const N: usize> Target<R, N> {
    fn residual(&self, balance: &Balance<R, N>) -> Residual<R, N> {
        Residual {
            momentum: core::array::from_fn(|i| self.p0[i] + balance.d1_ld[i] + self.owed.momentum[i]),
            bubble: add_scaled(&balance.dm_ld, R::one(), &self.owed.bubble),
        }
    }
}
