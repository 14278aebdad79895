//! What the recursion over a tree of bodies asks of the kind of space that they move in.

use super::Joint;
use crate::scalar::Scalar;

/// A kind of space, known by its vectors: `[S; 2]` is the plane, `[S; 3]` space. A body has `B` numbers there.
pub trait Space<S: Scalar, const B: usize>: Copy {
    /// How frames are there.
    type Frame: Frame<S, Vector = Self>;

    /// A body by its numbers in the order of the weight block.
    fn body(numbers: [S; B]) -> <Self::Frame as Frame<S>>::Body;
}

/// The frame of a body at its joint, in motion.
pub trait Frame<S: Scalar>: Copy {
    /// A direction.
    type Vector: Copy;
    /// The numbers of a body.
    type Body;
    /// z, what ∂T/∂q of a joint makes of momentum.
    type Bend: Copy;
    /// Momentum or force, about a joint.
    type Wrench: Wrench<S, Vector = Self::Vector>;
    /// Sums over all that a joint carries.
    type Carried: Carried<S, Self>;
    /// The rotor of a joint's drive.
    type Rotor: Rotor<S, Self>;
    /// Force of gravity as the coordinate of a joint takes it.
    type Pull: Copy;

    /// The frame that does not move, on which trees stand.
    fn base() -> Self;
    /// The frame of a body on this one.
    fn carried(&self, joint: Joint, body: &Self::Body, q: S, v: S) -> Self;
    /// From the parent's joint to this one, m.
    fn step(&self) -> Self::Vector;
    /// The part of momentum or force at this joint that its coordinate has.
    fn share(&self, wrench: &Self::Wrench) -> S;
    /// z of this joint.
    fn bend(&self) -> Self::Bend;
    /// z·wrench.
    fn bent(bend: &Self::Bend, wrench: &Self::Wrench) -> S;
    /// How γ acts on the momentum `unit` of a unit velocity when it turns.
    fn pull(unit: &Self::Wrench, gravity: Self::Vector) -> Self::Pull;
    /// The part of a pull at this joint that its coordinate has.
    fn pulled(&self, pull: Self::Pull) -> S;
}

/// A linear and an angular part, the angular one about a joint.
pub trait Wrench<S: Scalar>: Copy {
    /// A direction.
    type Vector;

    /// Wrench about a joint from which this one is at `step`.
    fn about(self, step: Self::Vector) -> Self;
    /// The linear part along a direction.
    fn along(&self, direction: Self::Vector) -> S;
}

/// Sums over a body and all that it carries, about its joint.
pub trait Carried<S: Scalar, F: Frame<S>>: Copy {
    /// No body.
    fn nothing() -> Self;
    /// The sums to which those of the joints on a body are added. A body enters them before or after its joints: the order of a sum
    /// is part of its bits, and every space keeps its own.
    fn begun(frame: &F, body: &F::Body) -> Self;
    /// With the body itself, where [`Carried::begun`] has left it out.
    fn finished(self, frame: &F, body: &F::Body) -> Self;
    /// With all that a joint on this body carries, and the rotor of its drive; `body` is that of the joint.
    fn with_joint(&self, joint: &F, above: &Self, body: &F::Body, rotor: &F::Rotor) -> Self;
    /// The momentum.
    fn momentum(&self) -> &F::Wrench;
    /// The first moments Σ m(x − r) along a direction.
    fn moment(&self, direction: F::Vector) -> S;
    /// ∂/∂q̇ of momentum: that of a unit velocity of the joint.
    fn unit_momentum(&self, frame: &F) -> F::Wrench;
    /// ∂/∂q of momentum, about a point that does not move with q; `bend` is that of the joint.
    fn momentum_slope(&self, frame: &F, bend: &F::Bend) -> F::Wrench;
}

/// The rotor of a joint's drive.
pub trait Rotor<S: Scalar, F: Frame<S>>: Copy {
    /// No rotor.
    fn none() -> Self;
    /// The rotor of a body's joint on `parent`.
    fn new(parent: &F, body: &F::Body, v: S) -> Self;
    /// The part of the joint's momentum p that is the rotor's.
    fn momentum(&self, v: S) -> S;
    /// ∂/∂q̇ of that part.
    fn inertia(&self) -> S;
    /// The momentum `unit` of a unit velocity of the joint, as the joints below have it: with what the rotor adds.
    fn below(&self, unit: F::Wrench) -> F::Wrench;
}
