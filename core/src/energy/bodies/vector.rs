//! Vectors in the plane.

use crate::energy::multibody;
use crate::scalar::Scalar;

/// A point or a direction in the plane.
pub type Vector<S> = [S; 2];

/// a + b.
#[inline(always)]
pub(super) fn add<S: Scalar>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    [a[0] + b[0], a[1] + b[1]]
}

/// ca.
#[inline(always)]
pub(super) fn scale<S: Scalar>(c: S, a: Vector<S>) -> Vector<S> {
    [c * a[0], c * a[1]]
}

/// a·b.
#[inline(always)]
pub(super) fn dot<S: Scalar>(a: Vector<S>, b: Vector<S>) -> S {
    a[0] * b[0] + a[1] * b[1]
}

/// a × b.
#[inline(always)]
pub(super) fn cross<S: Scalar>(a: Vector<S>, b: Vector<S>) -> S {
    a[0] * b[1] - a[1] * b[0]
}

/// a rotated by a quarter turn, counter-clockwise.
#[inline(always)]
pub(super) fn across<S: Scalar>(a: Vector<S>) -> Vector<S> {
    [-a[1], a[0]]
}

/// The vector with the given components along an axis and across it.
#[inline(always)]
pub(super) fn turned<S: Scalar>(axis: Vector<S>, [along, aside]: Vector<S>) -> Vector<S> {
    [axis[0] * along - axis[1] * aside, axis[1] * along + axis[0] * aside]
}

/// Components of a vector along an axis and across it.
#[inline(always)]
pub(super) fn turned_back<S: Scalar>(axis: Vector<S>, a: Vector<S>) -> Vector<S> {
    [dot(axis, a), cross(axis, a)]
}

/// A linear part, and an angular part about a joint: momentum (kg m/s, kg m²/s) or its derivative.
#[derive(Clone, Copy, Debug)]
pub struct Wrench<S> {
    /// The linear part.
    pub linear: Vector<S>,
    /// The angular part.
    pub angular: S,
}

impl<S: Scalar> multibody::Wrench<S> for Wrench<S> {
    type Vector = Vector<S>;

    #[inline(always)]
    fn about(self, step: Vector<S>) -> Self {
        Self { angular: self.angular + cross(step, self.linear), ..self }
    }

    #[inline(always)]
    fn along(&self, direction: Vector<S>) -> S {
        dot(direction, self.linear)
    }
}
