//! Vectors in space, and pairs of them: motions and forces of bodies.

use crate::energy::multibody;
use crate::scalar::Scalar;
use core::array::from_fn;

/// A point or a direction in space.
pub type Vector<S> = [S; 3];
/// A rotation, row by row.
pub type Rotation<S> = [Vector<S>; 3];

/// a + b.
#[inline(always)]
pub(super) fn add<S: Scalar>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    from_fn(|i| a[i] + b[i])
}

/// ca.
#[inline(always)]
pub(super) fn scale<S: Scalar>(c: S, a: Vector<S>) -> Vector<S> {
    a.map(|a| c * a)
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
    rotation.map(|row| dot(row, a))
}

/// Rᵀa.
#[inline(always)]
pub(super) fn turned_back<S: Scalar>(rotation: &Rotation<S>, a: Vector<S>) -> Vector<S> {
    let [x, y, z] = rotation;
    from_fn(|i| x[i] * a[0] + y[i] * a[1] + z[i] * a[2])
}

/// AB.
#[inline(always)]
pub(super) fn product<S: Scalar>(a: &Rotation<S>, b: &Rotation<S>) -> Rotation<S> {
    a.map(|row| from_fn(|j| row[0] * b[0][j] + row[1] * b[1][j] + row[2] * b[2][j]))
}

/// R turned by the angle q about Ra, a unit vector: cos q R + sin q [Ra]×R + (1 − cos q)(Ra)aᵀ.
#[inline(always)]
pub(super) fn turned_about<S: Scalar>(
    rotation: &Rotation<S>,
    (turned, axis): (Vector<S>, Vector<S>),
    q: S,
) -> Rotation<S> {
    let (sin, cos) = q.sin_cos();
    let (across, along) = (scale(sin, turned), scale(S::one() - cos, turned));
    from_fn(|i| {
        let (next, last) = ((i + 1) % 3, (i + 2) % 3);
        from_fn(|j| {
            let crossed = across[next] * rotation[last][j] - across[last] * rotation[next][j];
            cos * rotation[i][j] + crossed + along[i] * axis[j]
        })
    })
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
