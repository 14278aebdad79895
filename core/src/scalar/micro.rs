use super::{Real, Scalar};
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};
use micromath::F32Ext;

/// Single precision with micromath's approximate elementary functions: smaller and faster where there is no
/// floating-point unit, far less accurate (see the table of errors in `core/README.md`). Opt-in by the feature `micromath`
/// *and* by type, so that switching it on changes nobody else's bits.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Micro(
    /// The value.
    pub f32,
);

macro_rules! forward {
    ($trait:ident, $method:ident, $op:tt) => {
        impl $trait for Micro {
            type Output = Self;
            #[inline(always)]
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

impl Neg for Micro {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl AddAssign for Micro {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        self.0 += other.0;
    }
}

impl SubAssign for Micro {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        self.0 -= other.0;
    }
}

impl Scalar for Micro {
    type Weight = f32;

    #[inline(always)]
    fn weight(w: f32) -> Self {
        Self(w)
    }
    #[inline(always)]
    fn constant(x: f64) -> Self {
        Self(x as f32)
    }
    fn sqrt(self) -> Self {
        Self(F32Ext::sqrt(self.0))
    }
    fn exp(self) -> Self {
        Self(F32Ext::exp(self.0))
    }
    fn ln_1p(self) -> Self {
        Self(F32Ext::ln(1.0 + self.0))
    }
    fn tanh(self) -> Self {
        let t = F32Ext::exp(2.0 * Scalar::neg_abs(self.0));
        Self(F32Ext::copysign((1.0 - t) / (1.0 + t), self.0))
    }
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = F32Ext::sin_cos(self.0);
        (Self(sin), Self(cos))
    }
    fn wrapped(self) -> Self {
        Self(Scalar::wrapped(self.0))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(Scalar::max(self.0, other.0))
    }
    #[inline(always)]
    fn neg_abs(self) -> Self {
        Self(Scalar::neg_abs(self.0))
    }
}

impl Real for Micro {
    const EPSILON: Self = Self(f32::EPSILON);

    #[inline(always)]
    fn abs(self) -> Self {
        Self(Real::abs(self.0))
    }
    #[inline(always)]
    fn is_finite(self) -> bool {
        self.0.is_finite()
    }
    fn to_f64(self) -> f64 {
        f64::from(self.0)
    }
}
