use super::{Real, Scalar, sin_cos, tanh};

/// 2π, and the next smaller number.
const TURN: f64 = core::f64::consts::TAU;
const BELOW_TURN: f64 = TURN.next_down();

impl Scalar for f64 {
    type Weight = f64;

    /// True except on controllers, which have no vector registers.
    const SIDE_BY_SIDE: bool = cfg!(target_pointer_width = "64");

    #[inline]
    fn sin_cos_of<const N: usize>(x: &[Self; N]) -> ([Self; N], [Self; N]) {
        sin_cos::many(x)
    }

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
        let angle = self - libm::floor(self / TURN) * TURN;
        // The quotient, and with it the floor, may have been rounded up.
        let angle = if angle < 0.0 { angle + TURN } else { angle };
        angle.clamp(0.0, BELOW_TURN)
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
    #[inline]
    fn short_way(self) -> Self {
        self - TURN * libm::round(self / TURN)
    }
    #[inline(always)]
    fn is_finite(self) -> bool {
        f64::is_finite(self)
    }
    fn to_f64(self) -> f64 {
        self
    }
}
