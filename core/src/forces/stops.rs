use super::Forces;
use crate::linear::Matrix;
use crate::scalar::{Real, Scalar};

/// End stops of every coordinate, which it cannot pass: a set-valued law.
///
/// A stop at q̄ only pushes: Q_i ≤ 0 at the upper one, and 0 below it. A coordinate that strikes it with the velocity v leaves with −e v; one
/// that rests on it stays there, and one that begins beyond it goes no further. Steps of [`Del`](crate::discrete::Del) solve this law
/// ([`Forces::stops`]); to all other methods a stop is no force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stops<S, const N: usize> {
    /// The stops of each coordinate.
    pub coordinates: [Stop<S>; N],
}

/// Both end stops of one coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop<S> {
    /// Lower limit of the position, m or rad; −∞ without a stop.
    pub lower: S,
    /// Upper limit, above the lower one; ∞ without a stop.
    pub upper: S,
    /// Restitution 0 ≤ e ≤ 1.
    pub restitution: S,
}

impl<S: Scalar> Stop<S> {
    /// No stops.
    pub fn none() -> Self {
        // Two literals: of an array's numbers a small program would convert each in double precision.
        let (lower, upper) = (S::constant(f64::NEG_INFINITY), S::constant(f64::INFINITY));
        Self { lower, upper, restitution: S::zero() }
    }

    /// Stops at the distance `half` > 0, m or rad, on both sides of `centre`, with a restitution. A sum that overflows is no stop.
    pub fn about(centre: S, half: S, restitution: S) -> Self {
        Self { lower: centre - half, upper: centre + half, restitution }
    }

    /// The stops of two laws: the narrower limits, and the larger restitution.
    #[must_use]
    #[inline(always)]
    pub(super) fn both(self, other: Self) -> Self {
        Self {
            lower: self.lower.max(other.lower),
            upper: -((-self.upper).max(-other.upper)),
            restitution: self.restitution.max(other.restitution),
        }
    }
}

impl<S: Scalar, const N: usize> Stops<S, N> {
    /// No stops.
    pub fn none() -> Self {
        Self { coordinates: [Stop::none(); N] }
    }
}

impl<S: Scalar, const N: usize> Forces<S, N> for Stops<S, N> {
    #[inline(always)]
    fn force(&self, _: &[S; N], _: &[S; N], _: &[S; N]) -> [S; N] {
        [S::zero(); N]
    }

    #[inline(always)]
    fn derivatives(&self, _: &[S; N], _: &[S; N], _: &[S; N]) -> (Matrix<S, N>, Matrix<S, N>) {
        ([[S::zero(); N]; N], [[S::zero(); N]; N])
    }

    fn load_derivative(&self, _: &[S; N], _: &[S; N], _: &[S; N]) -> Matrix<S, N> {
        [[S::zero(); N]; N]
    }

    #[inline(always)]
    fn sticks(&self) -> bool
    where
        S: Real,
    {
        self.coordinates.iter().any(|stop| stop.lower.is_finite() || stop.upper.is_finite())
    }

    #[inline(always)]
    fn stops(&self) -> [Stop<S>; N] {
        self.coordinates
    }
}
