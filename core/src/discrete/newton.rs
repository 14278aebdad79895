use super::{Balance, Interval, Linearised, Path};
use crate::forces::{Forces, System};
use crate::lagrangian::Lagrangian;
use crate::linear::{Singular, add_scaled, add_scaled_matrix, multiply, solve, solve_many, transpose};
use crate::scalar::{Real, max_abs};

/// The bounds of Newton's method. Residuals are relative: each component to the size of the terms it is the sum of.
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
    /// At most 8 updates, stopping at 16 rounding units, accepting up to the square root of one.
    fn default() -> Self {
        Self { max_iterations: 8, stop: R::constant(16.0) * R::EPSILON, accept: R::EPSILON.sqrt() }
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
    fn update(&self, r: &[R; N], bubble: bool) -> Result<([R; N], [R; N]), Singular> {
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
    pub fn reduced(&self) -> Result<([[R; N]; N], [[R; N]; N]), Singular> {
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
        let mut interval = guess;
        for iterations in 0..self.max_iterations {
            let linearised = interval.linearise(system);
            let balance = linearised.balance;
            let residual = add_scaled(p0, R::one(), &balance.d1_ld);
            let report = Report { iterations, residual: relative(&residual, p0, &balance) };
            if report.residual <= self.stop {
                return Ok(Solved { interval, balance, report });
            }
            let (dw, ds) = linearised.update(&residual, P::BUBBLE)?;
            interval = interval.moved(&dw, &ds);
        }
        let balance = interval.balance(system);
        let residual = relative(&add_scaled(p0, R::one(), &balance.d1_ld), p0, &balance);
        self.judge(Solved { interval, balance, report: Report { iterations: self.max_iterations, residual } })
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
        let mut interval = guess;
        let updates = if P::BUBBLE { self.max_iterations } else { 0 };
        for iterations in 0..updates {
            let linearised = interval.linearise(system);
            let balance = linearised.balance;
            let report = Report { iterations, residual: relative(&zero, &zero, &balance) };
            if report.residual <= self.stop {
                return Ok(Solved { interval, balance, report });
            }
            let ds = solve(linearised.bubble_s, balance.dm_ld.map(|x| -x))?;
            interval = interval.moved(&zero, &ds);
        }
        let balance = interval.balance(system);
        let residual = relative(&zero, &zero, &balance);
        self.judge(Solved { interval, balance, report: Report { iterations: updates, residual } })
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

/// The largest component of the momentum residual and of the bubble equation, relative to their terms; NaN where any is.
fn relative<R: Real, const N: usize>(residual: &[R; N], p0: &[R; N], balance: &Balance<R, N>) -> R {
    let tiny = R::EPSILON * R::EPSILON * R::EPSILON;
    let ratios = core::array::from_fn(|i| {
        (residual[i].abs().max(balance.dm_ld[i].abs())) / (balance.scale[i] + p0[i].abs() + tiny)
    });
    max_abs::<R, N>(&ratios)
}
