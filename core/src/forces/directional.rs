use super::{Coefficient, DryFriction, Forces};
use crate::linear::{Matrix, diagonal};
use crate::scalar::{Real, Scalar};

/// Friction of every coordinate that differs by direction, with a smooth sign: Q_i = −(b (1 + βt) v_i + c (1 + δt) t), N or N m, with
/// t = tanh(v_i/ε).
///
/// For v ≫ ε the damping is b⁺ = b (1 + β) and the dry friction c⁺ = c (1 + δ); for v ≪ −ε they are b⁻ = b (1 − β) and c⁻ = c (1 − δ). It
/// only dissipates, and does not stick; see [`Coulomb`](super::Coulomb) on steps near rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Directional<S, const N: usize> {
    /// The friction of each coordinate.
    pub coordinates: [DirectionalFriction<S>; N],
}

/// Friction of one coordinate that differs by direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionalFriction<S> {
    /// Damping b ≥ 0, the mean of both directions, N s/m or N m s/rad.
    pub viscous: S,
    /// Asymmetry β of the damping, −1 ≤ β ≤ 1.
    pub viscous_asymmetry: S,
    /// Dry friction c ≥ 0, the mean of both directions, N or N m.
    pub constant: S,
    /// Asymmetry δ of the dry friction, −1 ≤ δ ≤ 1.
    pub asymmetry: S,
    /// Width ε > 0 of the change of direction, m/s or rad/s.
    pub width: S,
}

impl<S: Scalar> DirectionalFriction<S> {
    /// No friction.
    pub fn none() -> Self {
        let [viscous, viscous_asymmetry, constant, asymmetry] = [S::zero(); 4];
        Self { viscous, viscous_asymmetry, constant, asymmetry, width: S::one() }
    }

    fn direction(&self, v: S) -> S {
        (v / self.width).tanh()
    }

    fn force(&self, v: S) -> S {
        let (one, t) = (S::one(), self.direction(v));
        let viscous = self.viscous * (one + self.viscous_asymmetry * t);
        -(viscous * v + self.constant * (one + self.asymmetry * t) * t)
    }

    /// ∂Q/∂b or ∂Q/∂c.
    fn slope(&self, coefficient: Coefficient, v: S) -> S {
        let (one, t) = (S::one(), self.direction(v));
        match coefficient {
            Coefficient::DirectionalViscous => -((one + self.viscous_asymmetry * t) * v),
            Coefficient::Directional => -((one + self.asymmetry * t) * t),
            _ => S::zero(),
        }
    }

    /// ∂Q/∂v = −(b (1 + βt) + (bβv + c (1 + 2δt)) (1 − t²)/ε).
    fn velocity_derivative(&self, v: S) -> S {
        let (one, t) = (S::one(), self.direction(v));
        let slope = (one - t) * (one + t) / self.width;
        let (b, beta, c, delta) = (self.viscous, self.viscous_asymmetry, self.constant, self.asymmetry);
        -(b * (one + beta * t) + (b * beta * v + c * (one + (delta + delta) * t)) * slope)
    }
}

impl<R: Real> DirectionalFriction<R> {
    /// The part of a change of velocity up to 0, as for [`DryFriction`].
    fn trusted_part(&self, v: R, dv: R) -> R {
        DryFriction { constant: self.constant, width: self.width, ..DryFriction::none() }.trusted_part(v, dv)
    }
}

impl<S: Scalar, const N: usize> Directional<S, N> {
    /// No friction.
    pub fn none() -> Self {
        Self { coordinates: [DirectionalFriction::none(); N] }
    }
}

impl<S: Scalar, const N: usize> Forces<S, N> for Directional<S, N> {
    fn force(&self, _: &[S; N], v: &[S; N], _: &[S; N]) -> [S; N] {
        core::array::from_fn(|i| self.coordinates[i].force(v[i]))
    }

    fn derivatives(&self, _: &[S; N], v: &[S; N], _: &[S; N]) -> (Matrix<S, N>, Matrix<S, N>) {
        let slopes = core::array::from_fn(|i| self.coordinates[i].velocity_derivative(v[i]));
        ([[S::zero(); N]; N], diagonal(slopes))
    }

    fn slopes(&self, coefficient: Coefficient, v: &[S; N]) -> [S; N] {
        let slope = |i: usize| self.coordinates[i].slope(coefficient, v[i]);
        core::array::from_fn(slope)
    }

    fn load_derivative(&self, _: &[S; N], _: &[S; N], _: &[S; N]) -> Matrix<S, N> {
        [[S::zero(); N]; N]
    }

    fn trusted_part(&self, v: &[S; N], dv: &[S; N]) -> S
    where
        S: Real,
    {
        let parts = self.coordinates.iter().zip(v).zip(dv);
        parts.map(|((friction, v), dv)| friction.trusted_part(*v, *dv)).fold(S::one(), super::smaller)
    }
}
