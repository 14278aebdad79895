//! Newton's method: one iteration for all equations of this crate.

use crate::linear::SolveError;
use crate::scalar::Real;
use core::fmt;

/// Bounds of Newton's method.
///
/// Residuals are relative, each to the size of the terms in its sum, and have no unit. Between `accept` and `stop` the iteration also ends
/// if an update no longer halves the residual: rounding allows no more.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Newton<R> {
    /// Maximum number of updates. At least one update is taken, except for 0, which only checks the guess.
    pub max_iterations: u8,
    /// Residual at which to stop early; 0 always takes `max_iterations`, for a constant running time.
    pub stop: R,
    /// Largest accepted residual; a solution above it is an error.
    pub accept: R,
}

impl<R: Real> Newton<R> {
    /// Bounds of at most 50 updates, which stop at 2ε and accept residuals up to √ε, with ε the rounding unit.
    ///
    /// A step in f32 takes one or two updates up to h = 10 ms and seldom more than four at 50 ms; a step in f64 takes
    /// three to four, and five to ten. Only much longer steps, which are no longer of use, take many updates.
    pub fn new() -> Self {
        Self { max_iterations: 50, stop: R::constant(2.0) * R::EPSILON, accept: R::EPSILON.sqrt() }
    }

    /// Measures, updates and measures again, until the residual is small or no longer falls.
    #[inline(always)]
    pub(crate) fn solve<E: Equations<R>>(&self, equations: &mut E) -> Result<Report<R>, E::Error> {
        let (mut report, mut since_revision) = (Report::nothing(), 0);
        loop {
            let residual = equations.residual();
            let before = core::mem::replace(&mut report.residual, residual);
            if equations.revised() {
                since_revision = 0;
            }
            let settled = since_revision > 0 && self.settled(before, residual);
            if settled || since_revision >= self.max_iterations || !residual.is_finite() {
                return Ok(self.accepted(report)?);
            }
            equations.update()?;
            since_revision += 1;
            report.iterations = report.iterations.saturating_add(1);
        }
    }

    /// Whether another update would not help: the residual is small enough, or it is acceptable and the last update
    /// did not halve it.
    fn settled(&self, before: R, after: R) -> bool {
        let floor = after <= self.accept && after > before.half();
        self.stop > R::zero() && (after <= self.stop || floor)
    }

    /// Returns an error unless the residual is small enough.
    pub(crate) fn accepted(&self, report: Report<R>) -> Result<Report<R>, StepError<R>> {
        if report.residual <= self.accept {
            Ok(report)
        } else if report.residual.is_finite() {
            Err(StepError::NotConverged(report))
        } else {
            Err(StepError::NotFinite)
        }
    }
}

impl<R: Real> Default for Newton<R> {
    fn default() -> Self {
        Self::new()
    }
}

/// Equations that Newton's method solves, with the present values of their unknowns.
pub(crate) trait Equations<R> {
    /// Reason why an update can fail, or a solution be refused.
    type Error: From<StepError<R>>;
    /// Evaluates the equations: the largest residual relative to the size of its terms; NaN if any is not finite.
    fn residual(&mut self) -> R;
    /// Whether the last evaluation replaced the equations by others. The bound on updates then counts anew.
    #[inline(always)]
    fn revised(&self) -> bool {
        false
    }
    /// Moves the unknowns to the solution of the linearised equations.
    fn update(&mut self) -> Result<(), Self::Error>;
}

/// A residual relative to the size of its terms: 0 if all vanish, NaN if any is not finite.
#[inline(always)]
pub(crate) fn relative<R: Real>(residual: R, size: R) -> R {
    // Smaller than any size in any unit.
    let tiny = R::constant(1e-37);
    let size = size + tiny;
    // An infinite size must not make a residual look like 0.
    if size.is_finite() { residual / size } else { size * R::zero() }
}

/// Report of Newton's method.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report<R> {
    /// Number of updates taken.
    pub iterations: u8,
    /// Largest relative residual at the end.
    pub residual: R,
}

impl<R: Real> Report<R> {
    /// Report if there is nothing to solve.
    pub(crate) fn nothing() -> Self {
        Self { iterations: 0, residual: R::zero() }
    }

    /// The larger number of iterations and the larger residual of two reports.
    pub(crate) fn worse(self, other: Self) -> Self {
        let residual = if other.residual > self.residual { other.residual } else { self.residual };
        Self { iterations: self.iterations.max(other.iterations), residual }
    }
}

impl<R: fmt::Display> Report<R> {
    /// Writes the message for a residual that is too large.
    pub(crate) fn not_converged(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { iterations, residual } = self;
        write!(
            f,
            "Newton's method did not converge: {iterations} updates left a relative residual of {residual}"
        )
    }
}

/// Reason why equations were not solved; the state is unchanged.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepError<R> {
    /// The matrix of the equations is singular.
    Singular {
        /// The column in which only zero pivots were left, from 0.
        column: u8,
    },
    /// Positions, momenta, controls or energies are infinite or NaN.
    NotFinite,
    /// The residual stayed above the accepted one.
    NotConverged(Report<R>),
}

impl<R> From<SolveError> for StepError<R> {
    fn from(error: SolveError) -> Self {
        match error {
            SolveError::Singular { column } => Self::Singular { column },
            SolveError::NotFinite => Self::NotFinite,
        }
    }
}

impl<R: fmt::Display> fmt::Display for StepError<R> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Singular { column } => SolveError::Singular { column: *column }.fmt(f),
            Self::NotFinite => SolveError::NotFinite.fmt(f),
            Self::NotConverged(report) => report.not_converged(f),
        }
    }
}

impl<R: fmt::Debug + fmt::Display> core::error::Error for StepError<R> {}
