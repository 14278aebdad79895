//! Frames and velocities of a tree, from the ground up, and sums over all that every joint carries, from the tips down.

use super::vector::{Vector, Wrench, across, add, cross, dot, scale, turned, turned_back};
use super::{BODY_PARAMETERS, BodyParameters, Joint, PLANAR_INERTIAL_PARAMETERS};
use crate::energy::multibody::{self, Space, Wrench as _};
use crate::scalar::{Scalar, WeightFormat};

/// The frame of a body at its joint; vectors are in the axes of the ground.
#[derive(Clone, Copy, Debug)]
pub struct Frame<S> {
    joint: Joint,
    /// Angle φ, rad.
    angle: S,
    /// Angular velocity φ̇, rad/s.
    spin: S,
    /// The x axis of the frame, (cos φ, sin φ).
    axis: Vector<S>,
    /// Step from the parent's joint to this joint, m.
    step: Vector<S>,
    /// Velocity ṙ of the frame's origin, m/s.
    velocity: Vector<S>,
}

impl<S: Scalar> Space<S, BODY_PARAMETERS> for Vector<S> {
    type Frame = Frame<S>;

    #[inline(always)]
    fn body<W: WeightFormat<Wide = S::Weight>>(numbers: &[W; BODY_PARAMETERS]) -> BodyParameters<S> {
        BodyParameters::from_array(numbers.map(W::scalar))
    }
}

impl<S: Scalar> multibody::Frame<S> for Frame<S> {
    type Vector = Vector<S>;
    type Body<'a, W: WeightFormat<Wide = S::Weight> + 'a> = BodyParameters<S>;
    /// z, which acts on the linear part of momentum alone.
    type Bend = Vector<S>;
    type Wrench = Wrench<S>;
    type Carried = Carried<S>;
    type Rotor = Rotor<S>;
    type Pull = S;
    /// Angular velocity w, and velocity u of a point.
    type Twist = (S, Vector<S>);
    type Inertial = [S; PLANAR_INERTIAL_PARAMETERS];

    fn base() -> Self {
        let (zero, none) = (S::zero(), [S::zero(); 2]);
        let axis = [S::one(), zero];
        Self { joint: Joint::Revolute, angle: zero, spin: zero, axis, step: none, velocity: none }
    }

    #[inline(always)]
    fn carried<W: WeightFormat<Wide = S::Weight>>(
        &self,
        joint: Joint,
        body: &BodyParameters<S>,
        q: S,
        v: S,
    ) -> Self {
        let step = turned(self.axis, body.place);
        let velocity = add(self.velocity, scale(self.spin, across(step)));
        let angle = self.angle + body.angle;
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

    #[inline(always)]
    fn step(&self) -> Vector<S> {
        self.step
    }

    #[inline(always)]
    fn share(&self, wrench: &Wrench<S>) -> S {
        match self.joint {
            Joint::Revolute => wrench.angular,
            Joint::Prismatic => dot(self.axis, wrench.linear),
        }
    }

    /// −⊥ṙ for a revolute joint, φ̇⊥u for a prismatic one along u.
    #[inline(always)]
    fn bend(&self) -> Vector<S> {
        match self.joint {
            Joint::Revolute => scale(-S::one(), across(self.velocity)),
            Joint::Prismatic => scale(self.spin, across(self.axis)),
        }
    }

    #[inline(always)]
    fn bent(bend: &Vector<S>, wrench: &Wrench<S>) -> S {
        dot(*bend, wrench.linear)
    }

    #[inline(always)]
    fn pull(unit: &Wrench<S>, gravity: Vector<S>) -> S {
        dot(gravity, across(unit.linear))
    }

    #[inline(always)]
    fn pulled(&self, pull: S) -> S {
        match self.joint {
            Joint::Revolute => pull,
            Joint::Prismatic => S::zero(),
        }
    }

    #[inline(always)]
    fn unit_twist(&self, to: Vector<S>) -> (S, Vector<S>) {
        match self.joint {
            Joint::Revolute => (S::one(), across(to)),
            Joint::Prismatic => (S::zero(), self.axis),
        }
    }

    #[inline(always)]
    fn bend_twist(bend: &Vector<S>, _: Vector<S>) -> (S, Vector<S>) {
        (S::zero(), *bend)
    }

    /// With the velocity (φ̇, ṙ): w (Iφ̇ + mc × ṙ) + u·(mṙ + φ̇⊥mc).
    #[inline(always)]
    fn momentum_slopes(&self, (w, u): &(S, Vector<S>)) -> [S; PLANAR_INERTIAL_PARAMETERS] {
        let moment = across(add(scale(self.spin, *u), scale(*w, self.velocity)));
        let [x, y] = turned_back(self.axis, scale(-S::one(), moment));
        [dot(*u, self.velocity), x, y, *w * self.spin]
    }

    /// γ·(mu + w⊥mc).
    #[inline(always)]
    fn gravity_slopes(&self, (w, u): &(S, Vector<S>), gravity: Vector<S>) -> [S; PLANAR_INERTIAL_PARAMETERS] {
        let [x, y] = turned_back(self.axis, scale(-*w, across(gravity)));
        [dot(gravity, *u), x, y, S::zero()]
    }
}

#[inline(always)]
fn direction<S: Scalar>(angle: S) -> Vector<S> {
    let (sin, cos) = angle.sin_cos();
    [cos, sin]
}

/// The rotor of a joint's drive, which sits on the parent.
#[derive(Clone, Copy, Debug)]
pub struct Rotor<S> {
    /// J(φ̇_parent + gq̇), kg m²/s.
    momentum: S,
    /// Coupling Jg: the rotor's part of the inertia between the joint and the joints below.
    coupling: S,
    gear: S,
}

impl<S: Scalar> multibody::Rotor<S, Frame<S>> for Rotor<S> {
    fn none() -> Self {
        Self { momentum: S::zero(), coupling: S::zero(), gear: S::zero() }
    }

    #[inline(always)]
    fn new<W: WeightFormat<Wide = S::Weight>>(parent: &Frame<S>, body: &BodyParameters<S>, v: S) -> Self {
        let BodyParameters { rotor, gear, .. } = *body;
        Self { momentum: rotor * (parent.spin + gear * v), coupling: rotor * gear, gear }
    }

    #[inline(always)]
    fn momentum(&self, _: S) -> S {
        self.gear * self.momentum
    }

    #[inline(always)]
    fn inertia(&self) -> S {
        self.gear * self.coupling
    }

    #[inline(always)]
    fn below(&self, unit: Wrench<S>) -> Wrench<S> {
        Wrench { angular: unit.angular + self.coupling, ..unit }
    }
}

/// Sums over a body and all that it carries, about its joint r.
#[derive(Clone, Copy, Debug)]
pub struct Carried<S> {
    /// Σ m, kg.
    mass: S,
    /// Σ m(x − r), kg m.
    moment: Vector<S>,
    /// Σ m|x − r|² + I + J of the rotors that sit on these bodies, kg m².
    inertia: S,
    /// Σ mẋ and Σ m(x − r) × ẋ + Iφ̇ + J(φ̇_parent + gq̇).
    momentum: Wrench<S>,
}

impl<S: Scalar> multibody::Carried<S, Frame<S>> for Carried<S> {
    fn nothing() -> Self {
        let (zero, none) = (S::zero(), [S::zero(); 2]);
        let momentum = Wrench { linear: none, angular: zero };
        Self { mass: zero, moment: none, inertia: zero, momentum }
    }

    #[inline(always)]
    fn begun<W: WeightFormat<Wide = S::Weight>>(_: &Frame<S>, _: &BodyParameters<S>) -> Self {
        Self::nothing()
    }

    #[inline(always)]
    fn finished<W: WeightFormat<Wide = S::Weight>>(self, frame: &Frame<S>, body: &BodyParameters<S>) -> Self {
        let lever = turned(frame.axis, body.centre);
        let velocity = add(frame.velocity, scale(frame.spin, across(lever)));
        let (moment, momentum) = (scale(body.mass, lever), scale(body.mass, velocity));
        let angular = body.inertia * frame.spin + cross(lever, momentum);
        Self {
            mass: self.mass + body.mass,
            moment: add(self.moment, moment),
            inertia: self.inertia + body.inertia + dot(moment, lever),
            momentum: Wrench {
                linear: add(self.momentum.linear, momentum),
                angular: self.momentum.angular + angular,
            },
        }
    }

    #[inline(always)]
    fn with_joint<W: WeightFormat<Wide = S::Weight>>(
        &self,
        joint: &Frame<S>,
        above: &Self,
        body: &BodyParameters<S>,
        rotor: &Rotor<S>,
    ) -> Self {
        let step = joint.step;
        let from_here = scale(above.mass, step);
        let moment = add(above.moment, from_here);
        // Σ m|x − r|² = Σ m|x − r′|² + (Σ m(x − r′) + Σ m(x − r))·(r′ − r).
        let inertia = above.inertia + dot(add(above.moment, moment), step);
        let momentum = above.momentum.about(step);
        Self {
            mass: self.mass + above.mass,
            moment: add(self.moment, moment),
            inertia: self.inertia + inertia + body.rotor,
            momentum: Wrench {
                linear: add(self.momentum.linear, momentum.linear),
                angular: self.momentum.angular + momentum.angular + rotor.momentum,
            },
        }
    }

    #[inline(always)]
    fn momentum(&self) -> &Wrench<S> {
        &self.momentum
    }

    #[inline(always)]
    fn moment(&self, direction: Vector<S>) -> S {
        dot(direction, self.moment)
    }

    #[inline(always)]
    fn unit_momentum(&self, frame: &Frame<S>) -> Wrench<S> {
        match frame.joint {
            Joint::Revolute => Wrench { linear: across(self.moment), angular: self.inertia },
            Joint::Prismatic => {
                Wrench { linear: scale(self.mass, frame.axis), angular: cross(self.moment, frame.axis) }
            }
        }
    }

    #[inline(always)]
    fn momentum_slope(&self, frame: &Frame<S>, _: &Vector<S>) -> Wrench<S> {
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
