use super::{Coefficient, Forces, Grip, Stop, smaller};
use crate::adapt::Number;
use crate::lagrangian::Column;
use crate::linear::{Matrix, add_scaled, add_scaled_matrix};
use crate::scalar::{Real, Scalar};

/// Two laws that act together.
impl<S: Scalar, A: Forces<S, N>, B: Forces<S, N>, const N: usize> Forces<S, N> for (A, B) {
    #[inline(always)]
    fn force(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> [S; N] {
        let (a, b) = self;
        add_scaled(&a.force(q, v, tau), S::one(), &b.force(q, v, tau))
    }

    fn derivatives(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> (Matrix<S, N>, Matrix<S, N>) {
        let ((a_q, a_v), (b_q, b_v)) = (self.0.derivatives(q, v, tau), self.1.derivatives(q, v, tau));
        (add_scaled_matrix(&a_q, S::one(), &b_q), add_scaled_matrix(&a_v, S::one(), &b_v))
    }

    fn load_derivative(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> Matrix<S, N> {
        let (a, b) = self;
        add_scaled_matrix(&a.load_derivative(q, v, tau), S::one(), &b.load_derivative(q, v, tau))
    }

    #[inline(always)]
    fn sticks(&self) -> bool
    where
        S: Real,
    {
        self.0.sticks() || self.1.sticks()
    }

    #[inline(always)]
    fn single_valued(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> [S; N] {
        let (a, b) = self;
        add_scaled(&a.single_valued(q, v, tau), S::one(), &b.single_valued(q, v, tau))
    }

    fn single_valued_derivatives(
        &self,
        q: &[S; N],
        v: &[S; N],
        tau: &[S; N],
    ) -> (Matrix<S, N>, Matrix<S, N>) {
        let (a_q, a_v) = self.0.single_valued_derivatives(q, v, tau);
        let (b_q, b_v) = self.1.single_valued_derivatives(q, v, tau);
        (add_scaled_matrix(&a_q, S::one(), &b_q), add_scaled_matrix(&a_v, S::one(), &b_v))
    }

    #[inline(always)]
    fn grips(&self, tau: &[S; N]) -> [Grip<S>; N] {
        let (a, b) = (self.0.grips(tau), self.1.grips(tau));
        core::array::from_fn(|i| a[i].plus(b[i]))
    }

    #[inline(always)]
    fn stops(&self) -> [Stop<S>; N] {
        let (a, b) = (self.0.stops(), self.1.stops());
        core::array::from_fn(|i| a[i].both(b[i]))
    }

    #[inline(always)]
    fn slopes(&self, coefficient: Coefficient, v: &[S; N]) -> [S; N] {
        let (a, b) = self;
        add_scaled(&a.slopes(coefficient, v), S::one(), &b.slopes(coefficient, v))
    }

    #[inline(always)]
    fn network_columns(&self, q: &[S; N], v: &[S; N], numbers: &[Number], columns: &mut [Column<S, N>]) {
        self.0.network_columns(q, v, numbers, columns);
        self.1.network_columns(q, v, numbers, columns);
    }

    #[inline(always)]
    fn potential(&self, q: &[S; N]) -> S {
        self.0.potential(q) + self.1.potential(q)
    }

    /// Solves for each law in turn with the other's force subtracted: exact if at most one of the two depends on τ.
    fn control(&self, q: &[S; N], v: &[S; N], total: &[S; N]) -> [S; N]
    where
        S: Real,
    {
        let (a, b) = self;
        let without = |force: [S; N]| add_scaled(total, -S::one(), &force);
        let tau = a.control(q, v, &without(b.force(q, v, &[S::zero(); N])));
        b.control(q, v, &without(a.force(q, v, &tau)))
    }

    #[inline(always)]
    fn trusted_part(&self, v: &[S; N], dv: &[S; N]) -> S
    where
        S: Real,
    {
        smaller(self.0.trusted_part(v, dv), self.1.trusted_part(v, dv))
    }
}
