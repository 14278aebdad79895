use crate::error::SetupError;
use nalgebra::{SMatrix, SVector};

/// Maximum number of doublings; each squares the closed loop, so 24 look 2²⁴ ticks ahead.
const MAX_DOUBLINGS: usize = 24;
/// Relative change below which the solution counts as converged, f32.
const TOLERANCE: f32 = 1e-5;

/// Linear system ẋ = Ax + bu, or x⁺ = Ax + bu after [`Linear::sampled`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear<const D: usize> {
    /// Matrix A.
    pub a: SMatrix<f32, D, D>,
    /// Vector b.
    pub b: SVector<f32, D>,
}

impl<const D: usize> Linear<D> {
    /// The discrete system over a tick of h seconds with u held.
    ///
    /// With Ψ = Σ (Ah)ᵏ/(k + 1)!, A⁺ = I + hAΨ and b⁺ = hΨb; eight terms suffice while ‖Ah‖ < 1.
    #[must_use]
    pub fn sampled(&self, h: f32) -> Self {
        let identity = SMatrix::<f32, D, D>::identity();
        let ah = self.a * h;
        let psi = (2_u8..=9).rev().fold(identity, |sum, k| identity + ah * sum / f32::from(k));
        Self { a: identity + ah * psi, b: psi * self.b * h }
    }
}

/// Computes the gain K, as a column, of the feedback u = −Kx that minimises Σ xᵀQx + ru² along x⁺ = Ax + bu:
/// K = bᵀPA/(r + bᵀPb) with the stabilising solution P of P = Q + AᵀP(I + bbᵀP/r)⁻¹A. If there is no such solution, an
/// error is returned.
///
/// Structure-preserving doubling: with G₀ = bbᵀ/r and P₀ = Q, W = (I + G P)⁻¹ gives A ← AWA, G ← G + AWGAᵀ,
/// P ← P + AᵀPWA, where A vanishes quadratically. Source: Chu, Fan, Lin and Wang, "Structure-preserving algorithms for
/// periodic discrete-time algebraic Riccati equations", Int. J. Control 77, 2004.
pub fn riccati<const D: usize>(
    system: &Linear<D>,
    q: &SMatrix<f32, D, D>,
    r: f32,
) -> Result<SVector<f32, D>, SetupError> {
    let identity = SMatrix::<f32, D, D>::identity();
    let (mut a, mut g, mut p) = (system.a, system.b * system.b.transpose() / r, *q);
    for _ in 0..MAX_DOUBLINGS {
        let w = (identity + g * p).try_inverse().ok_or(SetupError::NotStabilisable)?;
        let aw = a * w;
        let added = a.transpose() * p * w * a;
        g += aw * g * a.transpose();
        p += symmetric(&added);
        g = symmetric(&g);
        a = aw * a;
        let size = p.norm();
        if size.is_finite() && added.norm() <= TOLERANCE * size {
            return gain(system, &p, r);
        }
    }
    Err(SetupError::NotStabilisable)
}

/// Gain K = bᵀPA/(r + bᵀPb), as a column.
fn gain<const D: usize>(
    system: &Linear<D>,
    p: &SMatrix<f32, D, D>,
    r: f32,
) -> Result<SVector<f32, D>, SetupError> {
    let pb = p * system.b;
    let k = system.a.transpose() * pb / (r + system.b.dot(&pb));
    if k.iter().all(|k| k.is_finite()) { Ok(k) } else { Err(SetupError::NotStabilisable) }
}

/// ½(X + Xᵀ), so that rounding cannot build up an antisymmetric part.
fn symmetric<const D: usize>(x: &SMatrix<f32, D, D>) -> SMatrix<f32, D, D> {
    (x + x.transpose()) * 0.5
}
