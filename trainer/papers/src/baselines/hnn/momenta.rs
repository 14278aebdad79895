//! Momenta p = M(q) v of ModLaNet's systems, which a Hamiltonian network needs as inputs.

use leastaction_ground_truth::ManyBody;
use nalgebra::{DMatrix, DVector};

/// Relation of momenta and velocities: the true mass matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Momenta {
    /// Bodies of 1 kg: p = v.
    Bodies,
    /// A chain of points of 1 kg on rods of 1 m: M_ij = (n − max(i, j)) cos(q_i − q_j), i and j from 0.
    Chain,
}

impl Momenta {
    /// Returns the relation for a system.
    pub fn of(system: ManyBody) -> Self {
        match system {
            ManyBody::Pendulum(_) => Self::Chain,
            ManyBody::Bodies(_) => Self::Bodies,
        }
    }

    /// Mass matrix M(q).
    fn mass_matrix(self, q: &[f64]) -> DMatrix<f64> {
        match self {
            Self::Bodies => DMatrix::identity(q.len(), q.len()),
            Self::Chain => by_pairs(q, |i, j| (q[i] - q[j]).cos()),
        }
    }

    /// Momenta p.
    pub fn momenta(self, q: &[f64], v: &[f64]) -> Vec<f64> {
        (self.mass_matrix(q) * DVector::from_column_slice(v)).data.into()
    }

    /// Velocities v for momenta p; `None` if M is singular.
    pub fn velocities(self, q: &[f64], p: &[f64]) -> Option<Vec<f64>> {
        let v = self.mass_matrix(q).cholesky()?.solve(&DVector::from_column_slice(p));
        Some(v.data.into())
    }

    /// Inverse M⁻¹, row by row; `None` if M is singular.
    pub(super) fn mobility(self, q: &[f64]) -> Option<DMatrix<f64>> {
        Some(self.mass_matrix(q).cholesky()?.inverse())
    }

    /// Term Ṁv, the part of ṗ = M v̇ + Ṁv that no acceleration contains.
    pub(super) fn convection(self, q: &[f64], v: &[f64]) -> Vec<f64> {
        match self {
            Self::Bodies => vec![0.0; v.len()],
            Self::Chain => {
                let rate = by_pairs(q, |i, j| (v[j] - v[i]) * (q[i] - q[j]).sin());
                (rate * DVector::from_column_slice(v)).data.into()
            }
        }
    }
}

/// Matrix with the entries (n − max(i, j)) x_ij: the mass at or below both points times a factor for the pair.
fn by_pairs(q: &[f64], x: impl Fn(usize, usize) -> f64) -> DMatrix<f64> {
    DMatrix::from_fn(q.len(), q.len(), |i, j| (q.len() - i.max(j)) as f64 * x(i, j))
}

#[cfg(test)]
mod tests {
    use super::*;

    const Q: [f64; 6] = [0.3, -1.2, 2.0, 0.7, -0.4, 1.9];
    const V: [f64; 6] = [1.5, -0.6, 0.9, -2.0, 0.2, 1.1];

    #[test]
    fn they_give_the_exact_kinetic_energy_and_the_velocities_back() {
        for (system, n) in [(ManyBody::Pendulum(3), 3), (ManyBody::Bodies(3), 6)] {
            let (momenta, motion) = (Momenta::of(system), system.motion().unwrap());
            let (q, v) = (&Q[..n], &V[..n]);
            let p = momenta.momenta(q, v);
            let kinetic = 0.5 * p.iter().zip(v).map(|(p, v)| p * v).sum::<f64>();
            assert!((kinetic - motion.kinetic_energy(q, v)).abs() < 1e-12);
            let back = momenta.velocities(q, &p).unwrap();
            assert!(back.iter().zip(v).all(|(a, b)| (a - b).abs() < 1e-12), "{back:?}");
        }
    }

    #[test]
    fn their_rate_is_that_of_finite_differences_along_the_exact_motion() {
        for (system, n) in [(ManyBody::Pendulum(3), 3), (ManyBody::Bodies(3), 6)] {
            let (momenta, motion) = (Momenta::of(system), system.motion().unwrap());
            let (q, v, mut a) = (&Q[..n], &V[..n], vec![0.0; n]);
            motion.acceleration(q, v, &mut a).unwrap();
            let at = |t: f64| {
                let moved = |x: &[f64], rate: &[f64]| -> Vec<f64> {
                    x.iter().zip(rate).map(|(x, rate)| x + t * rate).collect()
                };
                momenta.momenta(&moved(q, v), &moved(v, &a))
            };
            let inertial = momenta.momenta(q, &a);
            let convection = momenta.convection(q, v);
            for (i, (ahead, behind)) in at(1e-6).iter().zip(at(-1e-6)).enumerate() {
                let rate = (ahead - behind) / 2e-6;
                assert!((rate - inertial[i] - convection[i]).abs() < 1e-8, "{i}: {rate}");
            }
        }
    }
}
