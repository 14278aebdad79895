//! The double pendulum with parameters that others identified: the baseline.

use super::parameters::Parameters;
use super::predictor::{Predict, Predictor};
use crate::hardware::error::HardwareError;
use leastaction_programs::Row;
use std::path::Path;

/// Rigid links with geared rotors and friction.
///
/// M₁₁ = I₁ + I₂ + m₂l₁² + 2m₂l₁r₂ cos q₂ + g_r²I_r + I_r, M₁₂ = I₂ + m₂l₁r₂ cos q₂ − g_r I_r, M₂₂ = I₂ + g_r²I_r; friction
/// −b v − c_f arctan(100 v) at each joint, v in rad/s.
///
/// Source: Wiebe et al., "Open Source Dual-Purpose Acrobot and Pendubot Platform", IEEE Robotics & Automation Magazine 2023.
#[derive(Clone, Debug, PartialEq)]
pub struct Identified {
    /// M₁₁ and its part proportional to cos q₂, M₁₂, M₂₂, kg m².
    inertia: [f64; 4],
    /// Coefficients of sin q₁ and sin(q₁ + q₂), N m.
    gravity: [f64; 2],
    /// Viscous friction b, N m s/rad.
    viscous: [f64; 2],
    /// Dry friction c_f, N m.
    dry: [f64; 2],
}

/// Steepness of the change of sign of dry friction, s/rad.
const STEEPNESS: f64 = 100.0;

impl Identified {
    /// Reads a file of lines `name: number`: I1, I2 about the joints and Ir of the rotors (kg m²), m1, m2 (kg), l1, r1,
    /// r2 (m), g (m/s²), the gear ratio gr, b1, b2 (N m s/rad), cf1, cf2 (N m).
    ///
    /// # Errors
    /// [`HardwareError::Io`], [`HardwareError::Line`], [`HardwareError::Parameters`].
    pub fn read(file: &Path) -> Result<Self, HardwareError> {
        let all = Parameters::read(file)?;
        let names = ["I1", "I2", "Ir", "m1", "m2", "l1", "r1", "r2", "g", "gr", "b1", "b2", "cf1", "cf2"];
        let [i1, i2, ir, m1, m2, l1, r1, r2, g, gr, b1, b2, cf1, cf2] = all.get(names)?;
        let (coupling, rotor) = (m2 * l1 * r2, gr * gr * ir);
        let identified = Self {
            inertia: [i1 + i2 + m2 * l1 * l1 + rotor + ir, coupling, i2 - gr * ir, i2 + rotor],
            gravity: [g * (m1 * r1 + m2 * l1), g * m2 * r2],
            viscous: [b1, b2],
            dry: [cf1, cf2],
        };
        if identified.is_definite() {
            return Ok(identified);
        }
        let what = "these are not the inertias of two links: the kinetic energy is not positive".to_owned();
        Err(HardwareError::unusable(file, &what))
    }

    /// M for this cosine of q₂.
    fn mass(&self, cosine: f64) -> [f64; 3] {
        let [m11, coupling, m12, m22] = self.inertia;
        [m11 + 2.0 * coupling * cosine, m12 + coupling * cosine, m22]
    }

    /// Whether M is positive definite everywhere. Its determinant is concave as a function of the cosine, so both ends
    /// suffice.
    fn is_definite(&self) -> bool {
        [-1.0, 1.0].into_iter().all(|cosine| {
            let [m11, m12, m22] = self.mass(cosine);
            m11 > 0.0 && m11 * m22 > m12 * m12
        })
    }

    /// Acceleration v̇.
    fn acceleration(&self, [q1, q2]: [f64; 2], v: [f64; 2], tau: [f64; 2]) -> [f64; 2] {
        let (sine, cosine) = q2.sin_cos();
        let centrifugal = self.inertia[1] * sine;
        let both = self.gravity[1] * (q1 + q2).sin();
        let inner = [
            centrifugal * v[1] * (2.0 * v[0] + v[1]) - self.gravity[0] * q1.sin() - both,
            -centrifugal * v[0] * v[0] - both,
        ];
        let friction = |i: usize| self.viscous[i] * v[i] + self.dry[i] * (STEEPNESS * v[i]).atan();
        let [f1, f2] = [0, 1].map(|i| tau[i] + inner[i] - friction(i));
        let [m11, m12, m22] = self.mass(cosine);
        let determinant = m11 * m22 - m12 * m12;
        [(m22 * f1 - m12 * f2) / determinant, (m11 * f2 - m12 * f1) / determinant]
    }
}

impl Predictor for Identified {
    fn motion(&self) -> Box<Predict<'_>> {
        Box::new(|[q, v, tau], a| {
            let (mut first, mut second) = (Row::default(), Row::default());
            for (lane, (first, second)) in first.0.iter_mut().zip(&mut second.0).enumerate() {
                let of = |rows: &[Row]| [rows[0].0[lane], rows[1].0[lane]];
                [*first, *second] = self.acceleration(of(q), of(v), of(tau));
            }
            a.copy_from_slice(&[first, second]);
        })
    }
}
