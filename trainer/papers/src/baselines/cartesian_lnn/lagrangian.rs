//! L = Σ k_i |v_i|² − V(q) with its derivatives.

use crate::baselines::features::moving;
use leastaction_core::energy::Learnable;
use leastaction_core::lagrangian::{Dynamics, Energies, Gradient, Hessian, Lagrangian};
use leastaction_core::network::{Activation, Jet, Mlp, Tape};
use leastaction_core::particles::Particles;
use leastaction_core::scalar::Scalar;
use std::array::from_fn;

/// Hidden layers of V, as LGNN's program has them.
pub(super) const DEPTH: usize = 2;
/// Units of each at most.
pub(super) const MAX_WIDTH: usize = 256;

/// The Lagrangian of nodes in the plane over a weight block.
#[derive(Clone, Copy, Debug)]
pub struct Cartesian<'w> {
    /// k of every node, kg.
    k: &'w [f64],
    potential: Mlp<'w, f64, MAX_WIDTH, DEPTH>,
}

impl<'w> Cartesian<'w> {
    /// From the front of a block; `None` where it is too short.
    pub fn take(nodes: usize, width: usize, weights: &'w [f64]) -> Option<Self> {
        let (k, mut rest) = weights.split_at_checked(nodes)?;
        let potential = Mlp::take(&mut rest, 2 * nodes, &[width; DEPTH], 1, Activation::Squareplus)?;
        Some(Self { k, potential })
    }

    /// Mass of coordinate i, kg.
    fn inertia<S: Scalar<Weight = f64>>(&self, i: usize) -> S {
        S::weight(2.0 * self.k[i / 2])
    }

    /// V, and V_q with its tangents along those of the positions.
    fn slope<S: Scalar<Weight = f64>, const T: usize>(&self, x: &[Jet<S, T>]) -> (S, Vec<Jet<S, T>>) {
        let (mut v, mut x_bar) = ([Jet::zero()], vec![Jet::zero(); x.len()]);
        let mut tape = Tape::<S, T, MAX_WIDTH, DEPTH>::default();
        self.potential.forward(x, &mut tape, &mut v);
        self.potential.adjoint(&tape, &[Jet::constant(S::one())], &mut x_bar);
        (v[0].value, x_bar)
    }

    /// −V_q.
    fn pull<S: Scalar<Weight = f64>, const N: usize>(&self, q: &[S; N]) -> [S; N] {
        let (_, slope) = self.slope(&q.map(Jet::<S, 0>::constant));
        from_fn(|i| -slope[i].value)
    }

    /// p.
    fn momenta<S: Scalar<Weight = f64>, const N: usize>(&self, v: &[S; N]) -> [S; N] {
        from_fn(|i| self.inertia::<S>(i) * v[i])
    }

    fn mass_matrix<S: Scalar<Weight = f64>, const N: usize>(&self) -> [[S; N]; N] {
        from_fn(|i| from_fn(|j| if i == j { self.inertia(i) } else { S::zero() }))
    }

    fn kinetic<S: Scalar<Weight = f64>>(&self, v: impl Iterator<Item = S>) -> S {
        v.enumerate().fold(S::zero(), |sum, (i, v)| sum + (self.inertia::<S>(i) * v * v).half())
    }

    /// Visits ∂/∂θ of −V_q·δq.
    fn pull_gradient<S: Scalar<Weight = f64>>(&self, q: &[S], dq: &[S], mut row: impl FnMut(usize, S)) {
        let x = moving(q, dq);
        let mut tape = Tape::<S, 1, MAX_WIDTH, DEPTH>::default();
        self.potential.forward(&x, &mut tape, &mut [Jet::zero()]);
        let mut start = self.k.len() + self.potential.len();
        self.potential.layer_adjoints(&tape, &x, &[Jet::<S, 1>::constant(-S::one())], |layer, x, bar| {
            start -= layer.len();
            layer.tangent_gradient(x, bar, |i, value| row(start + i, value));
        });
    }
}

impl<S: Scalar<Weight = f64>, const N: usize> Lagrangian<S, N> for Cartesian<'_> {
    fn energies(&self, q: &[S; N], v: &[S; N]) -> Energies<S> {
        let (potential, _) = self.slope(&q.map(Jet::<S, 0>::constant));
        Energies { kinetic: self.kinetic(v.iter().copied()), potential }
    }

    fn gradient(&self, q: &[S; N], v: &[S; N]) -> Gradient<S, N> {
        Gradient { l_q: self.pull(q), l_v: self.momenta(v) }
    }

    fn dynamics(&self, q: &[S; N], v: &[S; N]) -> Dynamics<S, N> {
        let mass = self.mass_matrix();
        Dynamics { mass, l_q: self.pull(q), l_v: self.momenta(v), l_vq_v: [S::zero(); N] }
    }

    fn hessian(&self, q: &[S; N], v: &[S; N]) -> Hessian<S, N> {
        let unit = |i| from_fn(|j| if i == j { S::one() } else { S::zero() });
        let x: [Jet<S, N>; N] = from_fn(|i| Jet { value: q[i], tangent: unit(i) });
        let (_, slope) = self.slope(&x);
        Hessian {
            l_q: from_fn(|i| -slope[i].value),
            l_v: self.momenta(v),
            l_qq: from_fn(|i| slope[i].tangent.map(|x| -x)),
            l_vq: [[S::zero(); N]; N],
            l_vv: self.mass_matrix(),
        }
    }
}

impl<S: Scalar<Weight = f64>, const N: usize> Learnable<S, N> for Cartesian<'_> {
    fn directional_gradient(
        &self,
        (q, v): (&[S; N], &[S; N]),
        (dq, dv): (&[S; N], &[S; N]),
        mut row: impl FnMut(usize, S),
    ) {
        for (i, (v, dv)) in v.iter().zip(dv).enumerate() {
            row(i / 2, S::constant(2.0) * *v * *dv);
        }
        self.pull_gradient(q, dq, row);
    }

    fn residual_gradient(
        &self,
        (q, _): (&[S; N], &[S; N]),
        a: &[S; N],
        y: &[S; N],
        mut row: impl FnMut(usize, S),
    ) {
        for (i, (a, y)) in a.iter().zip(y).enumerate() {
            row(i / 2, S::constant(-2.0) * *a * *y);
        }
        self.pull_gradient(q, y, row);
    }
}

impl Particles<f64, 2> for Cartesian<'_> {
    fn nodes(&self) -> usize {
        self.k.len()
    }

    fn workspace(&self) -> usize {
        0
    }

    fn energies(&self, q: &[[f64; 2]], v: &[[f64; 2]], _room: &mut [f64]) -> Energies<f64> {
        let x: Vec<_> = q.as_flattened().iter().copied().map(Jet::<f64, 0>::constant).collect();
        let (potential, _) = self.slope(&x);
        Energies { kinetic: self.kinetic(v.as_flattened().iter().copied()), potential }
    }

    fn l_q(&self, q: &[[f64; 2]], _room: &mut [f64], l_q: &mut [[f64; 2]]) {
        let x: Vec<_> = q.as_flattened().iter().copied().map(Jet::<f64, 0>::constant).collect();
        let (_, slope) = self.slope(&x);
        l_q.as_flattened_mut().iter_mut().zip(slope).for_each(|(l_q, slope)| *l_q = -slope.value);
    }

    fn l_v(&self, node: usize, v: &[f64; 2]) -> [f64; 2] {
        v.map(|v| self.inertia::<f64>(2 * node) * v)
    }

    fn mass(&self, node: usize, _v: &[f64; 2]) -> [[f64; 2]; 2] {
        let mass = self.inertia(2 * node);
        [[mass, 0.0], [0.0, mass]]
    }

    fn drag(&self, _node: usize, _v: &[f64; 2]) -> [f64; 2] {
        [0.0; 2]
    }

    fn drag_slope(&self, _node: usize, _v: &[f64; 2]) -> [f64; 2] {
        [0.0; 2]
    }
}
