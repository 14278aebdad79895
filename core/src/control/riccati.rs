//! Gains of linear regulators, u = ū − K(x − x̄).

use super::Transition;
use crate::linear::{
    Matrix, SolveError, add_scaled_matrix, diagonal, identity, product, solve_columns, solve_definite,
    transpose,
};
use crate::scalar::Real;
use core::fmt;

/// Reason why there is no regulator.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RegulatorError {
    /// A matrix cannot be inverted, or a number is not finite.
    Solve(SolveError),
    /// No gain stabilises the system: the controls do not reach a motion that grows, or the weights do not see it.
    NotStabilisable,
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

/// Regulator of a linear system that stays as it is: P solves P = Q + AᵀP(I + BR⁻¹BᵀP)⁻¹A.
///
/// Structure-preserving doubling: with G = BR⁻¹Bᵀ and P = Q, W = (I + GP)⁻¹ gives A ← AWA, G ← G + AWGAᵀ, P ← P + AᵀPWA, where A vanishes
/// quadratically.
///
/// # Errors
/// [`RegulatorError`].
///
/// Source: Chu, Fan, Lin and Wang, "Structure-preserving algorithms for periodic discrete-time algebraic Riccati equations", 2004.
pub fn stationary<R: Real, const D: usize, const M: usize>(
    transition: &Transition<R, D, M>,
    weights: &Weights<R, D, M>,
) -> Result<Regulator<R, D, M>, RegulatorError> {
    let one = identity::<R, D>();
    let spread = transition.b.map(|row| core::array::from_fn(|j| row[j] / weights.u[j]));
    let mut a = transition.a;
    let mut g = product(&spread, &transpose(&transition.b));
    let mut p = diagonal(weights.x);
    for _ in 0..MAX_DOUBLINGS {
        let w = solve_columns(add_scaled_matrix(&one, R::one(), &product(&g, &p)), &one)?;
        let aw = product(&a, &w);
        let added = product(&product(&transpose(&a), &product(&p, &w)), &a);
        g = symmetric(&add_scaled_matrix(&g, R::one(), &product(&aw, &product(&g, &transpose(&a)))));
        p = add_scaled_matrix(&p, R::one(), &symmetric(&added));
        a = product(&aw, &a);
        let (size, change) = (largest(&p), largest(&added));
        if !size.is_finite() {
            return Err(RegulatorError::NotStabilisable);
        }
        if change <= R::constant(16.0) * R::EPSILON * size {
            return Ok(back(transition, weights, &p)?);
        }
    }
    Err(RegulatorError::NotStabilisable)
}

fn largest<R: Real, const D: usize>(matrix: &Matrix<R, D>) -> R {
    matrix.iter().flatten().fold(R::zero(), |most, x| x.abs().max(most))
}

/// ½(X + Xᵀ), so that rounding cannot build up an antisymmetric part.
pub(super) fn symmetric<R: Real, const D: usize>(x: &Matrix<R, D>) -> Matrix<R, D> {
    add_scaled_matrix(x, R::one(), &transpose(x)).map(|row| row.map(R::half))
}
