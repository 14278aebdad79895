use super::{Balance, Interval, Linearised, Path};
use crate::forces::{Forces, System};
use crate::lagrangian::Lagrangian;
use crate::linear::{Matrix, Singular, add_scaled, add_scaled_matrix, multiply, solve, solve_many, transpose};
use crate::scalar::{Compensated, Real, max_abs};

/// The bounds of Newton's method. Residuals are relative: each component to the size of the terms it is the sum of
/// ([`Linearised::scale`] and the momentum).
///
/// At least one update is taken. Between `accept` and `stop` the iteration also ends where an update no longer halves the
/// residual: rounding allows no more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Newton<R> {
    /// Updates at most; 0 only checks the guess.
    pub max_iterations: u8,
    /// Stop early at this residual; 0 always takes `max_iterations`, for a constant running time.
    pub stop: R,
    /// A step whose residual stays above is an error.
    pub accept: R,
}

impl<R: Real> Default for Newton<R> {
    /// At most 8 updates, stopping at 2 rounding units, accepting up to the square root of one.
    fn default() -> Self {
        Self { max_iterations: 8, stop: R::constant(2.0) * R::EPSILON, accept: R::EPSILON.sqrt() }
    }
}

/// How a step went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report<R> {
    /// Newton updates taken.
    pub iterations: u8,
    /// Largest relative residual at the end.
    pub residual: R,
}

/// Why a step was refused; the state is as it was before.
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
}

impl<R: Real, const N: usize> Linearised<R, N> {
    /// (dw, ds) with momentum_w dw + momentum_s ds = −r and bubble_w dw + bubble_s ds = −dm_ld, by eliminating ds.
    fn update(&self, r: &[R; N], bubble: bool) -> Result<Update<R, N>, Singular> {
        let minus = -R::one();
        if !bubble {
            return Ok((solve(self.momentum_w, r.map(|r| -r))?, [R::zero(); N]));
        }
        let [free] = solve_many(self.bubble_s, [self.balance.dm_ld])?;
        let (slaved, reduced) = self.reduced()?;
        let right = add_scaled(&multiply(&self.momentum_s, &free), minus, r);
        let dw = solve(reduced, right)?;
        let ds = add_scaled(&free, R::one(), &multiply(&slaved, &dw)).map(|x| -x);
        Ok((dw, ds))
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
        self.solve_carried(system, guess, &p0.map(Compensated::new))
    }

    /// [`Newton::solve_step`] with what rounding took from p₀. Without it the residual seems to vanish for a whole range of
    /// w, Newton's method ends on that side of the range where it came from, and over 10⁶ steps the energy drifts.
    pub(super) fn solve_carried<L, F, P: Path, const N: usize>(
        &self,
        system: &System<L, F>,
        guess: Interval<R, P, N>,
        p0: &[Compensated<R>; N],
    ) -> Result<Solved<R, P, N>, StepError<R>>
    where
        L: Lagrangian<R, N>,
        F: Forces<R, N>,
    {
        let momentum = |balance: &Balance<R, N>| {
            core::array::from_fn(|i| p0[i].value() + balance.d1_ld[i] + p0[i].carry())
        };
        let rounded = p0.map(|p| p.value());
        self.iterate(system, guess, &rounded, momentum, |linearised, r| linearised.update(r, P::BUBBLE))
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
        let updates = if P::BUBBLE { *self } else { Self { max_iterations: 0, ..*self } };
        updates.iterate(system, guess, &zero, |_| zero, |linearised, _| {
            Ok((zero, solve(linearised.bubble_s, linearised.balance.dm_ld.map(|x| -x))?))
        })
    }

    /// Linearise, update, measure; again until the residual is small or no longer falls.
    #[inline(always)]
    fn iterate<L, F, P: Path, const N: usize>(
        &self,
        system: &System<L, F>,
        guess: Interval<R, P, N>,
        p0: &[R; N],
        momentum: impl Fn(&Balance<R, N>) -> [R; N],
        update: impl Fn(&Linearised<R, N>, &[R; N]) -> Result<Update<R, N>, Singular>,
    ) -> Result<Solved<R, P, N>, StepError<R>>
    where
        L: Lagrangian<R, N>,
        F: Forces<R, N>,
    {
        let mut solved = None;
        let mut interval = guess;
        for iterations in 1..=self.max_iterations {
            let linearised = interval.linearise(system);
            let scale = add_magnitudes(&linearised.scale, p0);
            let residual = momentum(&linearised.balance);
            let before = relative(&residual, &linearised.balance.dm_ld, &scale);
            if !before.is_finite() {
                return Err(StepError::NotFinite);
            }
            let (dw, ds) = update(&linearised, &residual)?;
            interval = interval.moved(&dw, &ds);
            let balance = interval.balance(system);
            let residual = relative(&momentum(&balance), &balance.dm_ld, &scale);
            solved = Some(Solved { interval, balance, report: Report { iterations, residual } });
            if self.settled(before, residual) {
                break;
            }
        }
        self.judge(solved.unwrap_or_else(|| {
            let Linearised { balance, scale, .. } = guess.linearise(system);
            let residual = relative(&momentum(&balance), &balance.dm_ld, &add_magnitudes(&scale, p0));
            Solved { interval: guess, balance, report: Report { iterations: 0, residual } }
        }))
    }

    /// Whether another update would be in vain: the residual is small enough, or acceptable and an update no longer
    /// halves it (rounding has the last word).
    fn settled(&self, before: R, after: R) -> bool {
        let floor = after <= self.accept && after > before.half();
        self.stop > R::zero() && (after <= self.stop || floor)
    }

    fn judge<P: Path, const N: usize>(&self, solved: Solved<R, P, N>) -> Result<Solved<R, P, N>, StepError<R>> {
        let residual = solved.report.residual;
        if residual <= self.accept {
            Ok(solved)
        } else if residual.is_finite() {
            Err(StepError::NotConverged(solved.report))
        } else {
            Err(StepError::NotFinite)
        }
    }
}

/// (dw, ds).
type Update<R, const N: usize> = ([R; N], [R; N]);

/// a_i + |b_i|.
#[inline(always)]
fn add_magnitudes<R: Real, const N: usize>(a: &[R; N], b: &[R; N]) -> [R; N] {
    core::array::from_fn(|i| a[i] + b[i].abs())
}

/// The largest component of both equations relative to the size of their terms; NaN where any is not finite.
fn relative<R: Real, const N: usize>(momentum: &[R; N], bubble: &[R; N], scale: &[R; N]) -> R {
    let tiny = R::EPSILON * R::EPSILON * R::EPSILON;
    let ratios = core::array::from_fn(|i| {
        // An infinite scale must not make a residual look like 0.
        let size = scale[i] + tiny;
        (momentum[i].abs() + bubble[i].abs() + size * R::zero()) / size
    });
    max_abs::<R, N>(&ratios)
}
