//! A [`Scalar`] that carries all derivatives up to third order along three directions (num-dual): the oracle.

use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::scalar::{Scalar, WeightFormat};
use num_dual::{DualNum, HyperHyperDual64};

/// x + ε₁x₁ + ε₂x₂ + ε₃x₃ + … + ε₁ε₂ε₃x₁₂₃.
#[derive(Clone, Copy, Debug)]
pub struct Dual(pub HyperHyperDual64);

impl Dual {
    pub fn constant(x: f64) -> Self {
        Self(HyperHyperDual64::from_re(x))
    }

    /// x moving along the three directions.
    pub fn moving(x: f64, along: [f64; 3]) -> Self {
        let [e1, e2, e3] = along;
        Self(HyperHyperDual64::new(x, e1, e2, e3, 0.0, 0.0, 0.0, 0.0))
    }
}

impl Default for Dual {
    fn default() -> Self {
        Self::constant(0.0)
    }
}

impl PartialEq for Dual {
    fn eq(&self, other: &Self) -> bool {
        self.0.re == other.0.re
    }
}

macro_rules! forward {
    ($trait:ident, $method:ident, $op:tt) => {
        impl $trait for Dual {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                Self(self.0 $op other.0)
            }
        }
    };
}
forward!(Add, add, +);
forward!(Sub, sub, -);
forward!(Mul, mul, *);
forward!(Div, div, /);

impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl AddAssign for Dual {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Dual {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl WeightFormat for Dual {
    type Wide = Dual;

    fn wide(self) -> Dual {
        self
    }
}

impl Scalar for Dual {
    type Weight = Dual;

    /// As on a controller: the oracle of the derivatives passes the layers as a chip does.
    const COMPONENTWISE: bool = true;

    fn weight(w: Dual) -> Self {
        w
    }
    fn constant(x: f64) -> Self {
        Self::constant(x)
    }
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }
    fn exp(self) -> Self {
        Self(self.0.exp())
    }
    fn ln_1p(self) -> Self {
        Self(self.0.ln_1p())
    }
    fn tanh(self) -> Self {
        Self(self.0.tanh())
    }
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.0.sin_cos();
        (Self(sin), Self(cos))
    }
    fn wrapped(self) -> Self {
        self + Self::constant(self.0.re.wrapped() - self.0.re)
    }
    fn max(self, other: Self) -> Self {
        if self.0.re > other.0.re { self } else { other }
    }
    fn neg_abs(self) -> Self {
        if self.0.re > 0.0 { -self } else { self }
    }
}

/// Which of the 2N variables (q, v) moves along a direction, and how fast.
pub type Direction<const N: usize> = ([f64; N], [f64; N]);

/// L = T − V at (q, v) moving along three directions.
pub fn lagrangian<L: Lagrangian<Dual, N>, const N: usize>(
    l: &L,
    q: &[f64; N],
    v: &[f64; N],
    along: [Direction<N>; 3],
) -> HyperHyperDual64 {
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
    let second = |a: Direction<N>, b: Direction<N>| lagrangian(l, q, v, [a, b, still]).eps1eps2;
    let matrix = |a: fn([f64; N]) -> Direction<N>, b: fn([f64; N]) -> Direction<N>| {
        core::array::from_fn(|i| core::array::from_fn(|j| second(a(unit(i)), b(unit(j)))))
    };
    let (in_q, in_v) = (|e| (e, [0.0; N]), |e| ([0.0; N], e));
    Derivatives {
        l_q: core::array::from_fn(|i| lagrangian(l, q, v, [in_q(unit(i)), still, still]).eps1),
        l_v: core::array::from_fn(|i| lagrangian(l, q, v, [in_v(unit(i)), still, still]).eps1),
        l_qq: matrix(in_q, in_q),
        l_vq: matrix(in_v, in_q),
        l_vv: matrix(in_v, in_v),
    }
}
