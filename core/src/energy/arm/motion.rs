//! Frames and velocities of a tree, from the base up, and sums over all that every joint carries, from the tips down.
//!
//! All vectors are in the axes of the base, and a body's moments are about the origin of its own frame. Sums need no rotation on their way
//! to the base, and lose no digits to a far origin.

use super::body::{Body, Coordinate};
use super::links::Link;
use super::vector::{Rotation, Twist, Vector, Wrench, add, cross, dot, scale, turned_back};
use super::{ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS, ArmBodies, BodyInertia, INERTIAL_PARAMETERS, Joint};
use crate::energy::multibody::{self, Bodies, Space, Wrench as _};
use crate::linear::SolveError;
use crate::scalar::{Real, Scalar, WeightFormat};

/// The frame of a body.
#[derive(Clone, Copy, Debug)]
pub struct Frame<S> {
    pub joint: Joint,
    /// Rotation whose columns are the axes of the frame.
    pub rotation: Rotation<S>,
    /// Axis of the body's joint.
    pub axis: Vector<S>,
    /// Step from the parent's origin to this one, m.
    pub step: Vector<S>,
    /// Velocities ω and ṙ.
    pub velocity: Twist<S>,
}

impl<S: Scalar> Space<S, ARM_PARAMETERS> for Vector<S> {
    type Frame = Frame<S>;

    #[inline(always)]
    fn body<W: WeightFormat<Wide = S::Weight>>(numbers: &[W; ARM_PARAMETERS]) -> Body<'_, W> {
        Body(numbers)
    }

    const SOLVES: bool = true;

    #[inline(always)]
    fn forward_dynamics<W: WeightFormat<Wide = S::Weight>, const D: usize, const N: usize>(
        bodies: &Bodies<W, D, ARM_PARAMETERS, N>,
        q: &[S; N],
        v: &[S; N],
        force: &[S; N],
    ) -> Option<Result<[S; N], SolveError>>
    where
        S: Real,
    {
        let Bodies { tree, gravity, numbers } = *bodies;
        let gravity: &[W; ARM_GRAVITY_PARAMETERS] = gravity.as_slice().try_into().ok()?;
        Some(ArmBodies { tree, gravity, numbers }.solved(q, v, force))
    }
}

/// The place of a body on another.
pub struct Pose<S> {
    /// Rotation whose columns are the axes of the body's frame.
    pub rotation: Rotation<S>,
    /// Axis of the body's joint.
    pub axis: Vector<S>,
    /// Step from the parent's origin to the body's, m.
    pub step: Vector<S>,
}

impl<S: Scalar> Pose<S> {
    /// The fixed frame that trees stand on.
    #[inline(always)]
    pub fn base() -> Self {
        let (o, i, none) = (S::zero(), S::one(), [S::zero(); 3]);
        Self { rotation: [[i, o, o], [o, i, o], [o, o, i]], axis: none, step: none }
    }
}

impl<S: Scalar> Frame<S> {
    /// Creates the frame of a body on this one; `turn` gives the sine and cosine of the joint's angle.
    #[inline(always)]
    pub fn moved<W: WeightFormat<Wide = S::Weight>>(
        &self,
        joint: Joint,
        body: &Body<'_, W>,
        q: Coordinate<S>,
        v: S,
    ) -> Self {
        let Pose { rotation, axis, step } = body.posed(&self.rotation, joint, q);
        let Twist { angular, linear } = self.velocity;
        let (along, linear) = (scale(v, axis), add(linear, cross(angular, step)));
        let velocity = match joint {
            Joint::Revolute => Twist { angular: add(angular, along), linear },
            Joint::Prismatic => Twist { angular, linear: add(linear, along) },
        };
        Self { joint, rotation, axis, step, velocity }
    }

    #[inline(always)]
    pub fn link(&self) -> Link<S> {
        Link { joint: self.joint, axis: self.axis, step: self.step }
    }
}

impl<S: Scalar> multibody::Frame<S> for Frame<S> {
    type Vector = Vector<S>;
    type Body<'a, W: WeightFormat<Wide = S::Weight> + 'a> = Body<'a, W>;
    type Bend = Twist<S>;
    type Wrench = Wrench<S>;
    type Carried = Carried<S>;
    type Rotor = Rotor<S>;
    type Pull = Vector<S>;
    type Twist = Twist<S>;
    type Inertial = [S; INERTIAL_PARAMETERS];

    fn base() -> Self {
        let Pose { rotation, axis, step } = Pose::base();
        Self { joint: Joint::Revolute, rotation, axis, step, velocity: Twist::zero() }
    }

    #[inline(always)]
    fn carried<W: WeightFormat<Wide = S::Weight>>(
        &self,
        joint: Joint,
        body: &Body<'_, W>,
        q: S,
        v: S,
    ) -> Self {
        self.moved(joint, body, Coordinate::new(joint, q), v)
    }

    #[inline(always)]
    fn step(&self) -> Vector<S> {
        self.step
    }

    #[inline(always)]
    fn share(&self, wrench: &Wrench<S>) -> S {
        self.link().share(wrench)
    }

    /// Velocity of the body crossed with its joint's axis, V × S.
    #[inline(always)]
    fn bend(&self) -> Twist<S> {
        let Twist { angular, linear } = self.velocity;
        match self.joint {
            Joint::Revolute => Twist { angular: cross(angular, self.axis), linear: cross(linear, self.axis) },
            Joint::Prismatic => Twist { angular: [S::zero(); 3], linear: cross(angular, self.axis) },
        }
    }

    #[inline(always)]
    fn bent(bend: &Twist<S>, wrench: &Wrench<S>) -> S {
        bend.dot(wrench)
    }

    #[inline(always)]
    fn pull(unit: &Wrench<S>, gravity: Vector<S>) -> Vector<S> {
        cross(unit.linear, gravity)
    }

    #[inline(always)]
    fn pulled(&self, pull: Vector<S>) -> S {
        match self.joint {
            Joint::Revolute => dot(self.axis, pull),
            Joint::Prismatic => S::zero(),
        }
    }

    #[inline(always)]
    fn unit_twist(&self, to: Vector<S>) -> Twist<S> {
        match self.joint {
            Joint::Revolute => Twist { angular: self.axis, linear: cross(self.axis, to) },
            Joint::Prismatic => Twist { angular: [S::zero(); 3], linear: self.axis },
        }
    }

    #[inline(always)]
    fn bend_twist(bend: &Twist<S>, to: Vector<S>) -> Twist<S> {
        Twist { angular: bend.angular, linear: add(bend.linear, cross(bend.angular, to)) }
    }

    /// With the twist (w, u) and the velocity (ω, ṙ), in the axes of the body: w·(Iω + mc × ṙ) + u·(mṙ + ω × mc).
    #[inline(always)]
    fn momentum_slopes(&self, twist: &Twist<S>) -> [S; INERTIAL_PARAMETERS] {
        let Twist { angular: w, linear: u } = self.in_own_axes(twist);
        let Twist { angular: o, linear: r } = self.in_own_axes(&self.velocity);
        let [x, y, z] = add(cross(r, w), cross(u, o));
        let both = |i: usize, j: usize| w[i] * o[j] + w[j] * o[i];
        [dot(u, r), x, y, z, w[0] * o[0], both(0, 1), w[1] * o[1], both(0, 2), both(1, 2), w[2] * o[2]]
    }

    /// γ·(mu + w × mc).
    #[inline(always)]
    fn gravity_slopes(&self, twist: &Twist<S>, gravity: Vector<S>) -> [S; INERTIAL_PARAMETERS] {
        let Twist { angular: w, linear: u } = self.in_own_axes(twist);
        let gravity = turned_back(&self.rotation, gravity);
        let ([x, y, z], zero) = (cross(gravity, w), S::zero());
        [dot(gravity, u), x, y, z, zero, zero, zero, zero, zero, zero]
    }
}

impl<S: Scalar> Frame<S> {
    #[inline(always)]
    fn in_own_axes(&self, twist: &Twist<S>) -> Twist<S> {
        let turned = |a| turned_back(&self.rotation, a);
        Twist { angular: turned(twist.angular), linear: turned(twist.linear) }
    }
}

/// Rotor inertia J of a joint's drive, reflected to the joint; the rotor turns about the joint's axis only.
#[derive(Clone, Copy, Debug)]
pub struct Rotor<S>(S);

impl<S: Scalar> multibody::Rotor<S, Frame<S>> for Rotor<S> {
    fn none() -> Self {
        Self(S::zero())
    }

    #[inline(always)]
    fn new<W: WeightFormat<Wide = S::Weight>>(_: &Frame<S>, body: &Body<'_, W>, _: S) -> Self {
        Self(body.rotor())
    }

    #[inline(always)]
    fn momentum(&self, v: S) -> S {
        self.0 * v
    }

    #[inline(always)]
    fn inertia(&self) -> S {
        self.0
    }

    #[inline(always)]
    fn below(&self, unit: Wrench<S>) -> Wrench<S> {
        unit
    }
}

/// Sums over a body and all that it carries, about the origin of its frame.
#[derive(Clone, Copy, Debug)]
pub struct Carried<S> {
    pub inertia: BodyInertia<S>,
    pub momentum: Wrench<S>,
}

impl<S: Scalar> Carried<S> {
    /// Adds a body with its velocity and its inertia in the axes of the base.
    #[inline(always)]
    pub fn with_body(&self, inertia: &BodyInertia<S>, velocity: &Twist<S>) -> Self {
        let momentum = self.momentum.plus(inertia.momentum(velocity));
        Self { inertia: self.inertia.plus(inertia), momentum }
    }

    /// Adds all that a joint at `step` on this body carries.
    #[inline(always)]
    pub fn with_joint(&self, step: Vector<S>, above: &Self) -> Self {
        let momentum = self.momentum.plus(above.momentum.about(step));
        Self { inertia: self.inertia.plus(&above.inertia.about(step)), momentum }
    }
}

impl<S: Scalar> multibody::Carried<S, Frame<S>> for Carried<S> {
    fn nothing() -> Self {
        Self { inertia: BodyInertia::zero(), momentum: Wrench::zero() }
    }

    #[inline(always)]
    fn begun<W: WeightFormat<Wide = S::Weight>>(frame: &Frame<S>, body: &Body<'_, W>) -> Self {
        Self::nothing().with_body(&body.inertia(&frame.rotation), &frame.velocity)
    }

    #[inline(always)]
    fn finished<W: WeightFormat<Wide = S::Weight>>(self, _: &Frame<S>, _: &Body<'_, W>) -> Self {
        self
    }

    #[inline(always)]
    fn with_joint<W: WeightFormat<Wide = S::Weight>>(
        &self,
        joint: &Frame<S>,
        above: &Self,
        _: &Body<'_, W>,
        _: &Rotor<S>,
    ) -> Self {
        self.with_joint(joint.step, above)
    }

    #[inline(always)]
    fn momentum(&self) -> &Wrench<S> {
        &self.momentum
    }

    #[inline(always)]
    fn moment(&self, direction: Vector<S>) -> S {
        dot(direction, self.inertia.moment)
    }

    #[inline(always)]
    fn unit_momentum(&self, frame: &Frame<S>) -> Wrench<S> {
        self.inertia.unit_momentum(frame.joint, frame.axis)
    }

    /// S ×* momentum + the momentum at velocity `bend`.
    #[inline(always)]
    fn momentum_slope(&self, frame: &Frame<S>, bend: &Twist<S>) -> Wrench<S> {
        let (axis, Wrench { angular, linear }) = (frame.axis, self.momentum);
        let BodyInertia { mass, moment, .. } = self.inertia;
        match frame.joint {
            Joint::Revolute => {
                let turned = Wrench { angular: cross(axis, angular), linear: cross(axis, linear) };
                turned.plus(self.inertia.momentum(bend))
            }
            Joint::Prismatic => Wrench {
                angular: add(cross(axis, linear), cross(moment, bend.linear)),
                linear: scale(mass, bend.linear),
            },
        }
    }
}

impl<S: Scalar> BodyInertia<S> {
    /// The momentum at a unit velocity of a joint with this axis.
    #[inline(always)]
    pub(super) fn unit_momentum(&self, joint: Joint, axis: Vector<S>) -> Wrench<S> {
        match joint {
            Joint::Revolute => Wrench { angular: self.turning(axis), linear: cross(axis, self.moment) },
            Joint::Prismatic => Wrench { angular: cross(self.moment, axis), linear: scale(self.mass, axis) },
        }
    }
}
