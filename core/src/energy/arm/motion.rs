//! Frames and velocities of a tree, from the base up, and sums over all that every joint carries, from the tips down.
//!
//! All vectors are in the axes of the base, and a body's moments are about the origin of its own frame. Sums need no rotation on their way
//! to the base, and lose no digits to a far origin.

use super::vector::{
    Rotation, Twist, Vector, Wrench, add, cross, dot, product, scale, turned, turned_about, turned_back,
};
use super::{ARM_PARAMETERS, ArmParameters, BodyInertia, INERTIAL_PARAMETERS, Joint};
use crate::energy::multibody::{self, Space, Wrench as _};
use crate::scalar::Scalar;

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
    fn body(numbers: [S; ARM_PARAMETERS]) -> ArmParameters<S> {
        ArmParameters::from_array(numbers)
    }
}

impl<S: Scalar> Frame<S> {
    /// Places the frame of a body that stands on this one; the velocity of the new frame is left at 0.
    #[inline(always)]
    pub fn placed(&self, joint: Joint, numbers: &ArmParameters<S>, q: S) -> Self {
        let rotation = product(&self.rotation, &numbers.rotation);
        let axis = turned(&rotation, numbers.axis);
        let place = turned(&self.rotation, numbers.place);
        let (rotation, step) = match joint {
            Joint::Revolute => (turned_about(&rotation, (axis, numbers.axis), q), place),
            Joint::Prismatic => (rotation, add(place, scale(q, axis))),
        };
        Self { joint, rotation, axis, step, velocity: Twist::zero() }
    }

    /// Angular acceleration of the body of this frame, and acceleration of its origin. `spin` is the parent's
    /// angular velocity and `parent` its acceleration; `v` and `a` are the velocity and acceleration of the
    /// joint.
    #[inline(always)]
    pub fn accelerated(&self, spin: Vector<S>, parent: &Twist<S>, v: S, a: S) -> Twist<S> {
        let Twist { angular, linear } = *parent;
        let carried = add(cross(angular, self.step), cross(spin, cross(spin, self.step)));
        let (linear, turning) = (add(linear, carried), scale(v, cross(spin, self.axis)));
        let along = scale(a, self.axis);
        match self.joint {
            Joint::Revolute => Twist { angular: add(angular, add(along, turning)), linear },
            Joint::Prismatic => Twist { angular, linear: add(linear, add(along, add(turning, turning))) },
        }
    }
}

impl<S: Scalar> multibody::Frame<S> for Frame<S> {
    type Vector = Vector<S>;
    type Body = ArmParameters<S>;
    type Bend = Twist<S>;
    type Wrench = Wrench<S>;
    type Carried = Carried<S>;
    type Rotor = Rotor<S>;
    type Pull = Vector<S>;
    type Twist = Twist<S>;
    type Inertial = [S; INERTIAL_PARAMETERS];

    fn base() -> Self {
        let (zero, one, none) = (S::zero(), S::one(), [S::zero(); 3]);
        let rotation = [[one, zero, zero], [zero, one, zero], [zero, zero, one]];
        Self { joint: Joint::Revolute, rotation, axis: none, step: none, velocity: Twist::zero() }
    }

    #[inline(always)]
    fn carried(&self, joint: Joint, body: &ArmParameters<S>, q: S, v: S) -> Self {
        let frame = self.placed(joint, body, q);
        let Twist { angular, linear } = self.velocity;
        let (along, linear) = (scale(v, frame.axis), add(linear, cross(angular, frame.step)));
        let velocity = match joint {
            Joint::Revolute => Twist { angular: add(angular, along), linear },
            Joint::Prismatic => Twist { angular, linear: add(linear, along) },
        };
        Self { velocity, ..frame }
    }

    #[inline(always)]
    fn step(&self) -> Vector<S> {
        self.step
    }

    #[inline(always)]
    fn share(&self, wrench: &Wrench<S>) -> S {
        match self.joint {
            Joint::Revolute => dot(self.axis, wrench.angular),
            Joint::Prismatic => dot(self.axis, wrench.linear),
        }
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
    fn new(_: &Frame<S>, body: &ArmParameters<S>, _: S) -> Self {
        Self(body.rotor)
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
    fn begun(frame: &Frame<S>, body: &ArmParameters<S>) -> Self {
        Self::nothing().with_body(&body.inertia.turned(&frame.rotation), &frame.velocity)
    }

    #[inline(always)]
    fn finished(self, _: &Frame<S>, _: &ArmParameters<S>) -> Self {
        self
    }

    #[inline(always)]
    fn with_joint(&self, joint: &Frame<S>, above: &Self, _: &ArmParameters<S>, _: &Rotor<S>) -> Self {
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
        self.inertia.unit_momentum(frame)
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
    /// The momentum at a unit velocity of the joint of this frame.
    #[inline(always)]
    pub(super) fn unit_momentum(&self, frame: &Frame<S>) -> Wrench<S> {
        let axis = frame.axis;
        match frame.joint {
            Joint::Revolute => Wrench { angular: self.turning(axis), linear: cross(axis, self.moment) },
            Joint::Prismatic => Wrench { angular: cross(self.moment, axis), linear: scale(self.mass, axis) },
        }
    }
}
