use super::motion::Pose;
use super::vector::{Rotation, Vector, add, product, scale, turned, turned_about, turned_about_z};
use super::{ARM_PARAMETERS, BodyInertia, Joint};
use crate::scalar::{Scalar, WeightFormat};

/// A body's numbers in the weight block, which are read one by one when they are needed: an array of lanes would be copied.
#[derive(Clone, Copy)]
pub struct Body<'a, W>(pub &'a [W; ARM_PARAMETERS]);

/// A coordinate of a joint, with its sine and cosine if S computes those of many angles at once.
#[derive(Clone, Copy)]
pub struct Coordinate<S> {
    q: S,
    turn: (S, S),
}

impl<S: Scalar> Coordinate<S> {
    #[inline(always)]
    pub fn new(joint: Joint, q: S) -> Self {
        let turns = S::SIDE_BY_SIDE && matches!(joint, Joint::Revolute);
        Self { q, turn: if turns { q.sin_cos() } else { (S::zero(), S::zero()) } }
    }

    #[inline(always)]
    fn sin_cos(&self) -> (S, S) {
        if S::SIDE_BY_SIDE { self.turn } else { self.q.sin_cos() }
    }
}

/// Coordinates of all joints.
pub struct Coordinates<'a, S, const N: usize> {
    q: &'a [S; N],
    turns: ([S; N], [S; N]),
}

impl<'a, S: Scalar, const N: usize> Coordinates<'a, S, N> {
    #[inline(always)]
    pub fn new(q: &'a [S; N]) -> Self {
        Self { q, turns: if S::SIDE_BY_SIDE { S::sin_cos_of(q) } else { ([S::zero(); N], [S::zero(); N]) } }
    }

    #[inline(always)]
    pub fn of(&self, k: usize) -> Coordinate<S> {
        Coordinate { q: self.q[k], turn: (self.turns.0[k], self.turns.1[k]) }
    }
}

impl<W: WeightFormat> Body<'_, W> {
    /// Places the body on a frame with the rotation `below`.
    ///
    /// One function for all recursions on controllers without a floating-point unit, where every operation is a call and takes flash.
    #[cfg_attr(all(target_pointer_width = "32", not(target_abi = "eabihf")), inline(never))]
    #[cfg_attr(not(all(target_pointer_width = "32", not(target_abi = "eabihf"))), inline(always))]
    pub fn posed<S: Scalar<Weight = W::Wide>>(
        &self,
        below: &Rotation<S>,
        joint: Joint,
        coordinate: Coordinate<S>,
    ) -> Pose<S> {
        let fixed = [self.vector(0), self.vector(3), self.vector(6)];
        let (rotation, step) = (product(below, &fixed), turned(below, self.vector(9)));
        if matches!(joint, Joint::Revolute) && self.is_along_z() {
            let along: S = self.number(14);
            let (sin, cos) = coordinate.sin_cos();
            let axis = scale(along, [rotation[0][2], rotation[1][2], rotation[2][2]]);
            return Pose { rotation: turned_about_z(&rotation, (along * sin, cos)), axis, step };
        }
        let own = self.vector(12);
        let axis = turned(&rotation, own);
        match joint {
            Joint::Revolute => {
                Pose { rotation: turned_about(rotation, (axis, own), coordinate.sin_cos()), axis, step }
            }
            Joint::Prismatic => Pose { rotation, axis, step: add(step, scale(coordinate.q, axis)) },
        }
    }

    /// The inertia in the axes of the base.
    #[cfg_attr(all(target_pointer_width = "32", not(target_abi = "eabihf")), inline(never))]
    #[cfg_attr(not(all(target_pointer_width = "32", not(target_abi = "eabihf"))), inline(always))]
    pub fn inertia<S: Scalar<Weight = W::Wide>>(&self, rotation: &Rotation<S>) -> BodyInertia<S> {
        let matrix = [
            self.number(19),
            self.number(20),
            self.number(21),
            self.number(22),
            self.number(23),
            self.number(24),
        ];
        BodyInertia { mass: self.number(15), moment: self.vector(16), matrix }.turned(rotation)
    }

    #[inline(always)]
    pub fn rotor<S: Scalar<Weight = W::Wide>>(&self) -> S {
        self.number(ARM_PARAMETERS - 1)
    }

    /// Whether the axis is the z axis of the joint's frame or points against it.
    #[inline(always)]
    fn is_along_z(&self) -> bool {
        self.0[12] == W::default() && self.0[13] == W::default()
    }

    #[inline(always)]
    fn number<S: Scalar<Weight = W::Wide>>(&self, index: usize) -> S {
        self.0[index].scalar()
    }

    #[inline(always)]
    fn vector<S: Scalar<Weight = W::Wide>>(&self, first: usize) -> Vector<S> {
        [self.number(first), self.number(first + 1), self.number(first + 2)]
    }
}
