use super::Scalar;
use super::sin_cos::sin_cos;
use core::array;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// Number of samples in one [`Lanes`] value.
pub const LANES: usize = 8;

/// Eight samples side by side, in double precision: the same operations in the same order as for one sample in `f64`, so every lane has the
/// bits of its sample's scalar evaluation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Lanes(
    /// One value per lane.
    pub [f64; LANES],
);

impl Lanes {
    /// Applies `f` to every lane.
    #[inline(always)]
    pub fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self(array::from_fn(|i| f(self.0[i])))
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self(array::from_fn(|i| f(self.0[i], other.0[i])))
    }
}

// Registers by name where they are known: a compiler finds them by itself only in small functions. Elsewhere written out, since closures would
// double the time to compile the trainer.
macro_rules! lanewise {
    ($trait:ident, $method:ident, $op:tt) => {
        impl $trait for Lanes {
            type Output = Self;
            #[cfg(target_arch = "x86_64")]
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self((wide::f64x8::new(self.0) $op wide::f64x8::new(other.0)).to_array())
            }
            #[cfg(not(target_arch = "x86_64"))]
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                let ([a0, a1, a2, a3, a4, a5, a6, a7], [b0, b1, b2, b3, b4, b5, b6, b7]) = (self.0, other.0);
                Self([
                    a0 $op b0, a1 $op b1, a2 $op b2, a3 $op b3, a4 $op b4, a5 $op b5, a6 $op b6, a7 $op b7,
                ])
            }
        }
    };
}
lanewise!(Add, add, +);
lanewise!(Sub, sub, -);
lanewise!(Mul, mul, *);
lanewise!(Div, div, /);

impl Neg for Lanes {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

impl AddAssign for Lanes {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Lanes {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl Scalar for Lanes {
    type Weight = f64;

    #[inline(always)]
    fn weight(w: f64) -> Self {
        Self([w; LANES])
    }
    #[inline(always)]
    fn constant(x: f64) -> Self {
        Self([x; LANES])
    }
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(wide::f64x8::new(self.0).sqrt().to_array())
    }
    #[cfg(not(target_arch = "x86_64"))]
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.map(Scalar::sqrt)
    }
    #[inline]
    fn exp(self) -> Self {
        self.map(Scalar::exp)
    }
    #[inline]
    fn ln_1p(self) -> Self {
        self.map(Scalar::ln_1p)
    }
    #[inline]
    fn tanh(self) -> Self {
        self.map(Scalar::tanh)
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = sin_cos(self.0);
        (Self(sin), Self(cos))
    }
    #[inline]
    fn wrapped(self) -> Self {
        self.map(Scalar::wrapped)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, Scalar::max)
    }
    #[inline(always)]
    fn neg_abs(self) -> Self {
        self.map(Scalar::neg_abs)
    }
}
