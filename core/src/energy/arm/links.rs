//! Recursions over a tree that need no velocities of points: poses, accelerations and inertias from the base up, and sums over all that a
//! joint carries from the tips down.

use super::body::{Body, Coordinates};
use super::motion::Pose;
use super::vector::{Rotation, Twist, Vector, Wrench, add, cross, dot, scale};
use super::{ArmBodies, BodyInertia, Joint};
use crate::energy::multibody::Wrench as _;
use crate::expected::present;
use crate::scalar::{Scalar, WeightFormat};

/// A joint in the axes of the base.
#[derive(Clone, Copy)]
pub struct Link<S> {
    pub joint: Joint,
    pub axis: Vector<S>,
    /// Step from the parent's origin to this one, m.
    pub step: Vector<S>,
}

impl<S: Scalar> Link<S> {
    /// The component of a force at the joint along its coordinate.
    #[inline(always)]
    pub fn share(&self, wrench: &Wrench<S>) -> S {
        match self.joint {
            Joint::Revolute => dot(self.axis, wrench.angular),
            Joint::Prismatic => dot(self.axis, wrench.linear),
        }
    }

    /// Angular acceleration of the body, and acceleration of its origin. `spin` is the parent's angular velocity and `parent` its
    /// acceleration; `v` and `a` are the velocity and acceleration of the joint, the latter 0 if it is `None`.
    #[inline(always)]
    pub fn accelerated(&self, spin: Vector<S>, parent: &Twist<S>, v: S, a: Option<S>) -> Twist<S> {
        let Twist { angular, linear } = *parent;
        let carried = add(cross(angular, self.step), cross(spin, cross(spin, self.step)));
        let (linear, turning) = (add(linear, carried), scale(v, cross(spin, self.axis)));
        let with_joint = |more| a.map_or(more, |a| add(scale(a, self.axis), more));
        match self.joint {
            Joint::Revolute => Twist { angular: add(angular, with_joint(turning)), linear },
            Joint::Prismatic => Twist { angular, linear: add(linear, with_joint(add(turning, turning))) },
        }
    }
}

/// A body on its way up and down the tree.
#[derive(Clone, Copy)]
pub struct Node<S, X> {
    pub link: Link<S>,
    /// Rotation whose columns are the axes of the body's frame.
    rotation: Rotation<S>,
    /// Sums over all that the joint carries, and more of the body's own.
    pub sums: X,
}

/// No nodes, which are not written before they are known: those of lanes take kilobytes.
#[inline(always)]
pub fn no_nodes<T, const N: usize>() -> [Option<T>; N] {
    core::array::from_fn(|_| None)
}

/// The node k, which is there, and its parent's; none if it stands on the base.
#[inline(always)]
pub fn with_parent<T>(
    nodes: &mut [Option<T>],
    k: usize,
    parent: Option<usize>,
) -> Option<(&T, Option<&mut T>)> {
    let (below, from_k) = present(nodes.split_at_mut_checked(k))?;
    let own = present(from_k.first()?.as_ref())?;
    Some((own, parent.and_then(|parent| present(below.get_mut(parent)?.as_mut()))))
}

impl<W: WeightFormat, const N: usize> ArmBodies<'_, W, N> {
    /// Places all bodies, from the base up. `sums` takes the number of a body, its parent, its link and its inertia in the axes of the base.
    #[inline(always)]
    pub(super) fn place<S: Scalar<Weight = W::Wide>, X>(
        &self,
        q: &[S; N],
        nodes: &mut [Option<Node<S, X>>; N],
        sums: impl Fn(usize, Option<&X>, &Link<S>, BodyInertia<S>) -> X,
    ) {
        let base = Pose::base().rotation;
        let coordinates = Coordinates::new(q);
        for k in 0..N {
            let (body, joint) = (Body(&self.numbers[k]), self.tree.bodies()[k].joint);
            let parent = self.parent(k).and_then(|parent| present(nodes.get(parent)?.as_ref()));
            let below = parent.map_or(&base, |parent| &parent.rotation);
            let Pose { rotation, axis, step } = body.posed(below, joint, coordinates.of(k));
            let link = Link { joint, axis, step };
            let inertia = body.inertia(&rotation);
            let sums = sums(k, parent.map(|parent| &parent.sums), &link, inertia);
            nodes[k] = Some(Node { link, rotation, sums });
        }
    }

    /// The acceleration that holds bodies against gravity.
    #[inline(always)]
    pub(super) fn falling<S: Scalar<Weight = W::Wide>>(&self) -> Twist<S> {
        let [x, y, z]: Vector<S> = self.gravity();
        Twist { linear: [-x, -y, -z], ..Twist::zero() }
    }

    #[inline(always)]
    pub(super) fn rotor<S: Scalar<Weight = W::Wide>>(&self, k: usize) -> S {
        Body(&self.numbers[k]).rotor()
    }
}

/// Acceleration of a body, and the force on all that its joint carries.
#[derive(Clone, Copy)]
pub struct Accelerated<S> {
    spin: Vector<S>,
    acceleration: Twist<S>,
    pub force: Wrench<S>,
}

impl<S: Scalar> Accelerated<S> {
    /// The base, which does not turn.
    #[inline(always)]
    pub fn base(falling: Twist<S>) -> Self {
        Self { spin: [S::zero(); 3], acceleration: falling, force: Wrench::zero() }
    }

    /// Creates the body on `below` with the velocity and the acceleration of its joint; without the latter, for 0.
    #[inline(always)]
    pub fn on(below: &Self, link: &Link<S>, (v, a): (S, Option<S>), inertia: &BodyInertia<S>) -> Self {
        let acceleration = link.accelerated(below.spin, &below.acceleration, v, a);
        let spin = match link.joint {
            Joint::Revolute => add(below.spin, scale(v, link.axis)),
            Joint::Prismatic => below.spin,
        };
        Self { spin, acceleration, force: inertia.force(spin, &acceleration) }
    }
}

/// Momentum at a unit velocity of a joint, on its way down the tree.
pub struct Unit<S> {
    momentum: Wrench<S>,
    step: Vector<S>,
}

impl<S: Scalar> Unit<S> {
    #[inline(always)]
    pub fn new(link: &Link<S>, inertia: &BodyInertia<S>) -> (Self, S) {
        let momentum = inertia.unit_momentum(link.joint, link.axis);
        (Self { momentum, step: link.step }, link.share(&momentum))
    }

    /// Entry of M for the joint below.
    #[inline(always)]
    pub fn at(&mut self, link: &Link<S>) -> S {
        self.momentum = self.momentum.about(self.step);
        self.step = link.step;
        link.share(&self.momentum)
    }
}
