use super::Forces;
use crate::linear::{Matrix, add_scaled, diagonal};
use crate::scalar::{Real, Scalar};

/// Position servos: the command is a position u, m or rad, and the force of the drive is k (u − q), k ≥ 0 in N/m or N m/rad.
///
/// The actuator's output τ is then u, so that Q = k (τ − q) − τ replaces it: τ + Q = k (u − q). Damping d of τ = k (u − q) − d v is
/// [`Viscous`](super::Viscous). A coordinate with k = 0 is not driven, and inverse dynamics finds no command for it. A law that grows with
/// the load has no meaning beside this one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Servo<S, const N: usize> {
    /// Stiffness k of every coordinate; `None`: the command is a force.
    pub stiffness: Option<[S; N]>,
}

impl<S: Scalar, const N: usize> Servo<S, N> {
    /// No servos: the command is a force.
    pub fn none() -> Self {
        Self { stiffness: None }
    }
}

impl<S: Scalar, const N: usize> Forces<S, N> for Servo<S, N> {
    #[inline(always)]
    fn force(&self, q: &[S; N], _: &[S; N], tau: &[S; N]) -> [S; N] {
        self.stiffness.map_or([S::zero(); N], |k| core::array::from_fn(|i| k[i] * (tau[i] - q[i]) - tau[i]))
    }

    fn derivatives(&self, _: &[S; N], _: &[S; N], _: &[S; N]) -> (Matrix<S, N>, Matrix<S, N>) {
        let by_position = self.stiffness.map_or([S::zero(); N], |k| k.map(|k| -k));
        (diagonal(by_position), [[S::zero(); N]; N])
    }

    fn load_derivative(&self, _: &[S; N], _: &[S; N], _: &[S; N]) -> Matrix<S, N> {
        diagonal(self.stiffness.map_or([S::zero(); N], |k| k.map(|k| k - S::one())))
    }

    /// The command u = q + total/k.
    fn control(&self, q: &[S; N], _: &[S; N], total: &[S; N]) -> [S; N]
    where
        S: Real,
    {
        let Some(k) = self.stiffness else { return *total };
        add_scaled(q, S::one(), &core::array::from_fn(|i| total[i] / k[i]))
    }
}
