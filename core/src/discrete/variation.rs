//! First variations of the action at a Gauss point, and their derivatives.

use super::GaussPoint;
use crate::lagrangian::Linearization;
use crate::linear::Matrix;
use crate::scalar::Real;

/// Weights of F and L_v in a first variation at a Gauss point: Σ b (force · F + momentum · L_v).
#[derive(Clone, Copy, Debug)]
pub struct Variation<R> {
    /// Weight of F = L_q + Q + u.
    pub force: R,
    /// Weight of L_v.
    pub momentum: R,
}

impl<R: Real> Variation<R> {
    /// D₁, variation of the start position.
    #[inline(always)]
    pub fn start(point: &GaussPoint<R>, h: R) -> Self {
        Self { force: h * (R::one() - point.c), momentum: -R::one() }
    }

    /// Variation of the start position alone, the increment being held: of a column, not of a row.
    #[inline(always)]
    pub(super) fn shift() -> Self {
        Self { force: R::one(), momentum: R::zero() }
    }

    /// D₁ + D₂, the gain of momentum.
    #[inline(always)]
    pub(super) fn impulse(h: R) -> Self {
        Self { force: h, momentum: R::zero() }
    }

    /// D₂, variation of the end position; also the derivative of position and velocity at the point with
    /// respect to w.
    #[inline(always)]
    pub fn end(point: &GaussPoint<R>, h: R) -> Self {
        Self { force: h * point.c, momentum: R::one() }
    }

    /// D_m, variation of the bubble; also the derivative of position and velocity at the point with respect to
    /// s.
    #[inline(always)]
    pub fn bubble(point: &GaussPoint<R>, h: R) -> Self {
        Self { force: h * point.bubble(), momentum: point.bubble_rate() }
    }
}

/// Derivatives of F and L_v at a Gauss point, from the derivatives of L and of the forces.
pub(super) struct PointDerivatives<'a, R, const N: usize> {
    pub l: &'a Linearization<R, N>,
    pub l_qq: Option<&'a Matrix<R, N>>,
    /// ∂Q/∂q and ∂Q/∂v.
    pub forces: (Matrix<R, N>, Matrix<R, N>),
}

impl<R: Real, const N: usize> PointDerivatives<'_, R, N> {
    /// Entry i of (∂F, ∂L_v) if coordinate j of the point moves by `column`: its position by the `force` part, its velocity by the
    /// `momentum` part.
    #[inline(always)]
    fn entry(&self, (i, j): (usize, usize), column: Variation<R>) -> (R, R) {
        let (q_q, q_v) = (self.forces.0[i][j], self.forces.1[i][j]);
        let force_q = self.l_qq.map_or(q_q, |l_qq| l_qq[i][j] + q_q);
        let force_v = self.l.l_vq[j][i] + q_v;
        let mix = |q: R, v: R| q * column.force + v * column.momentum;
        (mix(force_q, force_v), mix(self.l.l_vq[i][j], self.l.l_vv[i][j]))
    }

    /// Adds b(row.force · ∂F + row.momentum · ∂L_v) to the block of every row, for a motion of the point by `column`.
    #[inline(always)]
    pub fn add<const C: usize>(
        &self,
        weight: R,
        column: Variation<R>,
        rows: [(Variation<R>, &mut Matrix<R, N>); C],
    ) {
        let mut rows = rows.map(|(row, block)| (weight * row.force, weight * row.momentum, block));
        for i in 0..N {
            for j in 0..N {
                let (force, l_v) = self.entry((i, j), column);
                for (of_force, of_momentum, block) in &mut rows {
                    block[i][j] = (block[i][j] + *of_force * force) + *of_momentum * l_v;
                }
            }
        }
    }
}
