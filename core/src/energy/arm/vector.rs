//! Vectors in space, and pairs of them: motions and forces of bodies.
//!
//! Entries are written out: `map` and `from_fn` over entries as long as lanes of numbers are calls, and copy them.

use crate::energy::multibody;
use crate::scalar::Scalar;

/// A point or a direction in space.
pub type Vector<S> = [S; 3];
/// A rotation, row by row.
pub type Rotation<S> = [Vector<S>; 3];

/// a + b.
#[inline(always)]
pub(super) fn add<S: Scalar>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// a − b.
#[inline(always)]
pub(super) fn subtracted<S: Scalar>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// ca.
#[inline(always)]
pub(super) fn scale<S: Scalar>(c: S, a: Vector<S>) -> Vector<S> {
    [c * a[0], c * a[1], c * a[2]]
}

/// a·b.
#[inline(always)]
pub(super) fn dot<S: Scalar>(a: Vector<S>, b: Vector<S>) -> S {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a × b.
#[inline(always)]
pub(super) fn cross<S: Scalar>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Ra.
#[inline(always)]
pub(super) fn turned<S: Scalar>(rotation: &Rotation<S>, a: Vector<S>) -> Vector<S> {
    [dot(rotation[0], a), dot(rotation[1], a), dot(rotation[2], a)]
}

/// Rᵀa.
#[inline(always)]
pub(super) fn turned_back<S: Scalar>(rotation: &Rotation<S>, a: Vector<S>) -> Vector<S> {
    let [x, y, z] = rotation;
    let entry = |i: usize| x[i] * a[0] + y[i] * a[1] + z[i] * a[2];
    [entry(0), entry(1), entry(2)]
}

/// AB.
#[inline(always)]
pub(super) fn product<S: Scalar>(a: &Rotation<S>, b: &Rotation<S>) -> Rotation<S> {
    let entry = |row: Vector<S>, j: usize| row[0] * b[0][j] + row[1] * b[1][j] + row[2] * b[2][j];
    let row = |row: Vector<S>| [entry(row, 0), entry(row, 1), entry(row, 2)];
    [row(a[0]), row(a[1]), row(a[2])]
}

/// R turned by the angle q with this sine and cosine about Ra, a unit vector: cos q R + sin q [Ra]×R + (1 − cos q)(Ra)aᵀ.
///
/// One function for all recursions on controllers: most joints turn about their z axis, and flash is scarce.
#[cfg_attr(target_pointer_width = "32", inline(never))]
#[cfg_attr(not(target_pointer_width = "32"), inline(always))]
pub(super) fn turned_about<S: Scalar>(
    rotation: Rotation<S>,
    (turned, axis): (Vector<S>, Vector<S>),
    (sin, cos): (S, S),
) -> Rotation<S> {
    let (across, along) = (scale(sin, turned), scale(S::one() - cos, turned));
    let row = |next: usize, last: usize| {
        subtracted(scale(across[next], rotation[last]), scale(across[last], rotation[next]))
    };
    let crossed = [row(1, 2), row(2, 0), row(0, 1)];
    let row = |i: usize| add(add(scale(cos, rotation[i]), crossed[i]), scale(along[i], axis));
    [row(0), row(1), row(2)]
}

/// R turned by the angle with this sine and cosine about its own z axis.
#[inline(always)]
pub(super) fn turned_about_z<S: Scalar>(rotation: &Rotation<S>, (sin, cos): (S, S)) -> Rotation<S> {
    let row = |[x, y, z]: Vector<S>| [cos * x + sin * y, cos * y - sin * x, z];
    [row(rotation[0]), row(rotation[1]), row(rotation[2])]
}

/// Motion of a body: its angular velocity, and the velocity of its point at a joint.
#[derive(Clone, Copy, Debug)]
pub struct Twist<S> {
    /// The angular part.
    pub angular: Vector<S>,
    /// The linear part.
    pub linear: Vector<S>,
}

impl<S: Scalar> Twist<S> {
    pub fn zero() -> Self {
        Self { angular: [S::zero(); 3], linear: [S::zero(); 3] }
    }

    /// The power of a wrench about the same point.
    #[inline(always)]
    pub fn dot(&self, wrench: &Wrench<S>) -> S {
        dot(self.angular, wrench.angular) + dot(self.linear, wrench.linear)
    }
}

/// A linear part, and an angular part about a joint: momentum (kg m²/s, kg m/s), force (N m, N), or derivatives of them.
#[derive(Clone, Copy, Debug)]
pub struct Wrench<S> {
    /// The angular part.
    pub angular: Vector<S>,
    /// The linear part.
    pub linear: Vector<S>,
}

impl<S: Scalar> Wrench<S> {
    pub fn zero() -> Self {
        Self { angular: [S::zero(); 3], linear: [S::zero(); 3] }
    }

    #[inline(always)]
    pub fn plus(self, other: Self) -> Self {
        Self { angular: add(self.angular, other.angular), linear: add(self.linear, other.linear) }
    }
}

impl<S: Scalar> multibody::Wrench<S> for Wrench<S> {
    type Vector = Vector<S>;

    #[inline(always)]
    fn about(self, step: Vector<S>) -> Self {
        Self { angular: add(self.angular, cross(step, self.linear)), ..self }
    }

    #[inline(always)]
    fn along(&self, direction: Vector<S>) -> S {
        dot(direction, self.linear)
    }
}
