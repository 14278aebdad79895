//! Where a tree's frames are and how they move, from the ground up, and what every joint carries, from the tips down.

use super::vector::{Vector, Wrench, across, add, cross, dot, scale, turned};
use super::{BodyParameters, Joint};
use crate::scalar::Scalar;

/// The frame of a body at its joint; vectors are in the frame of the ground.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame<S> {
    pub joint: Joint,
    /// φ, rad.
    angle: S,
    /// φ̇, rad/s.
    pub spin: S,
    /// Its x axis, (cos φ, sin φ).
    pub axis: Vector<S>,
    /// From the parent's joint to this one, m.
    pub step: Vector<S>,
    /// ṙ of this one, m/s.
    pub velocity: Vector<S>,
}

impl<S: Scalar> Frame<S> {
    pub fn ground() -> Self {
        let (zero, none) = (S::zero(), [S::zero(); 2]);
        let axis = [S::one(), zero];
        Self { joint: Joint::Revolute, angle: zero, spin: zero, axis, step: none, velocity: none }
    }

    /// The frame of a body on this one.
    #[inline(always)]
    pub fn carried(&self, joint: Joint, numbers: &BodyParameters<S>, q: S, v: S) -> Self {
        let step = turned(self.axis, numbers.place);
        let velocity = add(self.velocity, scale(self.spin, across(step)));
        let angle = self.angle + numbers.angle;
        match joint {
            Joint::Revolute => {
                let angle = angle + q;
                Self { joint, angle, spin: self.spin + v, axis: direction(angle), step, velocity }
            }
            Joint::Prismatic => {
                let axis = direction(angle);
                let speed = add(scale(v, axis), scale(self.spin * q, across(axis)));
                let (step, velocity) = (add(step, scale(q, axis)), add(velocity, speed));
                Self { joint, angle, spin: self.spin, axis, step, velocity }
            }
        }
    }

    /// The part of momentum or force at this joint that its coordinate has.
    #[inline(always)]
    pub fn share(&self, wrench: &Wrench<S>) -> S {
        match self.joint {
            Joint::Revolute => wrench.angular,
            Joint::Prismatic => dot(self.axis, wrench.linear),
        }
    }

    /// z with ∂/∂q of Σ m ẋ·y = z·Σ m y over all that the joint carries, y a velocity that moves with it: −⊥ṙ of a revolute
    /// joint, φ̇⊥u of a prismatic one along u.
    #[inline(always)]
    pub fn bend(&self) -> Vector<S> {
        match self.joint {
            Joint::Revolute => scale(-S::one(), across(self.velocity)),
            Joint::Prismatic => scale(self.spin, across(self.axis)),
        }
    }
}

#[inline(always)]
fn direction<S: Scalar>(angle: S) -> Vector<S> {
    let (sin, cos) = angle.sin_cos();
    [cos, sin]
}

/// Sums over a body and all that it carries, about its joint r.
#[derive(Clone, Copy, Debug)]
pub(super) struct Carried<S> {
    /// Σ m, kg.
    pub mass: S,
    /// Σ m(x − r), kg m.
    pub moment: Vector<S>,
    /// Σ m|x − r|² + I + J of the rotors that sit on these bodies, kg m².
    inertia: S,
    /// Σ mẋ and Σ m(x − r) × ẋ + Iφ̇ + J(φ̇_parent + gq̇).
    pub momentum: Wrench<S>,
}

impl<S: Scalar> Carried<S> {
    pub fn nothing() -> Self {
        let (zero, none) = (S::zero(), [S::zero(); 2]);
        let momentum = Wrench { linear: none, angular: zero };
        Self { mass: zero, moment: none, inertia: zero, momentum }
    }

    /// With the body whose frame this is.
    #[inline(always)]
    pub fn with_body(self, frame: &Frame<S>, numbers: &BodyParameters<S>) -> Self {
        let lever = turned(frame.axis, numbers.centre);
        let velocity = add(frame.velocity, scale(frame.spin, across(lever)));
        let (moment, momentum) = (scale(numbers.mass, lever), scale(numbers.mass, velocity));
        let angular = numbers.inertia * frame.spin + cross(lever, momentum);
        Self {
            mass: self.mass + numbers.mass,
            moment: add(self.moment, moment),
            inertia: self.inertia + numbers.inertia + dot(moment, lever),
            momentum: Wrench {
                linear: add(self.momentum.linear, momentum),
                angular: self.momentum.angular + angular,
            },
        }
    }

    /// With all that a joint on this body carries, and the drive of that joint: its rotor and the rotor's momentum.
    #[inline(always)]
    pub fn with_joint(self, joint: &Frame<S>, above: &Self, rotor: S, of_rotor: S) -> Self {
        let step = joint.step;
        let from_here = scale(above.mass, step);
        let moment = add(above.moment, from_here);
        // Σ m|x − r|² = Σ m|x − r′|² + (Σ m(x − r′) + Σ m(x − r))·(r′ − r).
        let inertia = above.inertia + dot(add(above.moment, moment), step);
        let momentum = above.momentum.about(step);
        Self {
            mass: self.mass + above.mass,
            moment: add(self.moment, moment),
            inertia: self.inertia + inertia + rotor,
            momentum: Wrench {
                linear: add(self.momentum.linear, momentum.linear),
                angular: self.momentum.angular + momentum.angular + of_rotor,
            },
        }
    }

    /// ∂/∂q̇ of its momentum: that of a unit velocity of the joint that carries it.
    #[inline(always)]
    pub fn unit_momentum(&self, frame: &Frame<S>) -> Wrench<S> {
        match frame.joint {
            Joint::Revolute => Wrench { linear: across(self.moment), angular: self.inertia },
            Joint::Prismatic => {
                Wrench { linear: scale(self.mass, frame.axis), angular: cross(self.moment, frame.axis) }
            }
        }
    }

    /// ∂/∂q of its momentum about a joint that does not move with q.
    #[inline(always)]
    pub fn momentum_slope(&self, frame: &Frame<S>) -> Wrench<S> {
        match frame.joint {
            Joint::Revolute => {
                let relative = add(self.momentum.linear, scale(-self.mass, frame.velocity));
                Wrench { linear: across(relative), angular: -dot(self.moment, frame.velocity) }
            }
            Joint::Prismatic => {
                let turning = dot(self.moment, frame.axis) * frame.spin;
                Wrench {
                    linear: scale(self.mass * frame.spin, across(frame.axis)),
                    angular: turning + cross(frame.axis, self.momentum.linear),
                }
            }
        }
    }
}
