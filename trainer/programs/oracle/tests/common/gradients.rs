//! Comparison of gradients with respect to the weights with core over dual numbers.

#[path = "../../../../../core/tests/common/dual_number.rs"]
mod dual_number;

use super::{Numbers, close};
use leastaction_core::forces::{self, Forces};
use leastaction_core::lagrangian::{Dynamics, Lagrangian};
use leastaction_core::linear::{add_scaled, dot, multiply};
use leastaction_core::scalar::Scalar;
use leastaction_programs::{System, WIDTH};
use num_dual::Dual64;

/// A number with its derivative with respect to one weight.
pub type Dual = dual_number::Dual<Dual64>;

/// The terms of the equation of motion M v̇ = L_q − L_vq v + Q at a state, and L_v.
pub struct Motion<S, const N: usize> {
    dynamics: Dynamics<S, N>,
    force: [S; N],
}

impl<S: Scalar, const N: usize> Motion<S, N> {
    /// Core's terms at q, v and τ.
    pub fn new<L: Lagrangian<S, N>, F: Forces<S, N>>(
        forces::System { lagrangian, forces }: &forces::System<L, F>,
        [q, v, tau]: [&[S; N]; 3],
    ) -> Self {
        Self { dynamics: lagrangian.dynamics(q, v), force: forces.force(q, v, tau) }
    }
}

impl<const N: usize> Motion<Dual, N> {
    /// The derivatives of all terms with respect to the weight.
    fn rates(&self) -> Motion<f64, N> {
        let rates = |x: &[Dual; N]| x.map(|x| x.0.eps);
        let Dynamics { mass, l_q, l_v, l_vq_v } = &self.dynamics;
        let dynamics = Dynamics {
            mass: mass.each_ref().map(rates),
            l_q: rates(l_q),
            l_v: rates(l_v),
            l_vq_v: rates(l_vq_v),
        };
        Motion { dynamics, force: rates(&self.force) }
    }
}

impl<const N: usize> Motion<f64, N> {
    /// (L_q + Q)·δq + L_v·δv.
    fn along(&self, dq: &[f64; N], dv: &[f64; N]) -> f64 {
        dot(&add_scaled(&self.dynamics.l_q, 1.0, &self.force), dq) + dot(&self.dynamics.l_v, dv)
    }

    /// y·(L_q − L_vq v − M a + Q).
    fn residual(&self, a: &[f64; N], y: &[f64; N]) -> f64 {
        let Dynamics { mass, l_q, l_vq_v, .. } = &self.dynamics;
        let rate = add_scaled(l_vq_v, 1.0, &multiply(mass, a));
        dot(&add_scaled(&add_scaled(l_q, 1.0, &self.force), -1.0, &rate), y)
    }
}

/// Checks both gradients of a system, at a few of the samples and for every weight.
pub fn check<const N: usize>(
    system: &System,
    motion: impl Fn(&[Dual], [&[Dual; N]; 3]) -> Motion<Dual, N>,
    numbers: &Numbers<N>,
    size: f64,
) {
    let vectors: Vec<usize> = (4..4 + 2 * N).collect();
    let (_, along) = numbers.run(&system.along(N), &[&[0, 1, 2], &vectors[..]].concat());
    let (_, residual) = numbers.run(&system.residual(N), &[&[0, 1, 2, 3], &vectors[..N]].concat());
    let mut weights: Vec<Dual> = numbers.weights.iter().map(|w| Dual::constant(*w)).collect();
    for sample in (0..WIDTH).step_by(5) {
        let at = [0, 1, 2].map(|vector| numbers.of(vector, sample).map(Dual::constant));
        let a = numbers.of(3, sample);
        for k in 0..weights.len() {
            weights[k].0.eps = 1.0;
            let rates = motion(&weights, at.each_ref()).rates();
            weights[k].0.eps = 0.0;
            for direction in 0..N {
                let [dq, dv] = [0, 1].map(|k| numbers.of(4 + 2 * direction + k, sample));
                let y = numbers.of(4 + direction, sample);
                close(along[direction][k].0[sample], rates.along(&dq, &dv), 100.0 * size);
                close(residual[direction][k].0[sample], rates.residual(&a, &y), 100.0 * size);
            }
        }
    }
}
