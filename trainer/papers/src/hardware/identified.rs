//! The double pendulum with parameters that others identified: the baseline.

use super::parameters::Parameters;
use super::predictor::{Predict, Predictor};
use crate::control::DoublePendulum;
use crate::hardware::error::HardwareError;
use leastaction_programs::Row;
use std::path::Path;

/// A [`DoublePendulum`] whose numbers were identified from logs.
#[derive(Clone, Debug, PartialEq)]
pub struct Identified(DoublePendulum);

impl Identified {
    /// Reads a file of lines `name: number`: I1, I2 about the joints and Ir of the rotors (kg m²), m1, m2 (kg), l1, r1,
    /// r2 (m), g (m/s²), the gear ratio gr, b1, b2 (N m s/rad), cf1, cf2 (N m).
    ///
    /// # Errors
    /// [`HardwareError::Io`], [`HardwareError::Line`], [`HardwareError::Parameters`].
    pub fn read(file: &Path) -> Result<Self, HardwareError> {
        let all = Parameters::read(file)?;
        let names = ["I1", "I2", "Ir", "m1", "m2", "l1", "r1", "r2", "g", "gr", "b1", "b2", "cf1", "cf2"];
        let [i1, i2, rotor, m1, m2, l1, r1, r2, gravity, gear, b1, b2, cf1, cf2] = all.get(names)?;
        let pendulum = DoublePendulum {
            mass: [m1, m2],
            // The end of link 2 does not matter to its motion.
            length: [l1, r2],
            centre: [r1, r2],
            inertia: [i1, i2],
            rotor,
            gear,
            damping: [b1, b2],
            coulomb: [cf1, cf2],
            gravity,
        };
        if is_definite(&pendulum) {
            return Ok(Self(pendulum));
        }
        let what = "these are not the inertias of two links: the kinetic energy is not positive".to_owned();
        Err(HardwareError::unusable(file, &what))
    }
}

/// Whether M is positive definite everywhere. Its determinant is concave as a function of the cosine, so both ends
/// suffice.
fn is_definite(pendulum: &DoublePendulum) -> bool {
    [-1.0, 1.0].into_iter().all(|cosine| {
        let [m11, m12, m22] = pendulum.mass_matrix(cosine);
        m11 > 0.0 && m11 * m22 > m12 * m12
    })
}

impl Predictor for Identified {
    fn motion(&self) -> Box<Predict<'_>> {
        Box::new(|[q, v, tau], a| {
            let (mut first, mut second) = (Row::default(), Row::default());
            for (lane, (first, second)) in first.0.iter_mut().zip(&mut second.0).enumerate() {
                let of = |rows: &[Row]| [rows[0].0[lane], rows[1].0[lane]];
                let ([q1, q2], [v1, v2]) = (of(q), of(v));
                [*first, *second] = self.0.acceleration([q1, q2, v1, v2], of(tau));
            }
            a.copy_from_slice(&[first, second]);
        })
    }
}
