use super::{Real, Scalar, tanh, trigonometry};

impl Scalar for f32 {
    type Weight = f32;

    #[inline(always)]
    fn weight(w: f32) -> Self {
        w
    }
    #[inline(always)]
    fn constant(x: f64) -> Self {
        x as f32
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        libm::sqrtf(self)
    }
    #[inline]
    fn exp(self) -> Self {
        libm::expf(self)
    }
    #[inline]
    fn ln_1p(self) -> Self {
        libm::log1pf(self)
    }
    #[inline]
    fn tanh(self) -> Self {
        tanh::tanh_f32(self)
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        trigonometry::sin_cos(self)
    }
    #[inline]
    fn wrapped(self) -> Self {
        self - libm::floorf(self / core::f32::consts::TAU) * core::f32::consts::TAU
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
    #[inline(always)]
    fn neg_abs(self) -> Self {
        f32::from_bits(self.to_bits() | 0x8000_0000)
    }
}

impl Real for f32 {
    const EPSILON: Self = f32::EPSILON;

    #[inline(always)]
    fn abs(self) -> Self {
        f32::from_bits(self.to_bits() & 0x7fff_ffff)
    }
    #[inline(always)]
    fn is_finite(self) -> bool {
        f32::is_finite(self)
    }
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
}
