//! Derivatives of energies by num-dual: the oracle.

use super::dual_number;
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::scalar::Real;
use num_dual::HyperDual64;

/// First derivatives along two directions, and the mixed second one: x + ε₁x₁ + ε₂x₂ + ε₁ε₂x₁₂.
pub type Dual = dual_number::Dual<HyperDual64>;

impl Dual {
    /// x moving along two directions.
    pub fn moving(x: f64, [e1, e2]: [f64; 2]) -> Self {
        Self(HyperDual64::new(x, e1, e2, 0.0))
    }
}

/// Comparisons see the values alone.
impl Real for Dual {
    const EPSILON: Self =
        dual_number::Dual(HyperDual64 { re: f64::EPSILON, eps1: 0.0, eps2: 0.0, eps1eps2: 0.0 });

    fn abs(self) -> Self {
        if self.0.re < 0.0 { -self } else { self }
    }
    fn short_way(self) -> Self {
        self + Self::constant(self.0.re.short_way() - self.0.re)
    }
    fn is_finite(self) -> bool {
        self.0.re.is_finite()
    }
    fn to_f64(self) -> f64 {
        self.0.re
    }
}

/// Motion of the 2N variables (q, v) along a direction.
pub type Direction<const N: usize> = ([f64; N], [f64; N]);

/// L = T − V at (q, v) moving along two directions.
pub fn lagrangian<L: Lagrangian<Dual, N>, const N: usize>(
    l: &L,
    q: &[f64; N],
    v: &[f64; N],
    along: [Direction<N>; 2],
) -> HyperDual64 {
    let q = core::array::from_fn(|i| Dual::moving(q[i], along.map(|d| d.0[i])));
    let v = core::array::from_fn(|i| Dual::moving(v[i], along.map(|d| d.1[i])));
    let energies = l.energies(&q, &v);
    (energies.kinetic - energies.potential).0
}

/// All derivatives of L up to second order, from its energies alone.
pub struct Derivatives<const N: usize> {
    pub l_q: [f64; N],
    pub l_v: [f64; N],
    pub l_qq: [[f64; N]; N],
    pub l_vq: [[f64; N]; N],
    pub l_vv: [[f64; N]; N],
}

pub fn unit<const N: usize>(i: usize) -> [f64; N] {
    core::array::from_fn(|j| f64::from(i == j))
}

pub fn derivatives<L: Lagrangian<Dual, N>, const N: usize>(
    l: &L,
    q: &[f64; N],
    v: &[f64; N],
) -> Derivatives<N> {
    let zero = [0.0; N];
    let still = (zero, zero);
    let second = |a: Direction<N>, b: Direction<N>| lagrangian(l, q, v, [a, b]).eps1eps2;
    let matrix = |a: fn([f64; N]) -> Direction<N>, b: fn([f64; N]) -> Direction<N>| {
        core::array::from_fn(|i| core::array::from_fn(|j| second(a(unit(i)), b(unit(j)))))
    };
    let (in_q, in_v) = (|e| (e, [0.0; N]), |e| ([0.0; N], e));
    Derivatives {
        l_q: core::array::from_fn(|i| lagrangian(l, q, v, [in_q(unit(i)), still]).eps1),
        l_v: core::array::from_fn(|i| lagrangian(l, q, v, [in_v(unit(i)), still]).eps1),
        l_qq: matrix(in_q, in_q),
        l_vq: matrix(in_v, in_q),
        l_vv: matrix(in_v, in_v),
    }
}
