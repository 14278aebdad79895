use crate::linear::{Matrix, add_scaled, dot, multiply};
use crate::scalar::Real;

/// A quadratic cost: diagonal weights per tick, and a matrix at the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost<R, const D: usize, const M: usize> {
    /// State x* from which deviations are counted.
    pub goal: [R; D],
    /// Flags of the states that are angles, whose deviations are taken the short way round.
    pub turns: [bool; D],
    /// Weights Q ≥ 0 of the state at every node's start, for each tick of the node.
    pub x: [R; D],
    /// Weights R > 0 of the control of every node, for each of its ticks.
    pub u: [R; M],
    /// Weights Q_K ≥ 0 of the state at the end, symmetric: such as the cost to go of a regulator
    /// ([`riccati::stationary`](super::riccati::stationary)).
    pub end: Matrix<R, D>,
}

impl<R: Real, const D: usize, const M: usize> Cost<R, D, M> {
    /// Deviation x − x*.
    pub fn deviation(&self, x: &[R; D]) -> [R; D] {
        core::array::from_fn(|i| {
            let deviation = x[i] - self.goal[i];
            if self.turns[i] { deviation.short_way() } else { deviation }
        })
    }

    /// The state that differs from x by whole turns and lies next to x*.
    pub(super) fn near(&self, x: &[R; D]) -> [R; D] {
        add_scaled(&self.goal, R::one(), &self.deviation(x))
    }

    /// ½(x − x*)ᵀQ(x − x*) + ½uᵀRu of a tick.
    pub(super) fn of_tick(&self, x: &[R; D], u: &[R; M]) -> R {
        weighted(&self.x, &self.deviation(x)) + weighted(&self.u, u)
    }

    /// ½(x − x*)ᵀQ_K(x − x*) of the end.
    pub(super) fn of_end(&self, x: &[R; D]) -> R {
        let deviation = self.deviation(x);
        dot(&deviation, &multiply(&self.end, &deviation)).half()
    }
}

/// ½ Σ w_i x_i².
fn weighted<R: Real, const N: usize>(weights: &[R; N], x: &[R; N]) -> R {
    weights.iter().zip(x).fold(R::zero(), |sum, (w, x)| sum + *w * *x * *x).half()
}
