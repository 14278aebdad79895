use super::motion::{Carried, Frame};
use super::vector::{Twist, Vector, Wrench, cross, dot};
use super::{
    Joint, SPATIAL_GRAVITY_PARAMETERS, SPATIAL_PARAMETERS, SpatialInertia, SpatialParameters, SpatialTree,
};
use crate::expected::{expected, present};
use crate::lagrangian::{Energies, Gradient, Hessian, Lagrangian, Linearization};
use crate::linear;
use crate::scalar::{Scalar, WeightFormat};

/// A tree of N rigid bodies on joints in space, over borrowed weights.
///
/// # Method
///
/// With the spatial axis S and velocity V of a joint's frame, H the momentum and I the inertia of all that the joint carries,
/// z = V × S, U = IS = ∂H/∂q̇ and D = S ×* H + Iz = ∂H/∂q,
///
/// p_j = S_j·H_j + J_j q̇_j,  L_q,j = z_j·H_j + γ·U_j,
///
/// and for a joint k that j carries (or j itself) M_jk = S_j·U_k, ∂p_j/∂q_k = S_j·D_k, ∂p_k/∂q_j = z_j·U_k and
/// ∂²T/∂q_j∂q_k = z_j·D_k. Time is O(n · depth), and O(n) of what has no matrix.
#[derive(Clone, Copy, Debug)]
pub struct SpatialBodies<'a, W, const N: usize> {
    /// Which body stands on which, by what joint.
    pub tree: SpatialTree<N>,
    /// γ in the axes of the base, m/s².
    pub gravity: &'a [W; SPATIAL_GRAVITY_PARAMETERS],
    /// The [`SpatialParameters`] of every body, as they stand in the weight block.
    pub numbers: &'a [[W; SPATIAL_PARAMETERS]; N],
}

impl<'a, W: WeightFormat, const N: usize> SpatialBodies<'a, W, N> {
    /// The tree over the front of `block`, of which the rest is left there: γ, then the numbers of every body. `None` where the
    /// block is too short.
    pub fn take(block: &mut &'a [W], tree: SpatialTree<N>) -> Option<Self> {
        let (gravity, rest) = block.split_first_chunk()?;
        let (numbers, rest) = rest.split_at_checked(N * SPATIAL_PARAMETERS)?;
        let numbers = numbers.as_chunks().0.try_into().ok()?;
        *block = rest;
        Some(Self { tree, gravity, numbers })
    }

    pub(super) fn gravity<S: Scalar<Weight = W::Wide>>(&self) -> Vector<S> {
        self.gravity.map(W::scalar)
    }

    #[inline(always)]
    pub(super) fn body<S: Scalar<Weight = W::Wide>>(&self, k: usize) -> SpatialParameters<S> {
        SpatialParameters::from_array(self.numbers[k].map(W::scalar))
    }

    pub(super) fn parent(&self, k: usize) -> Option<usize> {
        self.tree.bodies()[k].parent.map(usize::from)
    }

    /// The force of the drives that gives the acceleration v̇ at (q, v): M v̇ + L_vq v − L_q, N m or N, friction apart. O(n), by the
    /// recursion of Newton and Euler.
    pub fn inverse_dynamics<S: Scalar<Weight = W::Wide>>(
        &self,
        q: &[S; N],
        v: &[S; N],
        acceleration: &[S; N],
    ) -> [S; N] {
        let (base, falling) =
            (Frame::base(), Twist { linear: self.gravity().map(|g: S| -g), ..Twist::zero() });
        let (mut frames, mut twists, mut wrenches) = ([base; N], [falling; N], [Wrench::zero(); N]);
        for k in 0..N {
            let numbers = self.body(k);
            let on = |parent: usize| Some((frames.get(parent).copied()?, twists.get(parent).copied()?));
            let on = |parent| expected(on(parent), (base, falling));
            let (parent, below) = self.parent(k).map_or((base, falling), on);
            let frame = parent.carried(self.tree.bodies()[k].joint, &numbers, q[k], v[k]);
            let twist = frame.accelerated(parent.velocity.angular, &below, v[k], acceleration[k]);
            wrenches[k] = numbers.inertia.turned(&frame.rotation).force(frame.velocity.angular, &twist);
            (frames[k], twists[k]) = (frame, twist);
        }
        let mut force = [S::zero(); N];
        for k in (0..N).rev() {
            let rotor: S = W::scalar(self.numbers[k][SPATIAL_PARAMETERS - 1]);
            force[k] = frames[k].share(&wrenches[k]) + rotor * acceleration[k];
            let carried = wrenches[k].about(frames[k].step);
            if let Some(below) = self.parent(k).and_then(|parent| wrenches.get_mut(parent)) {
                *below = below.plus(carried);
            }
        }
        force
    }

    /// What the drives must hold against gravity, V_q, N m or N.
    pub fn gravity_torque<S: Scalar<Weight = W::Wide>>(&self, q: &[S; N]) -> [S; N] {
        let (motion, gravity) = (Motion::new(self, q, &[S::zero(); N]), self.gravity());
        core::array::from_fn(|k| -dot(gravity, motion.unit(k).linear))
    }

    /// M(q), symmetric: the composite inertias of all that a joint carries, without velocities.
    pub fn mass_matrix<S: Scalar<Weight = W::Wide>>(&self, q: &[S; N]) -> [[S; N]; N] {
        let base = Frame::base();
        let (mut frames, mut inertias) = ([base; N], [SpatialInertia::zero(); N]);
        let mut mass = [[S::zero(); N]; N];
        for k in 0..N {
            let numbers = self.body(k);
            let on = |parent: usize| expected(frames.get(parent).copied(), base);
            let frame = self.parent(k).map_or(base, on).placed(self.tree.bodies()[k].joint, &numbers, q[k]);
            inertias[k] = numbers.inertia.turned(&frame.rotation);
            (frames[k], mass[k][k]) = (frame, numbers.rotor);
        }
        for k in (0..N).rev() {
            let (mut step, mut unit) = (frames[k].step, inertias[k].unit_momentum(&frames[k]));
            mass[k][k] = frames[k].share(&unit) + mass[k][k];
            let carried = inertias[k].about(step);
            if let Some(below) = self.parent(k).and_then(|parent| inertias.get_mut(parent)) {
                *below = below.plus(&carried);
            }
            let mut below = self.parent(k);
            while let Some(j) = below {
                let Some(frame) = present(frames.get(j)) else { break };
                unit = unit.about(step);
                mass[j][k] = frame.share(&unit);
                mass[k][j] = mass[j][k];
                (step, below) = (frame.step, self.parent(j));
            }
        }
        mass
    }

    /// All derivatives but L_qq, which is written where it is asked for.
    #[inline(always)]
    fn derivatives<S: Scalar<Weight = W::Wide>>(
        &self,
        q: &[S; N],
        v: &[S; N],
        mut l_qq: Option<&mut [[S; N]; N]>,
    ) -> Linearization<S, N> {
        let (motion, gravity) = (Motion::new(self, q, v), self.gravity());
        let (mut l_vq, mut l_vv) = ([[S::zero(); N]; N], [[S::zero(); N]; N]);
        for k in 0..N {
            let (frame, carried, bend) = (&motion.frames[k], &motion.carried[k], motion.bends[k]);
            let (mut unit, mut slope) = (motion.unit(k), carried.momentum_slope(frame, &bend));
            let pull = cross(unit.linear, gravity);
            l_vv[k][k] = frame.share(&unit) + motion.rotors[k];
            l_vq[k][k] = frame.share(&slope);
            if let Some(l_qq) = &mut l_qq {
                l_qq[k][k] = bend.dot(&slope) + bent(frame, pull);
            }
            // A loop, not a closure: where it is not inlined, an index is not known to be one.
            let (mut step, mut below) = (frame.step, self.parent(k));
            while let Some(j) = below {
                let Some(frame) = present(motion.frames.get(j)) else { break };
                (unit, slope) = (unit.about(step), slope.about(step));
                let bend = &motion.bends[j];
                l_vv[j][k] = frame.share(&unit);
                l_vv[k][j] = l_vv[j][k];
                (l_vq[j][k], l_vq[k][j]) = (frame.share(&slope), bend.dot(&unit));
                if let Some(l_qq) = &mut l_qq {
                    l_qq[j][k] = bend.dot(&slope) + bent(frame, pull);
                    l_qq[k][j] = l_qq[j][k];
                }
                (step, below) = (frame.step, self.parent(j));
            }
        }
        Linearization { l_q: motion.force(gravity), l_v: motion.momentum(v), l_vq, l_vv }
    }
}

/// ∂²/∂q_j∂q_k of γ·Σ m x, with what joint k gives of it against γ.
#[inline(always)]
fn bent<S: Scalar>(frame: &Frame<S>, pull: Vector<S>) -> S {
    match frame.joint {
        Joint::Revolute => dot(frame.axis, pull),
        Joint::Prismatic => S::zero(),
    }
}

/// A tree in motion.
struct Motion<S, const N: usize> {
    frames: [Frame<S>; N],
    bends: [Twist<S>; N],
    carried: [Carried<S>; N],
    rotors: [S; N],
    /// All together, about the origin of the base.
    whole: Carried<S>,
}

impl<S: Scalar, const N: usize> Motion<S, N> {
    #[inline(always)]
    fn new<W: WeightFormat<Wide = S::Weight>>(bodies: &SpatialBodies<W, N>, q: &[S; N], v: &[S; N]) -> Self {
        let mut motion = Self {
            frames: [Frame::base(); N],
            bends: [Twist::zero(); N],
            carried: [Carried::nothing(); N],
            rotors: [S::zero(); N],
            whole: Carried::nothing(),
        };
        for k in 0..N {
            let numbers = bodies.body(k);
            let on = |parent: usize| expected(motion.frames.get(parent).copied(), Frame::base());
            let parent = bodies.parent(k).map_or(Frame::base(), on);
            let frame = parent.carried(bodies.tree.bodies()[k].joint, &numbers, q[k], v[k]);
            let inertia = numbers.inertia.turned(&frame.rotation);
            motion.carried[k] = Carried::nothing().with_body(&inertia, &frame.velocity);
            (motion.frames[k], motion.bends[k], motion.rotors[k]) = (frame, frame.bend(), numbers.rotor);
        }
        for k in (0..N).rev() {
            let (step, own) = (motion.frames[k].step, motion.carried[k]);
            let below = bodies.parent(k).and_then(|parent| motion.carried.get_mut(parent));
            let below = below.unwrap_or(&mut motion.whole);
            *below = below.with_joint(step, &own);
        }
        motion
    }

    /// What a joint carries at its unit velocity.
    #[inline(always)]
    fn unit(&self, k: usize) -> Wrench<S> {
        self.carried[k].unit_momentum(&self.frames[k])
    }

    /// L_q.
    fn force(&self, gravity: Vector<S>) -> [S; N] {
        core::array::from_fn(|k| {
            self.bends[k].dot(&self.carried[k].momentum) + dot(gravity, self.unit(k).linear)
        })
    }

    /// L_v.
    fn momentum(&self, v: &[S; N]) -> [S; N] {
        core::array::from_fn(|k| self.frames[k].share(&self.carried[k].momentum) + self.rotors[k] * v[k])
    }
}

impl<W: WeightFormat, S: Scalar<Weight = W::Wide>, const N: usize> Lagrangian<S, N>
    for SpatialBodies<'_, W, N>
{
    fn energies(&self, q: &[S; N], v: &[S; N]) -> Energies<S> {
        let motion = Motion::new(self, q, v);
        let potential = -dot(self.gravity(), motion.whole.inertia.moment);
        Energies { kinetic: linear::dot(&motion.momentum(v), v).half(), potential }
    }

    fn gradient(&self, q: &[S; N], v: &[S; N]) -> Gradient<S, N> {
        let motion = Motion::new(self, q, v);
        Gradient { l_q: motion.force(self.gravity()), l_v: motion.momentum(v) }
    }

    fn linearization(&self, q: &[S; N], v: &[S; N]) -> Linearization<S, N> {
        self.derivatives(q, v, None)
    }

    fn hessian(&self, q: &[S; N], v: &[S; N]) -> Hessian<S, N> {
        let mut l_qq = [[S::zero(); N]; N];
        let Linearization { l_q, l_v, l_vq, l_vv } = self.derivatives(q, v, Some(&mut l_qq));
        Hessian { l_q, l_v, l_qq, l_vq, l_vv }
    }
}
