//! Dual numbers (num-dual) as a [`Scalar`].

use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};
use leastaction_core::scalar::{Scalar, WeightFormat};
use num_dual::DualNum;

/// A dual number over f64, of any order and number of directions.
pub trait Number: DualNum<Primitive = f64> + Copy {}

impl<D: DualNum<Primitive = f64> + Copy> Number for D {}

/// A number with its derivatives.
#[derive(Clone, Copy, Debug)]
pub struct Dual<D>(pub D);

impl<D: Number> Dual<D> {
    pub fn constant(x: f64) -> Self {
        Self(D::from(x))
    }
}

impl<D: Number> Default for Dual<D> {
    fn default() -> Self {
        Self::constant(0.0)
    }
}

impl<D: Number> PartialEq for Dual<D> {
    fn eq(&self, other: &Self) -> bool {
        self.0.re() == other.0.re()
    }
}

macro_rules! forward {
    ($trait:ident, $method:ident, $op:tt) => {
        impl<D: Number> $trait for Dual<D> {
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

impl<D: Number> Neg for Dual<D> {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl<D: Number> AddAssign for Dual<D> {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<D: Number> SubAssign for Dual<D> {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<D: Number> WeightFormat for Dual<D> {
    type Wide = Self;

    fn wide(self) -> Self {
        self
    }
}

impl<D: Number> Scalar for Dual<D> {
    type Weight = Self;

    /// True as on a controller: the oracle of the derivatives passes the layers as a chip does.
    const COMPONENTWISE: bool = true;

    fn weight(w: Self) -> Self {
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
        self + Self::constant(self.0.re().wrapped() - self.0.re())
    }
    fn max(self, other: Self) -> Self {
        if self.0.re() > other.0.re() { self } else { other }
    }
    fn neg_abs(self) -> Self {
        if self.0.re() > 0.0 { -self } else { self }
    }
}

impl<D: Number> PartialOrd for Dual<D> {
    fn partial_cmp(&self, other: &Self) -> Option<core::cmp::Ordering> {
        self.0.re().partial_cmp(&other.0.re())
    }
}
