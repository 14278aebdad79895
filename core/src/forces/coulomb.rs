use super::{Coefficient, Forces, smaller};
use crate::linear::{Matrix, SolveError, diagonal, solve_many};
use crate::scalar::{Real, Scalar};

/// Dry friction of every coordinate, with a smooth sign and growing with the load: Q_i = −(c_i + c_load,i (√(τ_i² + τ_s,i²) − τ_s,i))
/// tanh(v_i/ε_i), N or N m.
///
/// It only dissipates, v·Q ≤ 0, and does not stick: below ε a coordinate creeps under a constant force. True stiction is the set-valued law
/// [`Sticking`](super::Sticking).
///
/// A step of order 2 evaluates the friction at the mean velocity. Near v = 0 it therefore turns v into v(1 − a)/(1 +
/// a), with a = h c (M⁻¹)_ii/(2ε): for a > 1 the velocity (not the increment) changes its sign at every step, and the
/// larger a is, the more slowly it decays. [`Coulomb::stiffness`] computes a; keep it at most 1 (3 at order 4) by a
/// shorter step or a larger width. Energy is lost for any a: see [`crate::discrete`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coulomb<S, const N: usize> {
    /// The friction of each coordinate.
    pub coordinates: [DryFriction<S>; N],
}

/// Dry friction of one coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DryFriction<S> {
    /// Friction c ≥ 0 at no load, N or N m.
    pub constant: S,
    /// Growth of friction with the load, 0 ≤ c_load < 1.
    pub load: S,
    /// Load τ_s > 0 below which friction hardly grows, N or N m.
    pub smoothing: S,
    /// Width ε > 0 of the change of sign, m/s or rad/s.
    pub width: S,
}

impl<S: Scalar> DryFriction<S> {
    /// No friction.
    pub fn none() -> Self {
        Self { constant: S::zero(), load: S::zero(), smoothing: S::one(), width: S::one() }
    }

    /// tanh(v/ε).
    #[inline(always)]
    fn direction(&self, v: S) -> S {
        (v / self.width).tanh()
    }

    /// √(τ² + τ_s²), at least τ_s even if the squares underflow.
    #[inline(always)]
    fn smooth_load(&self, tau: S) -> S {
        (tau * tau + self.smoothing * self.smoothing).sqrt().max(self.smoothing)
    }

    /// c + c_load (√(τ² + τ_s²) − τ_s). The difference is τ²/(√… + τ_s): it does not cancel, and is never negative.
    #[inline(always)]
    pub(super) fn level(&self, tau: S) -> S {
        self.constant + self.load * (tau * tau / (self.smooth_load(tau) + self.smoothing))
    }

    #[inline(always)]
    fn force(&self, v: S, tau: S) -> S {
        -(self.level(tau) * self.direction(v))
    }

    /// ∂Q/∂v = −level (1 − tanh²)/ε.
    #[inline(always)]
    fn velocity_derivative(&self, v: S, tau: S) -> S {
        self.slope(self.direction(v), tau)
    }

    /// ∂Q/∂v where tanh(v/ε) = t.
    #[inline(always)]
    pub(super) fn slope(&self, t: S, tau: S) -> S {
        -(self.level(tau) * (S::one() - t) * (S::one() + t) / self.width)
    }

    /// ∂Q/∂τ = −c_load τ/√(τ² + τ_s²) tanh(v/ε), above −1 and below 1.
    fn load_derivative(&self, v: S, tau: S) -> S {
        -(self.load * tau / self.smooth_load(tau) * self.direction(v))
    }
}

impl<R: Real> DryFriction<R> {
    /// Solves τ + Q(v, τ) = `total` for τ.
    ///
    /// With k = c_load tanh(v/ε), ρ = total + c tanh(v/ε) and σ = ρ − kτ_s, the equation is τ = σ + k√(τ² + τ_s²), squared
    /// (1 − k²)τ² − 2στ + σ² − k²τ_s² = 0. Its roots are (σ ± kr)/(1 − k²) with r = √(σ² + (1 − k²)τ_s²); the root with + is the solution.
    /// If kσ < 0, the solution is computed as ρ(ρ − 2kτ_s)/(σ − kr), the product of both roots divided by the other
    /// root, so nothing cancels.
    fn control(&self, v: R, total: R) -> R {
        let direction = self.direction(v);
        let (k, rho, s) = (self.load * direction, total + self.constant * direction, self.smoothing);
        let (sigma, rest) = (rho - k * s, (R::one() - k) * (R::one() + k));
        let root = (sigma * sigma + rest * s * s).sqrt();
        if k * sigma < R::zero() {
            rho * (rho - (k + k) * s) / (sigma - k * root)
        } else {
            (sigma + k * root) / rest
        }
    }

    /// Cuts a change of velocity short at 0. tanh(v/ε) is convex on one side of 0 and concave on the other: Newton's method converges from
    /// 0 itself, but may jump back and forth between the flat parts on both sides. A change of sign from beyond half the width therefore
    /// ends at 0.
    pub(super) fn trusted_part(&self, v: R, dv: R) -> R {
        let acts = self.constant + self.load > R::zero();
        let turns = (v > R::zero()) != (v + dv > R::zero());
        if acts && turns && v.abs() > self.width.half() { v.abs() / dv.abs() } else { R::one() }
    }
}

impl<S: Scalar, const N: usize> Coulomb<S, N> {
    /// No friction.
    pub fn none() -> Self {
        Self { coordinates: [DryFriction::none(); N] }
    }
}

impl<R: Real, const N: usize> Coulomb<R, N> {
    /// a_i = h c_i (M⁻¹)_ii/(2ε_i) at the load τ, with c_i increased by the load: the stiffness of friction for steps
    /// of h seconds.
    ///
    /// # Errors
    /// [`SolveError`] if M is singular or a number is not finite.
    pub fn stiffness(&self, h: R, mass: Matrix<R, N>, tau: &[R; N]) -> Result<[R; N], SolveError> {
        let inverse = solve_many(mass, diagonal([R::one(); N]))?;
        Ok(core::array::from_fn(|i| {
            let friction = &self.coordinates[i];
            (h * friction.level(tau[i]) * inverse[i][i] / friction.width).half()
        }))
    }
}

impl<S: Scalar, const N: usize> Forces<S, N> for Coulomb<S, N> {
    #[inline(always)]
    fn force(&self, _: &[S; N], v: &[S; N], tau: &[S; N]) -> [S; N] {
        let mut force = [S::zero(); N];
        for (i, friction) in self.coordinates.iter().enumerate() {
            force[i] = friction.force(v[i], tau[i]);
        }
        force
    }

    /// Has a loop without closures and is inlined, like `force`, so that a step computes tanh once for both functions.
    #[inline(always)]
    fn derivatives(&self, _: &[S; N], v: &[S; N], tau: &[S; N]) -> (Matrix<S, N>, Matrix<S, N>) {
        let (zero, mut slopes) = ([[S::zero(); N]; N], [[S::zero(); N]; N]);
        for (i, friction) in self.coordinates.iter().enumerate() {
            slopes[i][i] = friction.velocity_derivative(v[i], tau[i]);
        }
        (zero, slopes)
    }

    fn slopes(&self, coefficient: Coefficient, v: &[S; N]) -> [S; N] {
        match coefficient {
            Coefficient::Coulomb => core::array::from_fn(|i| -self.coordinates[i].direction(v[i])),
            _ => [S::zero(); N],
        }
    }

    fn load_derivative(&self, _: &[S; N], v: &[S; N], tau: &[S; N]) -> Matrix<S, N> {
        diagonal(core::array::from_fn(|i| self.coordinates[i].load_derivative(v[i], tau[i])))
    }

    fn control(&self, _: &[S; N], v: &[S; N], total: &[S; N]) -> [S; N]
    where
        S: Real,
    {
        core::array::from_fn(|i| self.coordinates[i].control(v[i], total[i]))
    }

    fn trusted_part(&self, v: &[S; N], dv: &[S; N]) -> S
    where
        S: Real,
    {
        let parts = self.coordinates.iter().zip(v).zip(dv);
        parts.map(|((friction, v), dv)| friction.trusted_part(*v, *dv)).fold(S::one(), smaller)
    }
}
