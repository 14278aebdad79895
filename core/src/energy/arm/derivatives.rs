//! Derivatives of the drive forces with respect to positions and velocities.

use super::body::{Body, Coordinates};
use super::links::{no_nodes, with_parent};
use super::motion::{Carried, Frame};
use super::vector::{Rotation, Twist, Vector, Wrench, add, cross, dot, scale, subtracted};
use super::{ArmBodies, BodyInertia, Joint};
use crate::energy::multibody::{Carried as _, Frame as _, Wrench as _};
use crate::expected::present;
use crate::linear::Matrix;
use crate::scalar::{Scalar, WeightFormat};

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
    /// Sums for one body, with its inertia in the axes of the base; `acceleration` is the acceleration of its origin.
    #[inline(always)]
    fn body(inertia: &BodyInertia<S>, velocity: &Twist<S>, acceleration: &Twist<S>) -> Self {
        let carried = Carried::nothing().with_body(inertia, velocity);
        let second = second_moments(inertia);
        let column =
            |j: usize| add(cross(velocity.angular, second[j]), scale(inertia.moment[j], velocity.linear));
        let [a, b, c] = [column(0), column(1), column(2)];
        let spread = [[a[0], b[0], c[0]], [a[1], b[1], c[1]], [a[2], b[2], c[2]]];
        Self { carried, force: inertia.force(velocity.angular, acceleration), spread }
    }

    /// Adds all that a joint at `step` carries.
    #[inline(always)]
    fn with_joint(&self, step: Vector<S>, above: &Self) -> Self {
        let flow = above.carried.momentum.linear;
        let entry = |i: usize, j: usize| self.spread[i][j] + above.spread[i][j] + flow[i] * step[j];
        let row = |i: usize| [entry(i, 0), entry(i, 1), entry(i, 2)];
        Self {
            carried: self.carried.with_joint(step, &above.carried),
            force: self.force.plus(above.force.about(step)),
            spread: [row(0), row(1), row(2)],
        }
    }

    fn trace(&self) -> S {
        self.spread[0][0] + self.spread[1][1] + self.spread[2][2]
    }

    /// 2∫ x × (α × u) dm and 2α × ∫ u dm: the Coriolis force on masses that also rotate with α.
    #[inline(always)]
    fn coriolis(&self, alpha: Vector<S>) -> Wrench<S> {
        let trace = self.trace();
        let entry = |i: usize| trace * alpha[i] - dot(self.spread[i], alpha);
        let linear = cross(alpha, self.carried.momentum.linear);
        Wrench { angular: doubled([entry(0), entry(1), entry(2)]), linear: doubled(linear) }
    }

    /// The joint's share of [`Driven::coriolis`], as a linear function of α.
    #[inline(always)]
    fn coriolis_share(&self, frame: &Frame<S>) -> Vector<S> {
        let (axis, trace) = (frame.axis, self.trace());
        let share = match frame.joint {
            Joint::Revolute => {
                let column = |i: usize| [self.spread[0][i], self.spread[1][i], self.spread[2][i]];
                let entry = |i: usize| trace * axis[i] - dot(column(i), axis);
                [entry(0), entry(1), entry(2)]
            }
            Joint::Prismatic => cross(self.carried.momentum.linear, axis),
        };
        doubled(share)
    }
}

fn twice<S: Scalar>(x: S) -> S {
    x + x
}

#[inline(always)]
fn doubled<S: Scalar>(x: Vector<S>) -> Vector<S> {
    add(x, x)
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
    let spatial = Twist { angular: acceleration.angular, linear: subtracted(acceleration.linear, apart) };
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
        let mut moved = no_nodes();
        self.move_all(q, v, acceleration, &mut moved);
        let zero = [[S::zero(); N]; N];
        let mut sum = InverseDynamicsDerivatives { force_q: zero, force_v: zero };
        for k in (0..N).rev() {
            self.differentiate(&mut moved, k, &mut sum);
        }
        sum
    }

    /// Moves all bodies, from the base up.
    #[inline(always)]
    fn move_all<S: Scalar<Weight = W::Wide>>(
        &self,
        q: &[S; N],
        v: &[S; N],
        acceleration: &[S; N],
        moved: &mut [Option<Moved<S>>; N],
    ) {
        let (base, falling, coordinates) = (Frame::base(), self.falling(), Coordinates::new(q));
        for k in 0..N {
            let (body, joint) = (Body(&self.numbers[k]), self.tree.bodies()[k].joint);
            let parent = self.parent(k).and_then(|parent| present(moved.get(parent)?.as_ref()));
            let (below, below_acceleration) =
                parent.map_or((&base, &falling), |parent| (&parent.frame, &parent.acceleration));
            let frame = below.moved(joint, &body, coordinates.of(k), v[k]);
            let spin = below.velocity.angular;
            let twist = frame.link().accelerated(spin, below_acceleration, v[k], Some(acceleration[k]));
            let inertia = body.inertia(&frame.rotation);
            moved[k] = Some(Moved::new(frame, &inertia, twist));
        }
    }

    /// Fills row and column k for the joints below, then adds all that joint k carries to its parent.
    #[inline(always)]
    fn differentiate<S: Scalar>(
        &self,
        moved: &mut [Option<Moved<S>>; N],
        k: usize,
        sum: &mut InverseDynamicsDerivatives<S, N>,
    ) {
        let mut below = self.parent(k);
        let Some((Moved { frame, driven, bend, acceleration_bend, .. }, parent)) =
            with_parent(moved, k, below)
        else {
            return;
        };
        let inertia = &driven.carried.inertia;
        let (mut unit, share) = (driven.carried.unit_momentum(frame), driven.coriolis_share(frame));
        let mut of_q = turned_force(frame, &driven.force).plus(driven.coriolis(bend.angular));
        of_q = of_q.plus(inertia.momentum(acceleration_bend));
        let of_bend = inertia.momentum(bend);
        let mut of_v = of_bend.plus(of_bend);
        if matches!(frame.joint, Joint::Revolute) {
            of_v = of_v.plus(driven.coriolis(frame.axis));
        }
        (sum.force_q[k][k], sum.force_v[k][k]) = (frame.share(&of_q), frame.share(&of_v));
        let mut step = frame.step;
        if let Some(parent) = parent {
            parent.driven = parent.driven.with_joint(step, driven);
        }
        while let Some(j) = below {
            let Some(Some(Moved { frame, bend, acceleration_bend, .. })) = present(moved.get(j)) else {
                break;
            };
            (unit, of_q, of_v) = (unit.about(step), of_q.about(step), of_v.about(step));
            (sum.force_q[j][k], sum.force_v[j][k]) = (frame.share(&of_q), frame.share(&of_v));
            sum.force_q[k][j] = dot(share, bend.angular) + acceleration_bend.dot(&unit);
            sum.force_v[k][j] = twice(bend.dot(&unit));
            if matches!(frame.joint, Joint::Revolute) {
                sum.force_v[k][j] += dot(share, frame.axis);
            }
            (step, below) = (frame.step, self.parent(j));
        }
    }
}

/// A body in accelerated motion.
struct Moved<S> {
    frame: Frame<S>,
    acceleration: Twist<S>,
    bend: Twist<S>,
    acceleration_bend: Twist<S>,
    driven: Driven<S>,
}

impl<S: Scalar> Moved<S> {
    #[inline(always)]
    fn new(frame: Frame<S>, inertia: &BodyInertia<S>, acceleration: Twist<S>) -> Self {
        let bend = frame.bend();
        let acceleration_bend = acceleration_bend(&frame, &bend, &acceleration);
        let driven = Driven::body(inertia, &frame.velocity, &acceleration);
        Self { frame, acceleration, bend, acceleration_bend, driven }
    }
}
