//! L(q, v) = N(s(q), v) with all its derivatives, by tangents and adjoints of the network.

use crate::baselines::features::{adjoint, count, inputs, moving};
use leastaction_core::energy::Learnable;
use leastaction_core::lagrangian::{DenseMass, Dynamics, Energies, Gradient, Hessian, Lagrangian};
use leastaction_core::linear::dot;
use leastaction_core::model::ModelError;
use leastaction_core::network::{Activation, Bends, Jet, Mlp, Tape};
use leastaction_core::scalar::Scalar;
use std::array::from_fn;

/// Hidden layers, as Cranmer et al. have them.
pub(super) const DEPTH: usize = 2;

/// The Lagrangian of N coordinates over a weight block: one softplus network with hidden layers of at most H units.
#[derive(Clone, Copy, Debug)]
pub struct LnnLagrangian<'w, const N: usize, const H: usize> {
    coordinates: &'w str,
    network: Mlp<'w, f64, DEPTH>,
}

impl<'w, const N: usize, const H: usize> LnnLagrangian<'w, N, H> {
    /// Over the front of `weights`; `coordinates` has a letter each, `a` for angles.
    ///
    /// # Errors
    /// Where there are not N coordinates, hidden layers are wider than H, or the block is too short.
    pub fn new(coordinates: &'w str, width: usize, mut weights: &'w [f64]) -> Result<Self, ModelError> {
        let error = |what, found, compiled| Err(ModelError::Shape { what, found, compiled });
        if coordinates.len() != N {
            return error("coordinates", coordinates.len(), N);
        }
        if width > H {
            return error("units in a hidden layer", width, H);
        }
        let (found, inputs) = (weights.len(), count(coordinates));
        match Mlp::take(&mut weights, inputs, &[width; DEPTH], 1, Activation::Softplus) {
            Some(network) => Ok(Self { coordinates, network }),
            None => {
                error("weights", found, Mlp::<f64, 0>::parameters(inputs, &[width; DEPTH], 1).unwrap_or(0))
            }
        }
    }

    /// The network's inputs along directions (δq, δv).
    fn inputs<S: Scalar, const T: usize>(
        &self,
        [q, v]: [&[S; N]; 2],
        directions: [[[S; N]; T]; 2],
    ) -> Vec<Jet<S, T>> {
        let [dq, dv] = directions;
        let jet = |x: &[S; N], d: &[[S; N]; T], i: usize| Jet { value: x[i], tangent: from_fn(|k| d[k][i]) };
        let state: Vec<_> = (0..N).map(|i| jet(q, &dq, i)).chain((0..N).map(|i| jet(v, &dv, i))).collect();
        inputs(self.coordinates, &state)
    }

    /// L, and (L_q, L_v), with their tangents along the directions.
    fn differentiate<S: Scalar<Weight = f64>, const T: usize>(
        &self,
        x: &[Jet<S, T>],
    ) -> (S, [[Jet<S, T>; N]; 2]) {
        let (mut l, mut x_bar) = ([Jet::zero()], vec![Jet::zero(); x.len()]);
        let mut tape = Tape::<S, T, H, DEPTH>::default();
        self.network.forward(x, &mut tape, &mut l);
        self.network.adjoint(&tape, &[Jet::constant(S::one())], &mut x_bar);
        let bar = adjoint(self.coordinates, x, &x_bar);
        (l[0].value, [from_fn(|i| bar[i]), from_fn(|i| bar[N + i])])
    }

    /// L_vv: velocities are inputs as they are, so that only the network bends.
    fn mass_matrix<S: Scalar<Weight = f64>>(&self, q: &[S; N], v: &[S; N]) -> [[S; N]; N] {
        let x = self.inputs([q, v], [[[S::zero(); N]; N], unit_vectors()]);
        let (mut l, mut x_bar) = ([Jet::zero()], vec![Jet::zero(); x.len()]);
        let mut bends = Bends::<S, N, H, DEPTH>::default();
        self.network.forward_bent(&x, &mut bends, &mut l);
        self.network.second_order(&bends, &[Jet::constant(S::one())], &mut x_bar)
    }
}

/// The N unit vectors.
fn unit_vectors<S: Scalar, const N: usize>() -> [[S; N]; N] {
    from_fn(|i| from_fn(|j| if i == j { S::one() } else { S::zero() }))
}

impl<S: Scalar<Weight = f64>, const N: usize, const H: usize> Lagrangian<S, N> for LnnLagrangian<'_, N, H> {
    type Mass = DenseMass<S, N>;

    /// The energy is v·L_v − L; T is half of v·L_v, as it would be if L were quadratic in v, and V = T − L.
    fn energies(&self, q: &[S; N], v: &[S; N]) -> Energies<S> {
        let (l, [_, l_v]) = self.differentiate::<S, 0>(&self.inputs([q, v], [[]; 2]));
        let kinetic = dot(&l_v.map(|p| p.value), v).half();
        Energies { kinetic, potential: kinetic - l }
    }

    fn gradient(&self, q: &[S; N], v: &[S; N]) -> Gradient<S, N> {
        let (_, [l_q, l_v]) = self.differentiate::<S, 0>(&self.inputs([q, v], [[]; 2]));
        Gradient { l_q: l_q.map(|l| l.value), l_v: l_v.map(|p| p.value) }
    }

    /// One tangent along the motion with its adjoint, and one pass with N tangents for L_vv.
    fn dynamics(&self, q: &[S; N], v: &[S; N]) -> Dynamics<S, Self::Mass, N> {
        let (_, [l_q, l_v]) = self.differentiate(&self.inputs([q, v], [[*v], [[S::zero(); N]]]));
        Dynamics {
            mass: DenseMass(self.mass_matrix(q, v)),
            l_q: l_q.map(|l| l.value),
            l_v: l_v.map(|p| p.value),
            l_vq_v: l_v.map(|Jet { tangent: [along_v], .. }| along_v),
        }
    }

    fn hessian(&self, q: &[S; N], v: &[S; N]) -> Hessian<S, N> {
        let along_q = self.inputs([q, v], [unit_vectors(), [[S::zero(); N]; N]]);
        let (_, [l_q, l_v]) = self.differentiate(&along_q);
        Hessian {
            l_q: l_q.map(|l| l.value),
            l_v: l_v.map(|p| p.value),
            l_qq: l_q.map(|l| l.tangent),
            l_vq: l_v.map(|p| p.tangent),
            l_vv: self.mass_matrix(q, v),
        }
    }
}

impl<S: Scalar<Weight = f64>, const N: usize, const H: usize> Learnable<S, N> for LnnLagrangian<'_, N, H> {
    fn directional_gradient(
        &self,
        (q, v): (&[S; N], &[S; N]),
        (dq, dv): (&[S; N], &[S; N]),
        mut row: impl FnMut(usize, S),
    ) {
        let x = inputs(self.coordinates, &moving(&[*q, *v].concat(), &[*dq, *dv].concat()));
        let mut tape = Tape::<S, 1, H, DEPTH>::default();
        self.network.forward(&x, &mut tape, &mut [Jet::zero()]);
        let mut start = self.network.len();
        self.network.layer_adjoints(&tape, &x, &[Jet::<S, 1>::constant(S::one())], |layer, x, bar| {
            start -= layer.len();
            layer.tangent_gradient(x, bar, |i, value| row(start + i, value));
        });
    }

    /// With x the inputs, ẋ their rate along (v, a), e = (0, y) and f = (s′y, 0) it is N_x f − e N_xx ẋ, which is −¼ times the
    /// difference of two second derivatives of N: along curves with x′ = ẋ + e, x″ = −2f and x′ = ẋ − e, x″ = 2f.
    fn residual_gradient(
        &self,
        (q, v): (&[S; N], &[S; N]),
        a: &[S; N],
        y: &[S; N],
        mut row: impl FnMut(usize, S),
    ) {
        let straight = self.inputs([q, v], [[*v, *y], [*a, [S::zero(); N]]]);
        let features = straight.len() - N;
        for sign in [1.0, -1.0].map(S::constant) {
            let mut x = straight.clone();
            for (x, y) in x.iter_mut().skip(features).zip(y) {
                x.tangent[0] += sign * *y;
            }
            x.iter_mut().for_each(|x| x.tangent[1] = S::constant(-2.0) * sign * x.tangent[1]);
            let bar = [Jet { value: S::zero(), tangent: [S::zero(), S::constant(-0.25) * sign] }];
            let mut start = self.network.len();
            self.network.series_adjoints::<S, H>(&x, &bar, |layer, x, bar| {
                start -= layer.len();
                layer.series_gradient(x, bar, |i, value| row(start + i, value));
            });
        }
    }
}

#[cfg(test)]
#[path = "lagrangian_tests.rs"]
mod tests;
