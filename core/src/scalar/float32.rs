use super::{Real, Scalar, WeightFormat, Weights, tanh};
use leastaction_fpu::{half, portable, sin_cos, single, sqrt};

/// 2π, and the next smaller number.
const TURN: f32 = core::f32::consts::TAU;
const BELOW_TURN: f32 = TURN.next_down();

impl Scalar for f32 {
    type Weight = f32;

    /// True on controllers; the vector registers of larger processors hold several sums with their tangents.
    const COMPONENTWISE: bool = cfg!(target_pointer_width = "32");

    #[inline]
    fn accumulate<W: WeightFormat<Wide = f32>, const P: usize>(
        rows: &[[W; P]],
        x: &[f32],
        sum: &mut [f32; P],
    ) {
        let (weights, sums) = (W::in_file(rows.as_flattened()), sum.as_mut_slice());
        match (P, weights) {
            (8, Some(Weights::Single(w))) => {
                sums.as_chunks_mut().0.iter_mut().for_each(|s| single::accumulate_8(w.as_chunks().0, x, s))
            }
            (4, Some(Weights::Single(w))) => {
                sums.as_chunks_mut().0.iter_mut().for_each(|s| single::accumulate_4(w.as_chunks().0, x, s))
            }
            (8, Some(Weights::Half(w))) => {
                sums.as_chunks_mut().0.iter_mut().for_each(|s| half::accumulate_8(w.as_chunks().0, x, s))
            }
            (4, Some(Weights::Half(w))) => {
                sums.as_chunks_mut().0.iter_mut().for_each(|s| half::accumulate_4(w.as_chunks().0, x, s))
            }
            _ => portable::accumulate(rows, x, sum, W::wide),
        }
    }
    #[inline]
    fn transposed<W: WeightFormat<Wide = f32>, const P: usize>(
        rows: &[[W; P]],
        y_bar: &[f32; P],
        x_bar: &mut [f32],
    ) {
        let y = y_bar.as_slice();
        match (P, W::in_file(rows.as_flattened())) {
            (8, Some(Weights::Single(w))) => {
                y.as_chunks().0.iter().for_each(|y| single::transposed_8(w.as_chunks().0, y, x_bar))
            }
            (4, Some(Weights::Single(w))) => {
                y.as_chunks().0.iter().for_each(|y| single::transposed_4(w.as_chunks().0, y, x_bar))
            }
            (8, Some(Weights::Half(w))) => {
                y.as_chunks().0.iter().for_each(|y| half::transposed_8(w.as_chunks().0, y, x_bar))
            }
            (4, Some(Weights::Half(w))) => {
                y.as_chunks().0.iter().for_each(|y| half::transposed_4(w.as_chunks().0, y, x_bar))
            }
            _ => portable::transposed(rows, y_bar, x_bar, W::wide),
        }
    }
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
        sqrt(self)
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
        sin_cos(self)
    }
    #[inline]
    fn wrapped(self) -> Self {
        let angle = self - libm::floorf(self / TURN) * TURN;
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
        f32::from_bits(self.to_bits() | 0x8000_0000)
    }
}

impl Real for f32 {
    const EPSILON: Self = f32::EPSILON;

    #[inline(always)]
    fn abs(self) -> Self {
        f32::from_bits(self.to_bits() & 0x7fff_ffff)
    }
    #[inline]
    fn short_way(self) -> Self {
        self - TURN * libm::roundf(self / TURN)
    }
    #[inline(always)]
    fn is_finite(self) -> bool {
        f32::is_finite(self)
    }
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
}
