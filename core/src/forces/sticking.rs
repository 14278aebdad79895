use super::{Coefficient, Coulomb, DryFriction, Forces};
use crate::linear::Matrix;
use crate::scalar::{Real, Scalar};

/// Dry friction of every coordinate that sticks at rest and may differ by direction: a set-valued law.
///
/// Q_i = −c⁺ if v_i > 0, Q_i = c⁻ if v_i < 0, and at rest whatever keeps v_i = 0, as long as it lies between −s c⁺ and s c⁻. The levels are
/// c⁺ = c (1 + δ) + g and c⁻ = c (1 − δ) + g, with the growth under load g = c_load (√(τ_i² + τ_s²) − τ_s) of [`DryFriction`]. A breakaway
/// ratio s > 1 takes more force to start a motion than to keep it up.
///
/// Steps of [`Del`](crate::discrete::Del) solve this law ([`Forces::grips`]); all that needs derivatives, such as gradients of losses,
/// linearisations and inverse dynamics, uses a smooth law of the same levels, −(c (1 + δt) + g) t with t = tanh(v_i/ε).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sticking<S, const N: usize> {
    /// The friction of each coordinate.
    pub coordinates: [StickingFriction<S>; N],
}

/// Friction of one coordinate that sticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StickingFriction<S> {
    /// Friction c ≥ 0 at no load, the mean of both directions, N or N m.
    pub constant: S,
    /// Asymmetry δ, −1 ≤ δ ≤ 1.
    pub asymmetry: S,
    /// Growth of friction with the load, 0 ≤ c_load < 1.
    pub load: S,
    /// Load τ_s > 0 below which friction hardly grows, N or N m.
    pub smoothing: S,
    /// Breakaway ratio s ≥ 1.
    pub breakaway: S,
    /// Width ε > 0 of the smooth law, m/s or rad/s.
    pub width: S,
}

/// Levels, N or N m, of the dry friction of a coordinate that can stick; all are at least 0. Both levels 0: it slides freely.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grip<S> {
    /// Friction against motion with v > 0.
    pub forward: S,
    /// Friction against motion with v < 0.
    pub backward: S,
    /// Friction at rest over that in motion, at least 1.
    pub breakaway: S,
}

impl<S: Scalar> Grip<S> {
    /// No friction.
    pub fn none() -> Self {
        Self { forward: S::zero(), backward: S::zero(), breakaway: S::one() }
    }

    /// The largest impulses over a time, s, in N s or N m s.
    #[must_use]
    #[inline(always)]
    pub(crate) fn over(self, time: S) -> Self {
        Self { forward: time * self.forward, backward: time * self.backward, breakaway: self.breakaway }
    }

    /// Both frictions of a coordinate together; the larger breakaway ratio.
    #[must_use]
    #[inline(always)]
    pub fn plus(self, other: Self) -> Self {
        let (forward, backward) = (self.forward + other.forward, self.backward + other.backward);
        Self { forward, backward, breakaway: self.breakaway.max(other.breakaway) }
    }
}

impl<S: Scalar> StickingFriction<S> {
    /// No friction.
    pub fn none() -> Self {
        let (zero, one) = (S::zero(), S::one());
        Self { constant: zero, asymmetry: zero, load: zero, smoothing: one, breakaway: one, width: one }
    }

    #[inline(always)]
    fn direction(&self, v: S) -> S {
        (v / self.width).tanh()
    }

    /// Friction of one level in place of c.
    #[inline(always)]
    fn with_constant(&self, constant: S) -> DryFriction<S> {
        DryFriction { constant, load: self.load, smoothing: self.smoothing, width: self.width }
    }

    /// The smooth law at velocity v: c (1 + δt) in place of c.
    #[inline(always)]
    fn smooth(&self, v: S) -> DryFriction<S> {
        self.smooth_towards(self.direction(v))
    }

    /// The smooth law where tanh(v/ε) = t.
    #[inline(always)]
    fn smooth_towards(&self, t: S) -> DryFriction<S> {
        self.with_constant(self.constant * (S::one() + self.asymmetry * t))
    }

    /// ∂Q/∂c of the smooth law.
    fn slope(&self, v: S) -> S {
        let t = self.direction(v);
        -((S::one() + self.asymmetry * t) * t)
    }

    /// ∂Q/∂v of the smooth law; c (1 + δt) varies with v too, by cδ (1 − t²)/ε.
    fn velocity_derivative(&self, v: S, tau: S) -> S {
        let t = self.direction(v);
        let slope = (S::one() - t) * (S::one() + t) / self.width;
        self.smooth_towards(t).slope(t, tau) - self.constant * self.asymmetry * slope * t
    }

    /// Levels at the load τ.
    #[inline(always)]
    fn grip(&self, tau: S) -> Grip<S> {
        let level = |share| self.with_constant(self.constant * share).level(tau);
        let (forward, backward) = (level(S::one() + self.asymmetry), level(S::one() - self.asymmetry));
        Grip { forward, backward, breakaway: self.breakaway }
    }
}

impl<S: Scalar, const N: usize> Sticking<S, N> {
    /// No friction.
    pub fn none() -> Self {
        Self { coordinates: [StickingFriction::none(); N] }
    }

    fn smooth(&self, v: &[S; N]) -> Coulomb<S, N> {
        Coulomb { coordinates: core::array::from_fn(|i| self.coordinates[i].smooth(v[i])) }
    }
}

impl<S: Scalar, const N: usize> Forces<S, N> for Sticking<S, N> {
    fn force(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> [S; N] {
        self.smooth(v).force(q, v, tau)
    }

    fn derivatives(&self, _: &[S; N], v: &[S; N], tau: &[S; N]) -> (Matrix<S, N>, Matrix<S, N>) {
        let (zero, mut slopes) = ([[S::zero(); N]; N], [[S::zero(); N]; N]);
        for (i, friction) in self.coordinates.iter().enumerate() {
            slopes[i][i] = friction.velocity_derivative(v[i], tau[i]);
        }
        (zero, slopes)
    }

    fn slopes(&self, coefficient: Coefficient, v: &[S; N]) -> [S; N] {
        match coefficient {
            Coefficient::Sticking => core::array::from_fn(|i| self.coordinates[i].slope(v[i])),
            _ => [S::zero(); N],
        }
    }

    fn load_derivative(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> Matrix<S, N> {
        self.smooth(v).load_derivative(q, v, tau)
    }

    fn control(&self, q: &[S; N], v: &[S; N], total: &[S; N]) -> [S; N]
    where
        S: Real,
    {
        self.smooth(v).control(q, v, total)
    }

    #[inline(always)]
    fn sticks(&self) -> bool
    where
        S: Real,
    {
        self.coordinates.iter().any(|of| of.constant + of.load > S::zero())
    }

    #[inline(always)]
    fn single_valued(&self, _: &[S; N], _: &[S; N], _: &[S; N]) -> [S; N] {
        [S::zero(); N]
    }

    #[inline(always)]
    fn single_valued_derivatives(&self, _: &[S; N], _: &[S; N], _: &[S; N]) -> (Matrix<S, N>, Matrix<S, N>) {
        ([[S::zero(); N]; N], [[S::zero(); N]; N])
    }

    #[inline(always)]
    fn grips(&self, tau: &[S; N]) -> [Grip<S>; N] {
        core::array::from_fn(|i| self.coordinates[i].grip(tau[i]))
    }
}
