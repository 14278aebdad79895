//! Interface between the recursion over a tree of bodies and the space that they move in.

use super::{Bodies, Joint};
use crate::linear::SolveError;
use crate::scalar::{Real, Scalar, WeightFormat};

/// A kind of space, identified by its vectors: `[S; 2]` is the plane, `[S; 3]` three-dimensional space. A body has `B` numbers.
pub trait Space<S: Scalar, const B: usize>: Copy {
    /// Frame type of the space.
    type Frame: Frame<S, Vector = Self>;

    /// Reads a body from its numbers in the order of the weight block.
    fn body<W: WeightFormat<Wide = S::Weight>>(numbers: &[W; B]) -> <Self::Frame as Frame<S>>::Body<'_, W>;

    /// Whether [`Space::forward_dynamics`] has an answer.
    const SOLVES: bool = false;

    /// The acceleration under a force, if there is a faster way than the terms of the equation of motion and elimination.
    #[inline(always)]
    fn forward_dynamics<W: WeightFormat<Wide = S::Weight>, const D: usize, const N: usize>(
        _bodies: &Bodies<W, D, B, N>,
        _q: &[S; N],
        _v: &[S; N],
        _force: &[S; N],
    ) -> Option<Result<[S; N], SolveError>>
    where
        S: Real,
    {
        None
    }
}

/// The frame of a body at its joint, in motion.
pub trait Frame<S: Scalar>: Copy {
    /// A direction.
    type Vector: Copy;
    /// The numbers of a body.
    type Body<'a, W: WeightFormat<Wide = S::Weight> + 'a>;
    /// z, whose product with momentum is ∂T/∂q of a joint.
    type Bend: Copy;
    /// Momentum or force, about a joint.
    type Wrench: Wrench<S, Vector = Self::Vector>;
    /// Sums over all that a joint carries.
    type Carried: Carried<S, Self>;
    /// The rotor of a joint's drive.
    type Rotor: Rotor<S, Self>;
    /// Derivative of γ·U under rotation of U, before its component along a joint's coordinate is taken.
    type Pull: Copy;
    /// Angular velocity, and linear velocity of a point.
    type Twist: Copy;
    /// Inertial numbers of a body, in which its energies are linear.
    type Inertial: Copy + AsRef<[S]>;

    /// The fixed frame that trees stand on.
    fn base() -> Self;
    /// The frame of a body that stands on this one.
    fn carried<W: WeightFormat<Wide = S::Weight>>(
        &self,
        joint: Joint,
        body: &Self::Body<'_, W>,
        q: S,
        v: S,
    ) -> Self;
    /// Step from the parent's joint to this joint, m.
    fn step(&self) -> Self::Vector;
    /// The component of momentum or force at this joint along its coordinate.
    fn share(&self, wrench: &Self::Wrench) -> S;
    /// z of this joint.
    fn bend(&self) -> Self::Bend;
    /// z·wrench.
    fn bent(bend: &Self::Bend, wrench: &Self::Wrench) -> S;
    /// Derivative of γ·`unit` under rotation of `unit`, the momentum of a unit velocity.
    fn pull(unit: &Self::Wrench, gravity: Self::Vector) -> Self::Pull;
    /// The component of a pull at this joint along its coordinate.
    fn pulled(&self, pull: Self::Pull) -> S;

    /// The twist of a point at `to` from this joint's origin, at a unit velocity of the joint.
    fn unit_twist(&self, to: Self::Vector) -> Self::Twist;
    /// z as a twist of a point at `to` from the joint's origin.
    fn bend_twist(bend: &Self::Bend, to: Self::Vector) -> Self::Twist;
    /// Derivatives, in the inertial numbers of the body of this frame, of its momentum along a twist of the frame's origin.
    fn momentum_slopes(&self, twist: &Self::Twist) -> Self::Inertial;
    /// Derivatives, in the same numbers, of γ·U, U the linear momentum of the body at this twist.
    fn gravity_slopes(&self, twist: &Self::Twist, gravity: Self::Vector) -> Self::Inertial;
}

/// A linear part, and an angular part about a joint.
pub trait Wrench<S: Scalar>: Copy {
    /// A direction.
    type Vector;

    /// Expresses the wrench about another joint; `step` leads from that joint to this one.
    fn about(self, step: Self::Vector) -> Self;
    /// The linear part along a direction.
    fn along(&self, direction: Self::Vector) -> S;
}

/// Sums over a body and all that it carries, about its joint.
pub trait Carried<S: Scalar, F: Frame<S>>: Copy {
    /// No body.
    fn nothing() -> Self;
    /// Initial sums, to which the sums of the joints on a body are added. Every space adds the body itself either here or at the end, and
    /// keeps its choice: the order of a sum affects its bits.
    fn begun<W: WeightFormat<Wide = S::Weight>>(frame: &F, body: &F::Body<'_, W>) -> Self;
    /// Adds the body itself, if [`Carried::begun`] has left it out.
    fn finished<W: WeightFormat<Wide = S::Weight>>(self, frame: &F, body: &F::Body<'_, W>) -> Self;
    /// Adds all that a joint on this body carries, and the rotor of the joint's drive; `body` is the body of that joint.
    fn with_joint<W: WeightFormat<Wide = S::Weight>>(
        &self,
        joint: &F,
        above: &Self,
        body: &F::Body<'_, W>,
        rotor: &F::Rotor,
    ) -> Self;
    /// The momentum.
    fn momentum(&self) -> &F::Wrench;
    /// The first moments Σ m(x − r) along a direction.
    fn moment(&self, direction: F::Vector) -> S;
    /// ∂P/∂q̇ of the momentum P: the momentum at a unit velocity of the joint.
    fn unit_momentum(&self, frame: &F) -> F::Wrench;
    /// ∂P/∂q of the momentum P, about a point that does not move with q; `bend` is the joint's.
    fn momentum_slope(&self, frame: &F, bend: &F::Bend) -> F::Wrench;
}

/// The rotor of a joint's drive.
pub trait Rotor<S: Scalar, F: Frame<S>>: Copy {
    /// No rotor.
    fn none() -> Self;
    /// The rotor of a body's joint on `parent`.
    fn new<W: WeightFormat<Wide = S::Weight>>(parent: &F, body: &F::Body<'_, W>, v: S) -> Self;
    /// The rotor's part of the joint's momentum p.
    fn momentum(&self, v: S) -> S;
    /// ∂/∂q̇ of the rotor's part of p.
    fn inertia(&self) -> S;
    /// Adds the rotor's momentum to `unit`, the momentum at a unit velocity of the joint, as the joints below
    /// see it.
    fn below(&self, unit: F::Wrench) -> F::Wrench;
}
