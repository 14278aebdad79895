//! Derivatives of the drive forces with respect to positions and velocities.

use super::motion::{Carried, Frame};
use super::vector::{Rotation, Twist, Vector, Wrench, add, cross, dot, scale};
use super::{ArmBodies, BodyInertia, Joint};
use crate::energy::multibody::{Carried as _, Frame as _, Wrench as _};
use crate::expected::{expected, present};
use crate::linear::Matrix;
use crate::scalar::{Scalar, WeightFormat};
use core::array::from_fn;

/// Derivatives of τ(q, v, v̇) = M v̇ + L_vq v − L_q; ∂τ/∂v̇ is [`ArmBodies::mass_matrix`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InverseDynamicsDerivatives<S, const N: usize> {
    /// ∂τ_i/∂q_j, N m/rad if both joints are revolute.
    pub force_q: Matrix<S, N>,
    /// ∂τ_i/∂v_j, N m s/rad if both joints are revolute.
    pub force_v: Matrix<S, N>,
}

/// Sums over all that a joint carries, about the origin of its frame, at given velocities and accelerations.
#[derive(Clone, Copy)]
struct Driven<S> {
    carried: Carried<S>,
    /// The force that accelerates the carried bodies, gravity included.
    force: Wrench<S>,
    /// ∫ u xᵀ dm over the masses, with their velocities u and places x.
    spread: Rotation<S>,
}

impl<S: Scalar> Driven<S> {
    fn nothing() -> Self {
        Self { carried: Carried::nothing(), force: Wrench::zero(), spread: [[S::zero(); 3]; 3] }
    }

    /// Sums for one body, with its inertia in the axes of the base; `acceleration` is the acceleration of its origin.
    #[inline(always)]
    fn body(inertia: &BodyInertia<S>, velocity: &Twist<S>, acceleration: &Twist<S>) -> Self {
        let carried = Carried::nothing().with_body(inertia, velocity);
        let second = second_moments(inertia);
        let columns: [Vector<S>; 3] =
            from_fn(|j| add(cross(velocity.angular, second[j]), scale(inertia.moment[j], velocity.linear)));
        let spread = from_fn(|i| from_fn(|j| columns[j][i]));
        Self { carried, force: inertia.force(velocity.angular, acceleration), spread }
    }

    /// Adds all that a joint at `step` carries.
    #[inline(always)]
    fn with_joint(&self, step: Vector<S>, above: &Self) -> Self {
        let flow = above.carried.momentum.linear;
        Self {
            carried: self.carried.with_joint(step, &above.carried),
            force: self.force.plus(above.force.about(step)),
            spread: from_fn(|i| from_fn(|j| self.spread[i][j] + above.spread[i][j] + flow[i] * step[j])),
        }
    }

    fn trace(&self) -> S {
        self.spread[0][0] + self.spread[1][1] + self.spread[2][2]
    }

    /// 2∫ x × (α × u) dm and 2α × ∫ u dm: the Coriolis force on masses that also rotate with α.
    #[inline(always)]
    fn coriolis(&self, alpha: Vector<S>) -> Wrench<S> {
        let trace = self.trace();
        let angular = from_fn(|i| trace * alpha[i] - dot(self.spread[i], alpha));
        let linear = cross(alpha, self.carried.momentum.linear);
        Wrench { angular: angular.map(twice), linear: linear.map(twice) }
    }

    /// The joint's share of [`Driven::coriolis`], as a linear function of α.
    #[inline(always)]
    fn coriolis_share(&self, frame: &Frame<S>) -> Vector<S> {
        let (axis, trace) = (frame.axis, self.trace());
        let share = match frame.joint {
            Joint::Revolute => from_fn(|i| {
                let column = from_fn(|j: usize| self.spread[j][i]);
                trace * axis[i] - dot(column, axis)
            }),
            Joint::Prismatic => cross(self.carried.momentum.linear, axis),
        };
        share.map(twice)
    }
}

fn twice<S: Scalar>(x: S) -> S {
    x + x
}

/// ∫ xxᵀ dm = ½ tr(I)·1 − I.
#[inline(always)]
fn second_moments<S: Scalar>(inertia: &BodyInertia<S>) -> Rotation<S> {
    let [xx, xy, yy, xz, yz, zz] = inertia.matrix;
    let half = (xx + yy + zz).half();
    [[half - xx, -xy, -xz], [-xy, half - yy, -yz], [-xz, -yz, half - zz]]
}

/// V × x for two motions about the same point.
#[inline(always)]
fn crossed<S: Scalar>(v: &Twist<S>, x: &Twist<S>) -> Twist<S> {
    let linear = add(cross(v.angular, x.linear), cross(v.linear, x.angular));
    Twist { angular: cross(v.angular, x.angular), linear }
}

/// ψ = A × S + V × (V × S): the derivative, with respect to a joint's coordinate, of the acceleration of all
/// that the joint carries. A is the spatial acceleration, r̈ − ω × ṙ at the origin.
#[inline(always)]
fn acceleration_bend<S: Scalar>(frame: &Frame<S>, bend: &Twist<S>, acceleration: &Twist<S>) -> Twist<S> {
    let Twist { angular, linear } = frame.velocity;
    let apart = cross(angular, linear);
    let spatial =
        Twist { angular: acceleration.angular, linear: from_fn(|i| acceleration.linear[i] - apart[i]) };
    let moved = Frame { velocity: spatial, ..*frame }.bend();
    let turned = crossed(&frame.velocity, bend);
    Twist { angular: add(moved.angular, turned.angular), linear: add(moved.linear, turned.linear) }
}

/// S ×* F.
#[inline(always)]
fn turned_force<S: Scalar>(frame: &Frame<S>, force: &Wrench<S>) -> Wrench<S> {
    let axis = frame.axis;
    match frame.joint {
        Joint::Revolute => Wrench { angular: cross(axis, force.angular), linear: cross(axis, force.linear) },
        Joint::Prismatic => Wrench { angular: cross(axis, force.linear), linear: [S::zero(); 3] },
    }
}

impl<W: WeightFormat, const N: usize> ArmBodies<'_, W, N> {
    /// Computes ∂τ/∂q and ∂τ/∂v of [`ArmBodies::inverse_dynamics`] at (q, v, v̇), without friction. O(n · depth).
    ///
    /// Let z = V × S and ψ = A × S + V × z, let F and I be the force and inertia of all that a joint carries, and Cx the Coriolis force
    /// that a motion x adds. For a joint k that j carries (or j itself):
    /// ∂τ_j/∂q_k = S_j·(C z_k + Iψ_k + S_k ×* F), ∂τ_j/∂v_k = S_j·(C S_k + 2I z_k), and for j below k
    /// ∂τ_k/∂q_j = S_k·(C z_j + Iψ_j), ∂τ_k/∂v_j = S_k·(C S_j + 2I z_j), with I, F and C of joint k.
    /// If numbers leave the range of S, the result is not finite.
    ///
    /// Source: Carpentier and Mansard, *Analytical derivatives of rigid body dynamics algorithms*, 2018.
    pub fn inverse_dynamics_derivatives<S: Scalar<Weight = W::Wide>>(
        &self,
        q: &[S; N],
        v: &[S; N],
        acceleration: &[S; N],
    ) -> InverseDynamicsDerivatives<S, N> {
        let mut motion = Moved::new(self, q, v, acceleration);
        let zero = [[S::zero(); N]; N];
        let mut sum = InverseDynamicsDerivatives { force_q: zero, force_v: zero };
        for k in (0..N).rev() {
            motion.differentiate(self, k, &mut sum);
        }
        sum
    }
}

/// A tree in accelerated motion.
struct Moved<S, const N: usize> {
    frames: [Frame<S>; N],
    bends: [Twist<S>; N],
    acceleration_bends: [Twist<S>; N],
    driven: [Driven<S>; N],
}

impl<S: Scalar, const N: usize> Moved<S, N> {
    fn new<W: WeightFormat<Wide = S::Weight>>(
        bodies: &ArmBodies<W, N>,
        q: &[S; N],
        v: &[S; N],
        acceleration: &[S; N],
    ) -> Self {
        let (base, still) = (Frame::base(), [Twist::zero(); N]);
        let falling = Twist { linear: bodies.gravity().map(|g: S| -g), ..Twist::zero() };
        let mut twists = [falling; N];
        let mut moved = Self {
            frames: [base; N],
            bends: still,
            acceleration_bends: still,
            driven: [Driven::nothing(); N],
        };
        for k in 0..N {
            let numbers = bodies.body(k);
            let on = |parent: usize| Some((moved.frames.get(parent).copied()?, twists.get(parent).copied()?));
            let on = |parent| expected(on(parent), (base, falling));
            let (parent, below) = bodies.parent(k).map_or((base, falling), on);
            let frame = parent.carried(bodies.tree.bodies()[k].joint, &numbers, q[k], v[k]);
            let twist = frame.accelerated(parent.velocity.angular, &below, v[k], acceleration[k]);
            let inertia = numbers.inertia.turned(&frame.rotation);
            moved.driven[k] = Driven::body(&inertia, &frame.velocity, &twist);
            let bend = frame.bend();
            moved.acceleration_bends[k] = acceleration_bend(&frame, &bend, &twist);
            (moved.frames[k], moved.bends[k], twists[k]) = (frame, bend, twist);
        }
        moved
    }

    /// Fills row and column k for the joints below, then adds all that joint k carries to its parent.
    #[inline(always)]
    fn differentiate<W: WeightFormat>(
        &mut self,
        bodies: &ArmBodies<W, N>,
        k: usize,
        sum: &mut InverseDynamicsDerivatives<S, N>,
    ) {
        let (frame, own, bend) = (self.frames[k], self.driven[k], self.bends[k]);
        let inertia = &own.carried.inertia;
        let (mut unit, share) = (own.carried.unit_momentum(&frame), own.coriolis_share(&frame));
        let mut of_q = turned_force(&frame, &own.force).plus(own.coriolis(bend.angular));
        of_q = of_q.plus(inertia.momentum(&self.acceleration_bends[k]));
        let of_bend = inertia.momentum(&bend);
        let mut of_v = of_bend.plus(of_bend);
        if matches!(frame.joint, Joint::Revolute) {
            of_v = of_v.plus(own.coriolis(frame.axis));
        }
        (sum.force_q[k][k], sum.force_v[k][k]) = (frame.share(&of_q), frame.share(&of_v));
        if let Some(below) = bodies.parent(k).and_then(|parent| self.driven.get_mut(parent)) {
            *below = below.with_joint(frame.step, &own);
        }
        let (mut step, mut below) = (frame.step, bodies.parent(k));
        while let Some(j) = below {
            let Some(frame) = present(self.frames.get(j)) else { break };
            (unit, of_q, of_v) = (unit.about(step), of_q.about(step), of_v.about(step));
            let (bend, moved) = (&self.bends[j], &self.acceleration_bends[j]);
            (sum.force_q[j][k], sum.force_v[j][k]) = (frame.share(&of_q), frame.share(&of_v));
            sum.force_q[k][j] = dot(share, bend.angular) + moved.dot(&unit);
            sum.force_v[k][j] = twice(bend.dot(&unit));
            if matches!(frame.joint, Joint::Revolute) {
                sum.force_v[k][j] += dot(share, frame.axis);
            }
            (step, below) = (frame.step, bodies.parent(j));
        }
    }
}
