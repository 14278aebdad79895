//! Exact mechanisms whose inertia and potential are sums of cosines of the coordinates: M_ij = Σ c cos(k·q), V = Σ c cos(k·q). They serve
//! as references for tests, ground truth for data, and plants for the firmware loop.

use crate::lagrangian::{Energies, Gradient, Hessian, Lagrangian};
use crate::linear::{dot, multiply};
use crate::scalar::{Real, Scalar};

/// A term c cos(k·q) of V, or of an entry of M and its mirror entry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave<const N: usize> {
    /// Amplitude c.
    pub amplitude: f64,
    /// Wave vector k; if it is zero, the term is constant.
    pub wave: [f64; N],
}

/// A mechanism given by its waves.
#[derive(Clone, Copy, Debug)]
pub struct Trigonometric<'a, const N: usize> {
    /// Terms of M: (row, column ≤ row, wave). Terms outside the N × N matrix are left out.
    pub inertia: &'a [(usize, usize, Wave<N>)],
    /// Terms of V.
    pub potential: &'a [Wave<N>],
}

const G: f64 = 9.81;

/// A rod on a pivot, θ = 0 upright: θ̈ = 1.5 g sin θ + 3u (m = l = 1). SyMo's pendulum.
pub const PENDULUM: Trigonometric<'static, 1> = Trigonometric {
    inertia: &[(0, 0, Wave { amplitude: 1.0 / 3.0, wave: [0.0] })],
    potential: &[Wave { amplitude: G / 2.0, wave: [0.0] }, Wave { amplitude: G / 2.0, wave: [1.0] }],
};

/// A cart (1 kg) carrying a pole (0.1 kg, half-length 0.5 m), q = (x, θ), θ = 0 upright. SyMo's cart-pole.
pub const CARTPOLE: Trigonometric<'static, 2> = Trigonometric {
    inertia: &[
        (0, 0, Wave { amplitude: 1.1, wave: [0.0, 0.0] }),
        (1, 0, Wave { amplitude: 0.05, wave: [0.0, 1.0] }),
        (1, 1, Wave { amplitude: 0.1 / 3.0, wave: [0.0, 0.0] }),
    ],
    potential: &[Wave { amplitude: 0.05 * G, wave: [0.0, 1.0] }],
};

/// Two links (m = l = 1, centre at ½, inertia 1 about it), q = (a, b), b relative, hanging at 0. SyMo's acrobot.
pub const ACROBOT: Trigonometric<'static, 2> = Trigonometric {
    inertia: &[
        (0, 0, Wave { amplitude: 3.5, wave: [0.0, 0.0] }),
        (0, 0, Wave { amplitude: 1.0, wave: [0.0, 1.0] }),
        (1, 0, Wave { amplitude: 1.25, wave: [0.0, 0.0] }),
        (1, 0, Wave { amplitude: 0.5, wave: [0.0, 1.0] }),
        (1, 1, Wave { amplitude: 1.25, wave: [0.0, 0.0] }),
    ],
    potential: &[
        Wave { amplitude: -1.5 * G, wave: [1.0, 0.0] },
        Wave { amplitude: -0.5 * G, wave: [1.0, 1.0] },
    ],
};

/// c cos(k·q) with the factors of its derivatives: ∂ = −c sin(k·q) k, ∂∂ = −c cos(k·q) kkᵀ.
struct Evaluated<S, const N: usize> {
    value: S,
    slope: S,
    wave: [S; N],
}

impl<const N: usize> Wave<N> {
    fn at<S: Scalar>(&self, q: &[S; N]) -> Evaluated<S, N> {
        let wave = self.wave.map(S::constant);
        let amplitude = S::constant(self.amplitude);
        let (sin, cos) = dot(&wave, q).sin_cos();
        Evaluated { value: amplitude * cos, slope: -(amplitude * sin), wave }
    }
}

/// Adds c kkᵀ to a matrix.
fn add_outer<S: Scalar, const N: usize>(matrix: &mut [[S; N]; N], c: S, k: &[S; N]) {
    for (row, ki) in matrix.iter_mut().zip(k) {
        for (entry, kj) in row.iter_mut().zip(k) {
            *entry += c * *ki * *kj;
        }
    }
}

/// Adds cb to a.
fn add<S: Scalar, const N: usize>(a: &mut [S; N], c: S, b: &[S; N]) {
    for (a, b) in a.iter_mut().zip(b) {
        *a += c * *b;
    }
}

impl<const N: usize> Trigonometric<'_, N> {
    /// M(q), symmetric.
    pub fn mass_matrix<S: Scalar>(&self, q: &[S; N]) -> [[S; N]; N] {
        let mut mass = [[S::zero(); N]; N];
        for (i, j, wave) in self.entries() {
            let value = wave.at(q).value;
            mass[i][j] += value;
            if i != j {
                mass[j][i] += value;
            }
        }
        mass
    }

    /// The terms of M that lie inside the matrix.
    fn entries(&self) -> impl Iterator<Item = (usize, usize, &Wave<N>)> {
        self.inertia.iter().map(|(i, j, wave)| (*i, *j, wave)).filter(|(i, j, _)| *i < N && *j < N)
    }

    /// The total energy T + V, J.
    pub fn energy<R: Real>(&self, q: &[R; N], v: &[R; N]) -> R {
        let energies = self.energies(q, v);
        energies.kinetic + energies.potential
    }
}

/// ½ v_i v_j for an entry on the diagonal, v_i v_j for an entry below it, which stands for itself and its mirror
/// entry.
fn kinetic_weight<S: Scalar, const N: usize>(v: &[S; N], i: usize, j: usize) -> S {
    let product = v[i] * v[j];
    if i == j { product.half() } else { product }
}

impl<S: Scalar, const N: usize> Lagrangian<S, N> for Trigonometric<'_, N> {
    fn energies(&self, q: &[S; N], v: &[S; N]) -> Energies<S> {
        let kinetic = dot(&multiply(&self.mass_matrix(q), v), v).half();
        let potential = self.potential.iter().fold(S::zero(), |sum, wave| sum + wave.at(q).value);
        Energies { kinetic, potential }
    }

    fn gradient(&self, q: &[S; N], v: &[S; N]) -> Gradient<S, N> {
        let Hessian { l_q, l_v, .. } = self.hessian(q, v);
        Gradient { l_q, l_v }
    }

    fn hessian(&self, q: &[S; N], v: &[S; N]) -> Hessian<S, N> {
        let zero = [[S::zero(); N]; N];
        let l_vv = self.mass_matrix(q);
        let (mut l_q, mut l_qq, mut l_vq) = ([S::zero(); N], zero, zero);
        for wave in self.potential {
            let w = wave.at(q);
            add(&mut l_q, -w.slope, &w.wave);
            add_outer(&mut l_qq, w.value, &w.wave);
        }
        for (i, j, wave) in self.entries() {
            let (w, weight) = (wave.at(q), kinetic_weight(v, i, j));
            add(&mut l_q, w.slope * weight, &w.wave);
            add_outer(&mut l_qq, -(w.value * weight), &w.wave);
            add(&mut l_vq[i], w.slope * v[j], &w.wave);
            if i != j {
                add(&mut l_vq[j], w.slope * v[i], &w.wave);
            }
        }
        Hessian { l_q, l_v: multiply(&l_vv, v), l_qq, l_vq, l_vv }
    }
}
