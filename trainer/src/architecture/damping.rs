//! Viscous damping that training can change.

use leastaction_core::energy::LearnableForces;
use leastaction_core::forces::{Forces, Viscous};
use leastaction_core::linear::Matrix;
use leastaction_core::scalar::Scalar;

/// Viscous damping of every coordinate, its coefficients in the weight block where a family has them there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Damping<S, const N: usize> {
    viscous: Viscous<S, N>,
    positions: Option<[usize; N]>,
}

impl<S, const N: usize> Damping<S, N> {
    /// Damping whose coefficients are at these places of the weight block; nowhere where there are not N.
    pub fn new(viscous: Viscous<S, N>, positions: &[usize]) -> Self {
        Self { viscous, positions: positions.try_into().ok() }
    }
}

impl<S: Scalar, const N: usize> Forces<S, N> for Damping<S, N> {
    fn force(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> [S; N] {
        self.viscous.force(q, v, tau)
    }

    fn derivatives(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> (Matrix<S, N>, Matrix<S, N>) {
        self.viscous.derivatives(q, v, tau)
    }

    fn load_derivative(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> Matrix<S, N> {
        self.viscous.load_derivative(q, v, tau)
    }
}

impl<S: Scalar, const N: usize> LearnableForces<S, N> for Damping<S, N> {
    fn force_gradient(&self, (_, v): (&[S; N], &[S; N]), y: &[S; N], mut row: impl FnMut(usize, S)) {
        for (i, position) in self.positions.iter().flatten().enumerate() {
            row(*position, -(y[i] * v[i]));
        }
    }
}
