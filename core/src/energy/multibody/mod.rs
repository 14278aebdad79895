//! Trees of rigid bodies on joints in any [`Space`]: one recursion from the base up for the frames and their motion, and one from the tips
//! down for the sums over all that every joint carries.

mod inertial;
mod space;
mod tree;

pub use space::{Carried, Frame, Rotor, Space, Wrench};
pub use tree::{BodyTree, Joint, TreeBody};

use crate::expected::{expected, present};
use crate::lagrangian::{Column, Energies, Gradient, Hessian, Lagrangian, Linearization, eliminated};
use crate::linear::{self, SolveError};
use crate::scalar::{Real, Scalar, WeightFormat};

/// A tree of N rigid bodies on joints, over borrowed weights: in `D` dimensions, with `B` numbers per body.
///
/// # Method
///
/// Let P be the momentum of all that a joint carries, about the joint, U = ∂P/∂q̇, S·P the component of P along the joint's coordinate, and
/// V the velocity of the joint's frame. Then
///
/// p = S·P plus the rotor's momentum, and L_q = z·P + γ·U, z = V × S.
///
/// For a joint k that j carries (or j itself), with U_k and D_k = ∂P_k/∂q_k taken about joint j, M_jk = S_j·U_k, ∂p_j/∂q_k = S_j·D_k,
/// ∂p_k/∂q_j = z_j·U_k and ∂²T/∂q_j∂q_k = z_j·D_k. Time is O(n · depth), and O(n) for everything but matrices.
#[derive(Clone, Copy, Debug)]
pub struct Bodies<'a, W, const D: usize, const B: usize, const N: usize> {
    /// Parent and joint of every body.
    pub tree: BodyTree<N>,
    /// Gravity γ in the axes of the base, m/s².
    pub gravity: &'a [W; D],
    /// The numbers of every body, as in the weight block.
    pub numbers: &'a [[W; B]; N],
}

impl<'a, W: WeightFormat, const D: usize, const B: usize, const N: usize> Bodies<'a, W, D, B, N> {
    /// Takes γ and the numbers of every body from the front of `block`, and leaves the rest there. `None` if the block is too short.
    pub fn take(block: &mut &'a [W], tree: BodyTree<N>) -> Option<Self> {
        let (gravity, rest) = block.split_first_chunk()?;
        let (numbers, rest) = rest.split_at_checked(N * B)?;
        let numbers = numbers.as_chunks().0.try_into().ok()?;
        *block = rest;
        Some(Self { tree, gravity, numbers })
    }

    pub(super) fn gravity<S: Scalar<Weight = W::Wide>>(&self) -> [S; D] {
        self.gravity.map(W::scalar)
    }

    #[inline(always)]
    pub(super) fn body<S: Scalar<Weight = W::Wide>>(&self, k: usize) -> BodyOf<'a, W, S, D, B>
    where
        [S; D]: Space<S, B>,
    {
        <[S; D] as Space<S, B>>::body(&self.numbers[k])
    }

    pub(super) fn parent(&self, k: usize) -> Option<usize> {
        self.tree.bodies()[k].parent.map(usize::from)
    }

    /// All derivatives except L_qq, which is written only on request.
    #[inline(always)]
    fn derivatives<S: Scalar<Weight = W::Wide>>(
        &self,
        q: &[S; N],
        v: &[S; N],
        mut l_qq: Option<&mut [[S; N]; N]>,
    ) -> Linearization<S, N>
    where
        [S; D]: Space<S, B>,
    {
        let gravity = self.gravity();
        let motion = Motion::new(self, q, v);
        let (mut l_q, mut l_vq, mut l_vv) = ([S::zero(); N], [[S::zero(); N]; N], [[S::zero(); N]; N]);
        for k in 0..N {
            let (frame, carried, bend) = (&motion.frames[k], &motion.carried[k], motion.bends[k]);
            let (mut unit, mut slope) = (motion.unit(k), carried.momentum_slope(frame, &bend));
            let pull = FrameOf::<S, D, B>::pull(&unit, gravity);
            l_q[k] = motion.force_at(k, (&unit, &bend), gravity);
            l_vv[k][k] = frame.share(&unit) + motion.rotors[k].inertia();
            l_vq[k][k] = frame.share(&slope);
            if let Some(l_qq) = &mut l_qq {
                l_qq[k][k] = FrameOf::<S, D, B>::bent(&bend, &slope) + frame.pulled(pull);
            }
            unit = motion.rotors[k].below(unit);
            // A loop, not a closure: if a closure is not inlined, the compiler cannot prove its indices valid.
            let (mut step, mut below) = (frame.step(), self.parent(k));
            while let Some(j) = below {
                let Some(frame) = present(motion.frames.get(j)) else { break };
                (unit, slope) = (unit.about(step), slope.about(step));
                let bend = &motion.bends[j];
                l_vv[j][k] = frame.share(&unit);
                l_vv[k][j] = l_vv[j][k];
                l_vq[j][k] = frame.share(&slope);
                l_vq[k][j] = FrameOf::<S, D, B>::bent(bend, &unit);
                if let Some(l_qq) = &mut l_qq {
                    l_qq[j][k] = FrameOf::<S, D, B>::bent(bend, &slope) + frame.pulled(pull);
                    l_qq[k][j] = l_qq[j][k];
                }
                (step, below) = (frame.step(), self.parent(j));
            }
        }
        Linearization { l_q, l_v: motion.momentum(v), l_vq, l_vv }
    }
}

/// Frame type of a space.
type FrameOf<S, const D: usize, const B: usize> = <[S; D] as Space<S, B>>::Frame;
/// Body type of a space.
type BodyOf<'a, W, S, const D: usize, const B: usize> = <FrameOf<S, D, B> as Frame<S>>::Body<'a, W>;

/// A tree in motion.
pub(super) struct Motion<S: Scalar, F: Frame<S>, const N: usize> {
    frames: [F; N],
    /// z of every joint; stored, since without a floating-point unit a second evaluation costs more than the memory.
    bends: [F::Bend; N],
    carried: [F::Carried; N],
    rotors: [F::Rotor; N],
    /// Sums over the whole tree, about the origin of the base.
    whole: F::Carried,
}

impl<S: Scalar, F: Frame<S>, const N: usize> Motion<S, F, N> {
    #[inline(always)]
    pub(super) fn new<W: WeightFormat<Wide = S::Weight>, const D: usize, const B: usize>(
        bodies: &Bodies<W, D, B, N>,
        q: &[S; N],
        v: &[S; N],
    ) -> Self
    where
        [S; D]: Space<S, B, Frame = F>,
    {
        let base = F::base();
        let mut motion = Self {
            frames: [base; N],
            bends: [base.bend(); N],
            carried: [F::Carried::nothing(); N],
            rotors: [F::Rotor::none(); N],
            whole: F::Carried::nothing(),
        };
        for k in 0..N {
            let body = bodies.body(k);
            let on = |parent: usize| expected(motion.frames.get(parent).copied(), base);
            let parent = bodies.parent(k).map_or(base, on);
            let frame = parent.carried(bodies.tree.bodies()[k].joint, &body, q[k], v[k]);
            motion.carried[k] = F::Carried::begun(&frame, &body);
            motion.rotors[k] = F::Rotor::new(&parent, &body, v[k]);
            (motion.frames[k], motion.bends[k]) = (frame, frame.bend());
        }
        for k in (0..N).rev() {
            let (frame, body) = (&motion.frames[k], bodies.body(k));
            let own = motion.carried[k].finished(frame, &body);
            motion.carried[k] = own;
            let below = bodies.parent(k).and_then(|parent| motion.carried.get_mut(parent));
            let below = below.unwrap_or(&mut motion.whole);
            *below = below.with_joint(frame, &own, &body, &motion.rotors[k]);
        }
        motion
    }

    /// Momentum of all that a joint carries, at a unit velocity of the joint.
    #[inline(always)]
    pub(super) fn unit(&self, k: usize) -> F::Wrench {
        self.carried[k].unit_momentum(&self.frames[k])
    }

    /// L_q.
    fn force(&self, gravity: F::Vector) -> [S; N] {
        core::array::from_fn(|k| self.force_at(k, (&self.unit(k), &self.bends[k]), gravity))
    }

    /// L_q of a joint; `unit` is the momentum at its unit velocity, `bend` its z.
    #[inline(always)]
    fn force_at(&self, k: usize, (unit, bend): (&F::Wrench, &F::Bend), gravity: F::Vector) -> S {
        F::bent(bend, self.carried[k].momentum()) + unit.along(gravity)
    }

    /// L_v.
    fn momentum(&self, v: &[S; N]) -> [S; N] {
        core::array::from_fn(|k| {
            self.frames[k].share(self.carried[k].momentum()) + self.rotors[k].momentum(v[k])
        })
    }
}

impl<W: WeightFormat, S: Scalar<Weight = W::Wide>, const D: usize, const B: usize, const N: usize>
    Lagrangian<S, N> for Bodies<'_, W, D, B, N>
where
    [S; D]: Space<S, B>,
{
    fn energies(&self, q: &[S; N], v: &[S; N]) -> Energies<S> {
        let motion = Motion::new(self, q, v);
        let potential = -motion.whole.moment(self.gravity());
        Energies { kinetic: linear::dot(&motion.momentum(v), v).half(), potential }
    }

    fn gradient(&self, q: &[S; N], v: &[S; N]) -> Gradient<S, N> {
        let motion = Motion::new(self, q, v);
        Gradient { l_q: motion.force(self.gravity()), l_v: motion.momentum(v) }
    }

    fn linearization(&self, q: &[S; N], v: &[S; N]) -> Linearization<S, N> {
        self.derivatives(q, v, None)
    }

    #[inline(always)]
    fn solves(&self) -> bool {
        <[S; D] as Space<S, B>>::SOLVES
    }

    #[inline(always)]
    fn forward_dynamics(&self, q: &[S; N], v: &[S; N], force: &[S; N]) -> Result<[S; N], SolveError>
    where
        S: Real,
    {
        let solved = <[S; D] as Space<S, B>>::forward_dynamics(self, q, v, force);
        solved.unwrap_or_else(|| eliminated(self.dynamics(q, v), force))
    }

    fn inertial_columns(&self, body: usize, q: &[S; N], v: &[S; N], columns: &mut [Column<S, N>]) -> usize {
        self.columns_of_body(body, (q, v), columns)
    }

    fn hessian(&self, q: &[S; N], v: &[S; N]) -> Hessian<S, N> {
        let mut l_qq = [[S::zero(); N]; N];
        let Linearization { l_q, l_v, l_vq, l_vv } = self.derivatives(q, v, Some(&mut l_qq));
        Hessian { l_q, l_v, l_qq, l_vq, l_vv }
    }
}
