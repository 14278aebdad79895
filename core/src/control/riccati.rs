//! Gains of linear regulators, u = ū − K(x − x̄).

use super::Transition;
use crate::linear::{
    Matrix, SolveError, add_scaled_matrix, diagonal, identity, product, solve_columns, solve_definite,
    transpose,
};
use crate::scalar::{Real, max_abs};
use core::fmt;

/// Reason why there is no regulator.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RegulatorError {
    /// A matrix cannot be inverted, or a number is not finite.
    Solve(SolveError),
    /// No gain stabilises the system: the controls do not reach a motion that does not die out by itself.
    NotStabilisable,
    /// A motion that does not die out by itself costs nothing: the gain of least cost leaves it alone.
    Unseen,
}

impl From<SolveError> for RegulatorError {
    fn from(error: SolveError) -> Self {
        Self::Solve(error)
    }
}

impl fmt::Display for RegulatorError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Solve(error) => error.fmt(f),
            Self::NotStabilisable => f.write_str("no feedback of these controls stabilises the system"),
            Self::Unseen => f.write_str("the weights do not see a motion that does not die out by itself"),
        }
    }
}

impl core::error::Error for RegulatorError {}

/// Weights of the regulator: Σ δxᵀQδx + δuᵀRδu, Q and R diagonal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights<R, const D: usize, const M: usize> {
    /// Diagonal of Q ≥ 0.
    pub x: [R; D],
    /// Diagonal of R > 0.
    pub u: [R; M],
}

/// A regulator's gain, and the cost ½δxᵀPδx that remains under it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Regulator<R, const D: usize, const M: usize> {
    /// Gain K.
    pub gain: [[R; D]; M],
    /// P, symmetric.
    pub cost: Matrix<R, D>,
}

/// One step backwards in time: the gain at a node, and P there, from P at the node's end.
///
/// K = (R + BᵀPB)⁻¹BᵀPA, P ← Q + AᵀP(A − BK).
///
/// # Errors
/// [`SolveError`] if R + BᵀPB is not positive definite or a number is not finite.
pub fn back<R: Real, const D: usize, const M: usize>(
    transition: &Transition<R, D, M>,
    weights: &Weights<R, D, M>,
    end: &Matrix<R, D>,
) -> Result<Regulator<R, D, M>, SolveError> {
    let Transition { a, b } = transition;
    let to_end = product(&transpose(b), end);
    let h = add_scaled_matrix(&diagonal(weights.u), R::one(), &product(&to_end, b));
    let gain = transpose(&solve_definite(h, transpose(&product(&to_end, a)))?);
    let closed = closed_loop(transition, &gain);
    let cost = product(&product(&transpose(a), end), &closed);
    Ok(Regulator { gain, cost: symmetric(&add_scaled_matrix(&diagonal(weights.x), R::one(), &cost)) })
}

/// A − BK.
pub fn closed_loop<R: Real, const D: usize, const M: usize>(
    Transition { a, b }: &Transition<R, D, M>,
    gain: &[[R; D]; M],
) -> Matrix<R, D> {
    add_scaled_matrix(a, -R::one(), &product(b, gain))
}

/// Maximum number of doublings; each squares the closed loop, so 32 look 2³² nodes ahead.
const MAX_DOUBLINGS: usize = 32;

/// Regulator of a linear system that stays as it is: the P that stabilises it among those that solve P = Q + AᵀP(I + BR⁻¹BᵀP)⁻¹A.
///
/// # Errors
/// [`RegulatorError`].
///
/// Source: Chu, Fan, Lin and Wang, "Structure-preserving algorithms for periodic discrete-time algebraic Riccati equations", 2004.
pub fn stationary<R: Real, const D: usize, const M: usize>(
    transition: &Transition<R, D, M>,
    weights: &Weights<R, D, M>,
) -> Result<Regulator<R, D, M>, RegulatorError> {
    let mut doubling = Doubling::new(transition, weights)?;
    let mut settled = false;
    for _ in 0..MAX_DOUBLINGS {
        let change = match doubling.double() {
            Ok(change) => change,
            Err(_) if settled => break,
            Err(error) => return Err(error.into()),
        };
        settled = change <= R::constant(16.0) * R::EPSILON * largest(&doubling.p);
        if settled && largest(&doubling.a) <= R::EPSILON.sqrt() {
            return Ok(back(transition, weights, &doubling.p)?);
        }
        if !doubling.is_finite() {
            break;
        }
    }
    Err(if settled { RegulatorError::Unseen } else { RegulatorError::NotStabilisable })
}

/// State of structure-preserving doubling: after k of them P is the cost of 2ᵏ nodes.
///
/// A is their closed loop, up to a factor that stays bounded. If P settles and A vanishes, which it does quadratically, then every motion
/// dies out under the gain of P. If P settles and A does not vanish, then the weights do not see a motion that remains.
struct Doubling<R, const D: usize> {
    a: Matrix<R, D>,
    g: Matrix<R, D>,
    p: Matrix<R, D>,
}

impl<R: Real, const D: usize> Doubling<R, D> {
    /// G = BR⁻¹Bᵀ and P = Q.
    fn new<const M: usize>(
        Transition { a, b }: &Transition<R, D, M>,
        weights: &Weights<R, D, M>,
    ) -> Result<Self, SolveError> {
        let spread = b.map(|row| core::array::from_fn(|j| row[j] / weights.u[j]));
        let new = Self { a: *a, g: product(&spread, &transpose(b)), p: diagonal(weights.x) };
        if new.is_finite() { Ok(new) } else { Err(SolveError::NotFinite) }
    }

    /// With W = (I + GP)⁻¹: A ← AWA, G ← G + AWGAᵀ, P ← P + AᵀPWA. Returns the largest change of P.
    fn double(&mut self) -> Result<R, SolveError> {
        let Self { a, g, p } = self;
        let one = identity();
        let w = solve_columns(add_scaled_matrix(&one, R::one(), &product(g, p)), &one)?;
        let aw = product(a, &w);
        let added = product(&product(&transpose(a), &product(p, &w)), a);
        *g = symmetric(&add_scaled_matrix(g, R::one(), &product(&aw, &product(g, &transpose(a)))));
        *p = add_scaled_matrix(p, R::one(), &symmetric(&added));
        *a = product(&aw, a);
        Ok(largest(&added))
    }

    fn is_finite(&self) -> bool {
        [&self.a, &self.g, &self.p].into_iter().all(|matrix| largest(matrix).is_finite())
    }
}

/// Largest absolute value of the entries, NaN if any is not finite.
fn largest<R: Real, const D: usize>(matrix: &Matrix<R, D>) -> R {
    max_abs(&matrix.map(|row| max_abs(&row)))
}

/// ½(X + Xᵀ), so that rounding cannot build up an antisymmetric part.
pub(super) fn symmetric<R: Real, const D: usize>(x: &Matrix<R, D>) -> Matrix<R, D> {
    add_scaled_matrix(x, R::one(), &transpose(x)).map(|row| row.map(R::half))
}
