use super::{Coefficient, Forces};
use crate::linear::{Matrix, diagonal};
use crate::scalar::Scalar;

/// Linear viscous damping in every coordinate, Q_i = −c_i v_i, c_i ≥ 0 in N s/m or N m s/rad. All zero: no damping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viscous<S, const N: usize> {
    /// Coefficients c.
    pub coefficients: [S; N],
}

impl<S: Scalar, const N: usize> Viscous<S, N> {
    /// No damping.
    pub fn none() -> Self {
        Self { coefficients: [S::zero(); N] }
    }
}

impl<S: Scalar, const N: usize> Forces<S, N> for Viscous<S, N> {
    fn force(&self, _: &[S; N], v: &[S; N], _: &[S; N]) -> [S; N] {
        core::array::from_fn(|i| -(self.coefficients[i] * v[i]))
    }

    fn derivatives(&self, _: &[S; N], _: &[S; N], _: &[S; N]) -> (Matrix<S, N>, Matrix<S, N>) {
        ([[S::zero(); N]; N], diagonal(self.coefficients.map(|c| -c)))
    }

    fn slopes(&self, coefficient: Coefficient, v: &[S; N]) -> [S; N] {
        match coefficient {
            Coefficient::Viscous => v.map(|v| -v),
            _ => [S::zero(); N],
        }
    }

    fn load_derivative(&self, _: &[S; N], _: &[S; N], _: &[S; N]) -> Matrix<S, N> {
        [[S::zero(); N]; N]
    }
}
