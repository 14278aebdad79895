//! Laws of force that depend on positions, velocities and the load, and an actuator.

use leastaction_core::forces::{
    Actuator, Coulomb, Directional, DirectionalFriction, DryFriction, Forces, Sticking, StickingFriction,
    Viscous,
};
use leastaction_core::linear::Matrix;
use leastaction_core::scalar::Scalar;

/// Friction that grows with the load and changes with the neighbour's position:
/// Q_i = −c_i (√(τ_i² + s²) − s) tanh(v_i/ε) (1 + k sin q_j), j the next coordinate.
#[derive(Clone, Copy, Debug)]
pub struct LoadFriction<const N: usize> {
    pub c: [f64; N],
}

const SMOOTHING: f64 = 0.3;
const WIDTH: f64 = 0.6;
const RIPPLE: f64 = 0.4;

impl<const N: usize> LoadFriction<N> {
    /// Different coefficients for all coordinates.
    pub fn some() -> Self {
        Self { c: core::array::from_fn(|i| 0.2 + 0.15 * i as f64) }
    }

    /// c_i, √(τ_i² + s²), tanh(v_i/ε), and the factor of q_j with its derivative.
    fn terms<S: Scalar>(&self, i: usize, q: &[S; N], v: &[S; N], tau: &[S; N]) -> [S; 5] {
        let (sin, cos) = q[(i + 1) % N].sin_cos();
        let (s, k) = (S::constant(SMOOTHING), S::constant(RIPPLE));
        let root = (tau[i] * tau[i] + s * s).sqrt();
        [S::constant(self.c[i]), root, (v[i] / S::constant(WIDTH)).tanh(), S::one() + k * sin, k * cos]
    }
}

impl<S: Scalar, const N: usize> Forces<S, N> for LoadFriction<N> {
    fn force(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> [S; N] {
        core::array::from_fn(|i| {
            let [c, root, direction, ripple, _] = self.terms(i, q, v, tau);
            -(c * (root - S::constant(SMOOTHING)) * direction * ripple)
        })
    }

    fn derivatives(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> (Matrix<S, N>, Matrix<S, N>) {
        let (mut in_q, mut in_v) = ([[S::zero(); N]; N], [[S::zero(); N]; N]);
        for i in 0..N {
            let [c, root, direction, ripple, ripple_rate] = self.terms(i, q, v, tau);
            let load = c * (root - S::constant(SMOOTHING));
            in_q[i][(i + 1) % N] -= load * direction * ripple_rate;
            in_v[i][i] -= load * (S::one() - direction * direction) / S::constant(WIDTH) * ripple;
        }
        (in_q, in_v)
    }

    fn load_derivative(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> Matrix<S, N> {
        let mut in_tau = [[S::zero(); N]; N];
        for i in 0..N {
            let [c, root, direction, ripple, _] = self.terms(i, q, v, tau);
            in_tau[i][i] = -(c * tau[i] / root * direction * ripple);
        }
        in_tau
    }
}

/// A coupling that is no friction: Q_i = a q_i v_j² sin τ_j, j the next coordinate.
#[derive(Clone, Copy, Debug)]
pub struct Coupling(pub f64);

impl<S: Scalar, const N: usize> Forces<S, N> for Coupling {
    fn force(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> [S; N] {
        core::array::from_fn(|i| {
            let j = (i + 1) % N;
            S::constant(self.0) * q[i] * v[j] * v[j] * tau[j].sin_cos().0
        })
    }

    fn derivatives(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> (Matrix<S, N>, Matrix<S, N>) {
        let (mut in_q, mut in_v) = ([[S::zero(); N]; N], [[S::zero(); N]; N]);
        for i in 0..N {
            let j = (i + 1) % N;
            let factor = S::constant(self.0) * tau[j].sin_cos().0;
            in_q[i][i] += factor * v[j] * v[j];
            in_v[i][j] += factor * q[i] * (v[j] + v[j]);
        }
        (in_q, in_v)
    }

    fn load_derivative(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> Matrix<S, N> {
        let mut in_tau = [[S::zero(); N]; N];
        for i in 0..N {
            let j = (i + 1) % N;
            in_tau[i][j] += S::constant(self.0) * q[i] * v[j] * v[j] * tau[j].sin_cos().1;
        }
        in_tau
    }
}

pub type All<S, const N: usize> = (Viscous<S, N>, (LoadFriction<N>, Coupling));

/// Damping, friction and a coupling together.
pub fn all<S: Scalar, const N: usize>() -> All<S, N> {
    let coefficients = core::array::from_fn(|i| S::constant(0.1 + 0.25 * i as f64));
    (Viscous { coefficients }, (LoadFriction::some(), Coupling(0.03)))
}

pub type Dry<S, const N: usize> = (Viscous<S, N>, Coulomb<S, N>);

/// A number that differs from coordinate to coordinate.
fn number<S: Scalar>(start: f64, i: usize, step: f64) -> S {
    S::constant(start + step * i as f64)
}

/// Dry friction of up to eight coordinates, all numbers different.
pub fn coulomb<S: Scalar, const N: usize>() -> Coulomb<S, N> {
    Coulomb {
        coordinates: core::array::from_fn(|i| DryFriction {
            constant: number(0.3, i, 0.17),
            load: number(0.25, i, 0.09),
            smoothing: number(0.6, i, -0.06),
            width: number(0.45, i, 0.11),
        }),
    }
}

/// Friction by direction, all numbers different.
pub fn directional<S: Scalar, const N: usize>() -> Directional<S, N> {
    Directional {
        coordinates: core::array::from_fn(|i| DirectionalFriction {
            viscous: number(0.4, i, 0.13),
            viscous_asymmetry: number(0.7, i, -0.35),
            constant: number(0.2, i, 0.19),
            asymmetry: number(-0.5, i, 0.21),
            width: number(0.35, i, 0.12),
        }),
    }
}

/// Friction that sticks, all numbers different.
pub fn sticking<S: Scalar, const N: usize>() -> Sticking<S, N> {
    Sticking {
        coordinates: core::array::from_fn(|i| StickingFriction {
            constant: number(0.3, i, 0.17),
            asymmetry: number(0.55, i, -0.34),
            load: number(0.25, i, 0.09),
            smoothing: number(0.6, i, -0.06),
            breakaway: number(1.1, i, 0.05),
            width: number(0.45, i, 0.11),
        }),
    }
}

/// Viscous damping and dry friction.
pub fn dry<S: Scalar, const N: usize>() -> Dry<S, N> {
    (all().0, coulomb())
}

/// An actuator that scales, shifts and reverses, with its delay in steps.
pub fn actuator(delay: f64) -> Actuator<f64, 2> {
    Actuator { gain: [1.5, -0.4], offset: [0.3, -0.7], delay }
}
