use super::motion::{Carried, Frame};
use super::vector::{Vector, Wrench, across, dot};
use super::{BODY_PARAMETERS, BodyParameters, BodyTree, GRAVITY_PARAMETERS, Joint};
use crate::expected::{expected, present};
use crate::lagrangian::{Energies, Gradient, Hessian, Lagrangian};
use crate::linear;
use crate::scalar::{Scalar, WeightFormat};

/// A tree of N rigid bodies on joints in the plane, over borrowed weights.
///
/// # Method
///
/// With P = Σ mẋ and S = Σ m(x − r) over all that joint r carries, u the x axis of its frame, ⊥ a quarter turn ahead, and
/// W = ∂P/∂q̇ (⊥S of a revolute joint, mu of a prismatic one),
///
/// L_q = z·P + γ·W,  z = −⊥ṙ of a revolute joint, φ̇⊥u of a prismatic one,
///
/// and p is the angular momentum about r, or u·P, beside the rotor's. A column of M is what W and its angular part are at the
/// joints below; L_vq and L_qq come of ∂P/∂q in the same way. Time is O(n · depth), without a matrix of bodies by coordinates.
#[derive(Clone, Copy, Debug)]
pub struct PlanarBodies<'a, W, const N: usize> {
    /// Which body hangs from which, by what joint.
    pub tree: BodyTree<N>,
    /// γ, m/s².
    pub gravity: &'a [W; GRAVITY_PARAMETERS],
    /// The [`BodyParameters`] of every body, as they stand in the weight block.
    pub numbers: &'a [[W; BODY_PARAMETERS]; N],
}

impl<'a, W: WeightFormat, const N: usize> PlanarBodies<'a, W, N> {
    /// The tree over the front of `block`, of which the rest is left there: γ, then the numbers of every body. `None` where the
    /// block is too short.
    pub fn take(block: &mut &'a [W], tree: BodyTree<N>) -> Option<Self> {
        let (gravity, rest) = block.split_first_chunk()?;
        let (numbers, rest) = rest.split_at_checked(N * BODY_PARAMETERS)?;
        let numbers = numbers.as_chunks().0.try_into().ok()?;
        *block = rest;
        Some(Self { tree, gravity, numbers })
    }

    fn gravity<S: Scalar<Weight = W::Wide>>(&self) -> Vector<S> {
        self.gravity.map(W::scalar)
    }

    fn motion<S: Scalar<Weight = W::Wide>>(&self, q: &[S; N], v: &[S; N]) -> Motion<S, N> {
        let numbers = self.numbers.map(|numbers| BodyParameters::from_array(numbers.map(W::scalar)));
        Motion::new(&self.tree, numbers, q, v)
    }
}

/// The rotor of a joint's drive.
#[derive(Clone, Copy)]
struct Rotor<S> {
    /// J(φ̇_parent + gq̇), kg m²/s.
    momentum: S,
    /// Jg, what it adds to the inertia between the joint and those below.
    coupling: S,
    gear: S,
}

impl<S: Scalar> Rotor<S> {
    fn new(numbers: &BodyParameters<S>, parent_spin: S, v: S) -> Self {
        let BodyParameters { rotor, gear, .. } = *numbers;
        Self { momentum: rotor * (parent_spin + gear * v), coupling: rotor * gear, gear }
    }
}

/// A tree in motion.
struct Motion<S, const N: usize> {
    rotors: [Rotor<S>; N],
    frames: [Frame<S>; N],
    carried: [Carried<S>; N],
    /// All together, about the origin.
    whole: Carried<S>,
}

impl<S: Scalar, const N: usize> Motion<S, N> {
    #[inline(always)]
    fn new(tree: &BodyTree<N>, numbers: [BodyParameters<S>; N], q: &[S; N], v: &[S; N]) -> Self {
        let ground = Frame::ground();
        let mut frames = [ground; N];
        let mut rotors = [Rotor { momentum: S::zero(), coupling: S::zero(), gear: S::zero() }; N];
        for k in 0..N {
            let body = tree.bodies()[k];
            let on = |parent: u8| expected(frames.get(usize::from(parent)).copied(), ground);
            let parent = body.parent.map_or(ground, on);
            frames[k] = parent.carried(body.joint, &numbers[k], q[k], v[k]);
            rotors[k] = Rotor::new(&numbers[k], parent.spin, v[k]);
        }
        let (mut carried, mut whole) = ([Carried::nothing(); N], Carried::nothing());
        for k in (0..N).rev() {
            let own = carried[k].with_body(&frames[k], &numbers[k]);
            carried[k] = own;
            let below = tree.bodies()[k].parent.and_then(|parent| carried.get_mut(usize::from(parent)));
            let below = below.unwrap_or(&mut whole);
            *below = below.with_joint(&frames[k], &own, numbers[k].rotor, rotors[k].momentum);
        }
        Self { rotors, frames, carried, whole }
    }

    /// L_q.
    fn force(&self, gravity: Vector<S>) -> [S; N] {
        core::array::from_fn(|k| {
            let (frame, carried) = (&self.frames[k], &self.carried[k]);
            dot(frame.bend(), carried.momentum.linear) + dot(gravity, carried.unit_momentum(frame).linear)
        })
    }

    /// L_v.
    fn momentum(&self) -> [S; N] {
        core::array::from_fn(|k| {
            self.frames[k].share(&self.carried[k].momentum) + self.rotors[k].gear * self.rotors[k].momentum
        })
    }
}

/// What a joint's coordinate changes, as it stands at a joint below.
struct Column<S> {
    /// ∂/∂q̇ of momentum.
    unit: Wrench<S>,
    /// ∂/∂q of momentum.
    slope: Wrench<S>,
    /// ∂/∂q of the force of gravity on what turns about the joint below.
    pull: S,
}

impl<S: Scalar> Column<S> {
    /// Entries of L_vv, L_vq at (joint, column) and (column, joint), and of L_qq.
    #[inline(always)]
    fn at(&self, joint: &Frame<S>) -> [S; 4] {
        let bend = joint.bend();
        let pull = match joint.joint {
            Joint::Revolute => self.pull,
            Joint::Prismatic => S::zero(),
        };
        [
            joint.share(&self.unit),
            joint.share(&self.slope),
            dot(bend, self.unit.linear),
            dot(bend, self.slope.linear) + pull,
        ]
    }
}

impl<W: WeightFormat, S: Scalar<Weight = W::Wide>, const N: usize> Lagrangian<S, N>
    for PlanarBodies<'_, W, N>
{
    fn energies(&self, q: &[S; N], v: &[S; N]) -> Energies<S> {
        let motion = self.motion(q, v);
        let potential = -dot(self.gravity(), motion.whole.moment);
        Energies { kinetic: linear::dot(&motion.momentum(), v).half(), potential }
    }

    fn gradient(&self, q: &[S; N], v: &[S; N]) -> Gradient<S, N> {
        let motion = self.motion(q, v);
        Gradient { l_q: motion.force(self.gravity()), l_v: motion.momentum() }
    }

    fn hessian(&self, q: &[S; N], v: &[S; N]) -> Hessian<S, N> {
        let (motion, gravity) = (self.motion(q, v), self.gravity());
        let (mut l_qq, mut l_vq, mut l_vv) = ([[S::zero(); N]; N], [[S::zero(); N]; N], [[S::zero(); N]; N]);
        for k in 0..N {
            let (frame, carried) = (&motion.frames[k], &motion.carried[k]);
            let (unit, slope) = (carried.unit_momentum(frame), carried.momentum_slope(frame));
            let mut column = Column { unit, slope, pull: dot(gravity, across(unit.linear)) };
            [l_vv[k][k], l_vq[k][k], _, l_qq[k][k]] = column.at(frame);
            let rotor = &motion.rotors[k];
            l_vv[k][k] += rotor.gear * rotor.coupling;
            let (mut step, mut below) = (frame.step, self.tree.bodies()[k].parent);
            // The rotor sits on the body below.
            column.unit.angular += rotor.coupling;
            while let Some(j) = below.map(usize::from) {
                let Some(frame) = present(motion.frames.get(j)) else { break };
                column.unit = column.unit.about(step);
                column.slope = column.slope.about(step);
                [l_vv[j][k], l_vq[j][k], l_vq[k][j], l_qq[j][k]] = column.at(frame);
                (l_vv[k][j], l_qq[k][j]) = (l_vv[j][k], l_qq[j][k]);
                (step, below) = (frame.step, self.tree.bodies()[j].parent);
            }
        }
        Hessian { l_q: motion.force(gravity), l_v: motion.momentum(), l_qq, l_vq, l_vv }
    }
}
