//! Lagrangians that are one number given by networks, whatever the networks, with all that is trained and followed.

use super::features::moving;
use leastaction::architecture::HostScalar;
use leastaction::dual::Dual;
use leastaction_core::constraints::{Constraints, Holonomic, Positions};
use leastaction_core::energy::Learnable;
use leastaction_core::lagrangian::{Dynamics, Energies, Gradient, Hessian, Lagrangian};
use leastaction_core::linear::dot;
use leastaction_core::network::Jet;
use leastaction_core::scalar::Scalar;
use nalgebra::{DMatrix, DVector};
use std::array::from_fn;

/// L(x), x = (q, v), by networks over a weight block.
pub(super) trait ScalarNetwork: Sync {
    /// L, and L_x with its tangents along those of x.
    fn differentiate<S: Scalar<Weight = f64>, const T: usize>(&self, x: &[Jet<S, T>]) -> (S, Vec<Jet<S, T>>);

    /// The second derivatives of L along every pair of directions of x, none of which moves a position.
    fn bend<S: Scalar<Weight = f64>, const T: usize>(&self, x: &[Jet<S, T>]) -> [[S; T]; T];

    /// Visits ∂/∂θ of L's tangent as `row(position, value)`, a weight as often as it is used.
    fn slope_gradient<S: Scalar<Weight = f64>>(&self, x: &[Jet<S, 1>], row: impl FnMut(usize, S));
}

/// The Lagrangian that a network gives.
///
/// Its energy is v·L_v − L; T is half of v·L_v, as it would be if L were quadratic in v, and V = T − L.
#[derive(Clone, Copy, Debug)]
pub struct NetworkLagrangian<L>(pub(super) L);

impl<L: ScalarNetwork> NetworkLagrangian<L> {
    /// L, and (L_q, L_v) with their tangents along directions (δq, δv).
    fn differentiate<S: Scalar<Weight = f64>, const T: usize, const N: usize>(
        &self,
        [q, v]: [&[S; N]; 2],
        [dq, dv]: [[[S; N]; T]; 2],
    ) -> (S, [[Jet<S, T>; N]; 2]) {
        let (l, slope) = self.0.differentiate(&[jets(q, &dq), jets(v, &dv)].concat());
        (l, [from_fn(|i| slope[i]), from_fn(|i| slope[N + i])])
    }

    /// L_vv.
    fn mass_matrix<S: Scalar<Weight = f64>, const N: usize>(&self, [q, v]: [&[S; N]; 2]) -> [[S; N]; N] {
        self.0.bend(&[jets(q, &[[S::zero(); N]; N]), jets(v, &unit_vectors())].concat())
    }
}

/// x with its derivatives along directions.
fn jets<S: Scalar, const T: usize, const N: usize>(x: &[S; N], along: &[[S; N]; T]) -> Vec<Jet<S, T>> {
    x.iter().enumerate().map(|(i, x)| Jet { value: *x, tangent: from_fn(|k| along[k][i]) }).collect()
}

/// The N unit vectors.
fn unit_vectors<S: Scalar, const N: usize>() -> [[S; N]; N] {
    from_fn(|i| from_fn(|j| if i == j { S::one() } else { S::zero() }))
}

impl<S: Scalar<Weight = f64>, L: ScalarNetwork, const N: usize> Lagrangian<S, N> for NetworkLagrangian<L> {
    fn energies(&self, q: &[S; N], v: &[S; N]) -> Energies<S> {
        let (l, [_, l_v]) = self.differentiate([q, v], [[]; 2]);
        let kinetic = dot(&l_v.map(|p: Jet<S, 0>| p.value), v).half();
        Energies { kinetic, potential: kinetic - l }
    }

    fn gradient(&self, q: &[S; N], v: &[S; N]) -> Gradient<S, N> {
        let (_, [l_q, l_v]) = self.differentiate::<S, 0, N>([q, v], [[]; 2]);
        Gradient { l_q: l_q.map(|l| l.value), l_v: l_v.map(|p| p.value) }
    }

    /// One tangent along the motion with its adjoint, and one pass with N tangents for L_vv.
    fn dynamics(&self, q: &[S; N], v: &[S; N]) -> Dynamics<S, N> {
        let (_, [l_q, l_v]) = self.differentiate([q, v], [[*v], [[S::zero(); N]]]);
        Dynamics {
            mass: self.mass_matrix([q, v]),
            l_q: l_q.map(|l| l.value),
            l_v: l_v.map(|p| p.value),
            l_vq_v: l_v.map(|Jet { tangent: [along_v], .. }| along_v),
        }
    }

    fn hessian(&self, q: &[S; N], v: &[S; N]) -> Hessian<S, N> {
        let (_, [l_q, l_v]) = self.differentiate([q, v], [unit_vectors(), [[S::zero(); N]; N]]);
        Hessian {
            l_q: l_q.map(|l| l.value),
            l_v: l_v.map(|p| p.value),
            l_qq: l_q.map(|l| l.tangent),
            l_vq: l_v.map(|p| p.tangent),
            l_vv: self.mass_matrix([q, v]),
        }
    }
}

impl<S: HostScalar, L: ScalarNetwork, const N: usize> Learnable<S, N> for NetworkLagrangian<L> {
    fn directional_gradient(
        &self,
        (q, v): (&[S; N], &[S; N]),
        (dq, dv): (&[S; N], &[S; N]),
        row: impl FnMut(usize, S),
    ) {
        self.0.slope_gradient(&moving(&[*q, *v].concat(), &[*dq, *dv].concat()), row);
    }

    /// With ẋ = (v, a), e = (0, y) and f = (y, 0) it is that of L_x f − e L_xx ẋ, less the derivative in s and t of
    /// L(x + sẋ + te − stf): the tangent along e − sf, differentiated along the motion.
    fn residual_gradient(
        &self,
        (q, v): (&[S; N], &[S; N]),
        a: &[S; N],
        y: &[S; N],
        mut row: impl FnMut(usize, S),
    ) {
        let jet = |x: S, rate: S, tangent| Jet { value: Dual::moving(x, rate), tangent: [tangent] };
        let positions = (0..N).map(|i| jet(q[i], v[i], Dual::moving(S::zero(), -y[i])));
        let velocities = (0..N).map(|i| jet(v[i], a[i], Dual::fixed(y[i])));
        let x: Vec<_> = positions.chain(velocities).collect();
        self.0.slope_gradient(&x, |i, g: Dual<S>| row(i, -g.slope()));
    }
}

/// Columns of L_vv that are found together.
const COLUMNS: usize = 8;

/// Writes v̇(q, v) of particles on rods, however many: L_vv v̇ = L_q − L_vq v + Aᵀλ, A v̇ = −Ȧv. `None` where there is none, or
/// the slices do not fit.
pub(super) fn acceleration<const D: usize>(
    network: &impl ScalarNetwork,
    rods: &[Holonomic<f64, D>],
    [q, v]: [&[f64]; 2],
    out: &mut [f64],
) -> Option<()> {
    let (n, equations) = (out.len(), rods.len());
    if q.len() != n || v.len() != n {
        return None;
    }
    let mut matrix = DMatrix::zeros(n + equations, n + equations);
    let mut right = DVector::from_vec(force(network, [q, v]));
    right.resize_vertically_mut(n + equations, 0.0);
    for first in (0..n).step_by(COLUMNS) {
        for (j, column) in (first..n).zip(momentum_slopes(network, [q, v], first)) {
            matrix.view_mut((0, j), (n, 1)).copy_from_slice(&column);
        }
    }
    let (x, rates) = (Positions::new(q.as_chunks().0), v.as_chunks().0);
    for (k, row) in (n..).zip(0..equations) {
        for (slot, node) in rods.nodes(row).iter().enumerate() {
            for (i, along) in (D * node..).zip(rods.gradient(row, slot, x)) {
                (matrix[(k, i)], matrix[(i, k)]) = (along, -along);
            }
        }
        right[k] = -rods.curvature(row, x, rates);
    }
    out.copy_from_slice(matrix.lu().solve(&right)?.as_slice().get(..n)?);
    Some(())
}

/// L_q − L_vq v.
fn force(network: &impl ScalarNetwork, [q, v]: [&[f64]; 2]) -> Vec<f64> {
    let still = vec![0.0; v.len()];
    let (_, slope) = network.differentiate(&moving(&[q, v].concat(), &[v, &still].concat()));
    let (l_q, l_v) = slope.split_at(q.len());
    l_q.iter().zip(l_v).map(|(l_q, Jet { tangent: [along_v], .. })| l_q.value - along_v).collect()
}

/// The derivatives of L_v in the velocities from `first` on, [`COLUMNS`] of them at most.
fn momentum_slopes(network: &impl ScalarNetwork, [q, v]: [&[f64]; 2], first: usize) -> [Vec<f64>; COLUMNS] {
    let mut x: Vec<Jet<f64, COLUMNS>> = q.iter().chain(v).copied().map(Jet::constant).collect();
    x[q.len() + first..].iter_mut().take(COLUMNS).enumerate().for_each(|(k, x)| x.tangent[k] = 1.0);
    let (_, slope) = network.differentiate(&x);
    from_fn(|k| slope[q.len()..].iter().map(|p| p.tangent[k]).collect())
}
