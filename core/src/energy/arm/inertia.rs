use super::vector::{Rotation, Twist, Vector, Wrench, add, cross, dot, scale, turned};
use crate::scalar::Scalar;

/// Number of numbers of a [`BodyInertia`].
pub const INERTIAL_PARAMETERS: usize = 10;

/// Inertia of a rigid body, or of many that move as one: mass, first moments and inertia matrix about a point.
///
/// A body of positive density has a positive definite pseudo-inertia [½ tr(I)·1 − I, mc; mcᵀ, m].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyInertia<S> {
    /// Mass m, kg.
    pub mass: S,
    /// First moments mc, kg m: m times the vector from the point to the centre of mass.
    pub moment: Vector<S>,
    /// I_xx, I_xy, I_yy, I_xz, I_yz, I_zz about the point, kg m²: ∫(|x|²·1 − xxᵀ) dm.
    pub matrix: [S; 6],
}

impl<S> BodyInertia<S> {
    /// Creates the inertia from m, mc_x, mc_y, mc_z, I_xx, I_xy, I_yy, I_xz, I_yz, I_zz.
    pub fn from_array(numbers: [S; INERTIAL_PARAMETERS]) -> Self {
        let [mass, x, y, z, matrix @ ..] = numbers;
        Self { mass, moment: [x, y, z], matrix }
    }

    /// Returns the numbers of the inertia in the order of [`BodyInertia::from_array`].
    pub fn into_array(self) -> [S; INERTIAL_PARAMETERS] {
        let Self { mass, moment: [x, y, z], matrix: [xx, xy, yy, xz, yz, zz] } = self;
        [mass, x, y, z, xx, xy, yy, xz, yz, zz]
    }
}

/// A + B of inertia matrices.
#[inline(always)]
fn added<S: Scalar>(a: &[S; 6], b: &[S; 6]) -> [S; 6] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3], a[4] + b[4], a[5] + b[5]]
}

impl<S: Scalar> BodyInertia<S> {
    pub(super) fn zero() -> Self {
        Self { mass: S::zero(), moment: [S::zero(); 3], matrix: [S::zero(); 6] }
    }

    /// Expresses the inertia in another frame: the columns of `rotation` are this frame's axes there.
    #[inline(always)]
    pub(super) fn turned(&self, rotation: &Rotation<S>) -> Self {
        let half = [self.turning(rotation[0]), self.turning(rotation[1]), self.turning(rotation[2])];
        let entry = |i: usize, j: usize| dot(half[i], rotation[j]);
        Self {
            mass: self.mass,
            moment: turned(rotation, self.moment),
            matrix: [entry(0, 0), entry(0, 1), entry(1, 1), entry(0, 2), entry(1, 2), entry(2, 2)],
        }
    }

    /// Adds another inertia about the same point.
    #[inline(always)]
    pub(super) fn plus(&self, other: &Self) -> Self {
        Self {
            mass: self.mass + other.mass,
            moment: add(self.moment, other.moment),
            matrix: added(&self.matrix, &other.matrix),
        }
    }

    /// Expresses the inertia about another point; `step` leads from that point to this one.
    #[inline(always)]
    pub(super) fn about(&self, step: Vector<S>) -> Self {
        let moment = add(self.moment, scale(self.mass, step));
        // ∫(|x + d|²·1 − (x + d)(x + d)ᵀ) dm, with e the mean of both first moments.
        let twice = add(self.moment, moment);
        let mean = [twice[0].half(), twice[1].half(), twice[2].half()];
        let [x, y, z] = [mean[0] * step[0], mean[1] * step[1], mean[2] * step[2]];
        let product = |i: usize, j: usize| -(mean[i] * step[j] + step[i] * mean[j]);
        let more = [y + y + z + z, product(0, 1), x + x + z + z, product(0, 2), product(1, 2), x + x + y + y];
        Self { mass: self.mass, moment, matrix: added(&self.matrix, &more) }
    }

    /// Iω.
    #[inline(always)]
    pub(super) fn turning(&self, [x, y, z]: Vector<S>) -> Vector<S> {
        let [xx, xy, yy, xz, yz, zz] = self.matrix;
        [xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z]
    }

    /// The momentum at a velocity: (Iω + mc × ṙ, mṙ + ω × mc).
    #[inline(always)]
    pub(super) fn momentum(&self, velocity: &Twist<S>) -> Wrench<S> {
        let Twist { angular, linear } = *velocity;
        Wrench {
            angular: add(self.turning(angular), cross(self.moment, linear)),
            linear: add(scale(self.mass, linear), cross(angular, self.moment)),
        }
    }

    /// The force that gives a body with angular velocity ω = `spin` the angular acceleration and the
    /// acceleration of the point in `acceleration`: the momentum at these accelerations, plus (ω × Iω, ω × (ω ×
    /// mc)).
    #[inline(always)]
    pub(super) fn force(&self, spin: Vector<S>, acceleration: &Twist<S>) -> Wrench<S> {
        let turning = Wrench {
            angular: cross(spin, self.turning(spin)),
            linear: cross(spin, cross(spin, self.moment)),
        };
        self.momentum(acceleration).plus(turning)
    }
}
