//! Columns of a body's inertial numbers, in which the Lagrangian is linear.

use super::{Bodies, Frame, FrameOf, Space};
use crate::expected::{expected, present};
use crate::lagrangian::Column;
use crate::linear::add_scaled;
use crate::scalar::{Scalar, WeightFormat};

impl<W: WeightFormat, const D: usize, const B: usize, const N: usize> Bodies<'_, W, D, B, N> {
    /// Writes the columns of a body and returns their number; a body that the tree does not have has none.
    ///
    /// With the twist S_j that a unit velocity of joint j gives the body's origin, z_j as a twist of that origin, and the body's own
    /// momentum h(π), p_j = S_j·h and L_q,j = z_j·h + γ·U(S_j), U the linear momentum at the twist. Only the joints that carry the body
    /// have a part in it.
    pub(super) fn columns_of_body<S: Scalar<Weight = W::Wide>>(
        &self,
        body: usize,
        (q, v): (&[S; N], &[S; N]),
        columns: &mut [Column<S, N>],
    ) -> usize
    where
        [S; D]: Space<S, B>,
    {
        let frames = self.frames(q, v);
        let Some(own) = frames.get(body) else { return 0 };
        columns.iter_mut().for_each(|column| *column = Column::zero());
        let gravity = self.gravity();
        let (mut below, mut to_body, mut count) = (Some(body), [S::zero(); D], 0);
        while let Some(j) = below {
            let Some(frame) = present(frames.get(j)) else { break };
            let twist = frame.unit_twist(to_body);
            let momentum = own.momentum_slopes(&twist);
            let bent = own.momentum_slopes(&<FrameOf<S, D, B>>::bend_twist(&frame.bend(), to_body));
            let pulled = own.gravity_slopes(&twist, gravity);
            let slopes = momentum.as_ref().iter().zip(bent.as_ref()).zip(pulled.as_ref());
            count = momentum.as_ref().len();
            for (column, ((momentum, bent), pulled)) in columns.iter_mut().zip(slopes) {
                if let (Some(p), Some(l_q)) = (column.momentum.get_mut(j), column.force.get_mut(j)) {
                    (*p, *l_q) = (*momentum, *bent + *pulled);
                }
            }
            to_body = add_scaled(&to_body, S::one(), &frame.step());
            below = self.parent(j);
        }
        count
    }

    /// Frames in motion, from the base up.
    #[inline(always)]
    fn frames<S: Scalar<Weight = W::Wide>>(&self, q: &[S; N], v: &[S; N]) -> [FrameOf<S, D, B>; N]
    where
        [S; D]: Space<S, B>,
    {
        let base = <FrameOf<S, D, B>>::base();
        let mut frames = [base; N];
        for k in 0..N {
            let on = |parent: usize| expected(frames.get(parent).copied(), base);
            let parent = self.parent(k).map_or(base, on);
            frames[k] = parent.carried(self.tree.bodies()[k].joint, &self.body(k), q[k], v[k]);
        }
        frames
    }
}
