//! Where a tree's frames are and how they move, from the base up, and what every joint carries, from the tips down.
//!
//! All vectors are in the axes of the base, and those of a body about the origin of its frame: no sum is turned on its way to
//! the base, and none loses digits to a far origin.

use super::vector::{Rotation, Twist, Vector, Wrench, add, cross, product, scale, turned, turned_about};
use super::{Joint, SpatialInertia, SpatialParameters};
use crate::scalar::Scalar;

/// The frame of a body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame<S> {
    pub joint: Joint,
    /// Its axes are the columns.
    pub rotation: Rotation<S>,
    /// The axis of its joint.
    pub axis: Vector<S>,
    /// From the parent's origin to its own, m.
    pub step: Vector<S>,
    /// ω and ṙ.
    pub velocity: Twist<S>,
}

impl<S: Scalar> Frame<S> {
    pub fn base() -> Self {
        let (zero, one, none) = (S::zero(), S::one(), [S::zero(); 3]);
        let rotation = [[one, zero, zero], [zero, one, zero], [zero, zero, one]];
        Self { joint: Joint::Revolute, rotation, axis: none, step: none, velocity: Twist::zero() }
    }

    /// Where a body on this one is; its velocity is left 0.
    #[inline(always)]
    pub fn placed(&self, joint: Joint, numbers: &SpatialParameters<S>, q: S) -> Self {
        let rotation = product(&self.rotation, &numbers.rotation);
        let axis = turned(&rotation, numbers.axis);
        let place = turned(&self.rotation, numbers.place);
        let (rotation, step) = match joint {
            Joint::Revolute => (turned_about(&rotation, (axis, numbers.axis), q), place),
            Joint::Prismatic => (rotation, add(place, scale(q, axis))),
        };
        Self { joint, rotation, axis, step, velocity: Twist::zero() }
    }

    /// The frame of a body on this one.
    #[inline(always)]
    pub fn carried(&self, joint: Joint, numbers: &SpatialParameters<S>, q: S, v: S) -> Self {
        let frame = self.placed(joint, numbers, q);
        let Twist { angular, linear } = self.velocity;
        let (along, linear) = (scale(v, frame.axis), add(linear, cross(angular, frame.step)));
        let velocity = match joint {
            Joint::Revolute => Twist { angular: add(angular, along), linear },
            Joint::Prismatic => Twist { angular, linear: add(linear, along) },
        };
        Self { velocity, ..frame }
    }

    /// Angular acceleration and acceleration of the origin of a body on the joint of this frame, whose parent has angular
    /// velocity `spin` and accelerates so.
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

    /// The part of momentum or force at this joint that its coordinate has.
    #[inline(always)]
    pub fn share(&self, wrench: &Wrench<S>) -> S {
        match self.joint {
            Joint::Revolute => super::vector::dot(self.axis, wrench.angular),
            Joint::Prismatic => super::vector::dot(self.axis, wrench.linear),
        }
    }

    /// z with ∂T/∂q = z·(momentum of all that the joint carries): the velocity of its body against its axis, V × S.
    #[inline(always)]
    pub fn bend(&self) -> Twist<S> {
        let Twist { angular, linear } = self.velocity;
        match self.joint {
            Joint::Revolute => Twist { angular: cross(angular, self.axis), linear: cross(linear, self.axis) },
            Joint::Prismatic => Twist { angular: [S::zero(); 3], linear: cross(angular, self.axis) },
        }
    }
}

/// Sums over a body and all that it carries, about the origin of its frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Carried<S> {
    pub inertia: SpatialInertia<S>,
    pub momentum: Wrench<S>,
}

impl<S: Scalar> Carried<S> {
    pub fn nothing() -> Self {
        Self { inertia: SpatialInertia::zero(), momentum: Wrench::zero() }
    }

    /// With a body of this velocity, its inertia in the axes of the base.
    #[inline(always)]
    pub fn with_body(&self, inertia: &SpatialInertia<S>, velocity: &Twist<S>) -> Self {
        let momentum = self.momentum.plus(inertia.momentum(velocity));
        Self { inertia: self.inertia.plus(inertia), momentum }
    }

    /// With all that a joint at `step` on this body carries.
    #[inline(always)]
    pub fn with_joint(&self, step: Vector<S>, above: &Self) -> Self {
        let momentum = self.momentum.plus(above.momentum.about(step));
        Self { inertia: self.inertia.plus(&above.inertia.about(step)), momentum }
    }

    /// ∂/∂q̇ of its momentum: that of a unit velocity of the joint that carries it.
    #[inline(always)]
    pub fn unit_momentum(&self, frame: &Frame<S>) -> Wrench<S> {
        self.inertia.unit_momentum(frame)
    }

    /// ∂/∂q of its momentum about a point that does not move with q: S ×* momentum + inertia of `bend`.
    #[inline(always)]
    pub fn momentum_slope(&self, frame: &Frame<S>, bend: &Twist<S>) -> Wrench<S> {
        let (axis, Wrench { angular, linear }) = (frame.axis, self.momentum);
        let SpatialInertia { mass, moment, .. } = self.inertia;
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

impl<S: Scalar> SpatialInertia<S> {
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
