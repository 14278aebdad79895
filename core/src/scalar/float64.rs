use super::{Real, Scalar, tanh};

impl Scalar for f64 {
    type Weight = f64;

    #[inline(always)]
    fn weight(w: f64) -> Self {
        w
    }
    #[inline(always)]
    fn constant(x: f64) -> Self {
        x
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        libm::sqrt(self)
    }
    #[inline]
    fn exp(self) -> Self {
        libm::exp(self)
    }
    #[inline]
    fn ln_1p(self) -> Self {
        libm::log1p(self)
    }
    #[inline]
    fn tanh(self) -> Self {
        tanh::tanh_f64(self)
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        libm::sincos(self)
    }
    #[inline]
    fn wrapped(self) -> Self {
        self - libm::floor(self / core::f64::consts::TAU) * core::f64::consts::TAU
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
    #[inline(always)]
    fn neg_abs(self) -> Self {
        f64::from_bits(self.to_bits() | 1 << 63)
    }
}

impl Real for f64 {
    const EPSILON: Self = f64::EPSILON;

    #[inline(always)]
    fn abs(self) -> Self {
        f64::from_bits(self.to_bits() & !(1 << 63))
    }
    #[inline(always)]
    fn is_finite(self) -> bool {
        f64::is_finite(self)
    }
    fn to_f64(self) -> f64 {
        self
    }
}
