//! Holonomic constraints in a number of coordinates that is compiled in.

use leastaction_core::constraints::{Constraints, Positions};
use leastaction_core::linear::{dot, multiply};
use leastaction_core::model::Rod;

/// A holonomic constraint at a position.
#[derive(Clone, Copy, Debug)]
pub struct Constraint<const N: usize> {
    /// φ, m.
    pub value: f64,
    /// ∂φ/∂q, a row of A.
    pub gradient: [f64; N],
    /// ∂²φ/∂q², 1/m.
    pub hessian: [[f64; N]; N],
}

impl<const N: usize> Constraint<N> {
    /// (Ȧv) = vᵀ φ_qq v, m/s².
    pub fn curvature(&self, v: &[f64; N]) -> f64 {
        dot(v, &multiply(&self.hessian, v))
    }

    /// A rod's φ = (|d|² − ℓ²)/(2ℓ) as core has it: its gradient is ±d/ℓ at the two ends, and ∂²φ/∂q² ±1/ℓ.
    pub fn of_rod<const D: usize>(rod: &Rod, q: &[[f64; D]]) -> Self {
        let (rods, x) = ([rod.constraint::<f64, D>()], Positions::new(q));
        let value = rods.value(0, x);
        let (mut gradient, mut hessian) = ([0.0; N], [[0.0; N]; N]);
        let ends = [(Some(rod.to), 1.0 / f64::from(rod.length)), (rod.from, -1.0 / f64::from(rod.length))];
        let ends = || ends.iter().filter_map(|(node, share)| Some((usize::from((*node)?), share)));
        for (slot, (node, share)) in ends().enumerate() {
            let along = rods.gradient(0, slot, x);
            for i in 0..D {
                gradient[D * node + i] = along[i];
                for (other, sign) in ends() {
                    hessian[D * node + i][D * other + i] = share * sign.signum();
                }
            }
        }
        Self { value, gradient, hessian }
    }
}
