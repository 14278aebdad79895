//! Places of a force, a momentum and their derivatives among the outputs of a program.

/// Numbers of the outputs of a program for L_q + Q and L_v with their derivatives: vectors of n rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DerivativeOutputs {
    pub(crate) n: usize,
}

impl DerivativeOutputs {
    /// Force F = L_q + Q.
    pub const FORCE: usize = 0;
    /// Momentum p = L_v.
    pub const MOMENTUM: usize = 1;

    /// Derivative ∂F/∂q_j, all rows.
    pub const fn force_q(self, j: usize) -> usize {
        2 + j
    }

    /// Derivative ∂L_v/∂q_j, all rows.
    pub const fn momentum_q(self, j: usize) -> usize {
        2 + self.n + j
    }

    /// Derivative ∂F/∂v_j, all rows.
    pub const fn force_v(self, j: usize) -> usize {
        2 + 2 * self.n + j
    }

    /// Column j of M = L_vv.
    pub const fn mass(self, j: usize) -> usize {
        2 + 3 * self.n + j
    }
}
