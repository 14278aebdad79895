use super::{Real, Scalar, tanh, trigonometry};
use leastaction_fpu as fpu;

impl Scalar for f32 {
    type Weight = f32;

    /// On controllers; a desk's processor has vector registers for several sums and their tangents.
    const APART: bool = cfg!(target_pointer_width = "32");

    #[inline]
    fn accumulate<const P: usize>(rows: &[[f32; P]], x: &[f32], sum: &mut [f32; P]) {
        let (weights, sums) = (rows.as_flattened(), sum.as_mut_slice());
        match P {
            8 => {
                sums.as_chunks_mut().0.iter_mut().for_each(|s| fpu::accumulate_8(weights.as_chunks().0, x, s))
            }
            4 => {
                sums.as_chunks_mut().0.iter_mut().for_each(|s| fpu::accumulate_4(weights.as_chunks().0, x, s))
            }
            _ => fpu::portable::accumulate(rows, x, sum, Self::weight),
        }
    }
    #[inline]
    fn transposed<const P: usize>(rows: &[[f32; P]], y_bar: &[f32; P], x_bar: &mut [f32]) {
        let weights = rows.as_flattened();
        match P {
            8 => y_bar.as_chunks().0.iter().for_each(|y| fpu::transposed_8(weights.as_chunks().0, y, x_bar)),
            4 => y_bar.as_chunks().0.iter().for_each(|y| fpu::transposed_4(weights.as_chunks().0, y, x_bar)),
            _ => fpu::portable::transposed(rows, y_bar, x_bar, Self::weight),
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
        fpu::sqrt(self)
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
