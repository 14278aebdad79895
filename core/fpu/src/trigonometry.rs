//! Sine and cosine in single precision only: libm's functions compute in soft doubles on a Cortex-M4F (1,200–2,100
//! instructions).
//!
//! Cody–Waite reduction by π/2 in four parts, then the minimax polynomials on [−π/4, π/4] of Cephes `sinf`/`cosf` (S. Moshier). The error
//! is at most 2 ulp for |x| ≤ 8192, except next to a multiple of π/2, where the result itself vanishes: at most 1.2e-7 there. Beyond
//! ±65,536 rad, where neighbouring f32 are 8 mrad apart, the answer is NaN rather than a meaningless number.

pub(crate) const TWO_OVER_PI: f32 = core::f32::consts::FRAC_2_PI;
/// Number that rounds to the nearest integer if it is added and subtracted, for |x| ≤ 2²².
pub(crate) const ROUND: f32 = 12_582_912.0;
// π/2 in parts of few bits, so k times a part is exact for |k| < 2¹³.
pub(crate) const PIO2_1: f32 = 1.570_312_5;
pub(crate) const PIO2_2: f32 = 4.837_513e-4;
pub(crate) const PIO2_3: f32 = 7.549_789_4e-8;
pub(crate) const PIO2_4: f32 = 5.390_302_5e-15;

/// Largest angle accepted, rad.
pub(crate) const LIMIT: f32 = 65_536.0;

/// Coefficients of (sin r − r)/r in powers of r², the highest first.
pub(crate) const SINE: [f32; 3] = [-1.951_529_6e-4, 8.332_161e-3, -1.666_665_5e-1];
/// Coefficients of (cos r − 1 + r²/2)/r² in powers of r², the highest first.
pub(crate) const COSINE: [f32; 3] = [2.443_315_7e-5, -1.388_731_6e-3, 4.166_664_6e-2];

/// See [`sin_cos`](crate::sin_cos).
#[inline]
pub fn sin_cos(x: f32) -> (f32, f32) {
    let x = if (-LIMIT..=LIMIT).contains(&x) { x } else { f32::NAN };
    let turns = x * TWO_OVER_PI + ROUND;
    let k = turns - ROUND;
    let r = (((x - k * PIO2_1) - k * PIO2_2) - k * PIO2_3) - k * PIO2_4;
    let (sin, cos) = (sine(r), cosine(r));
    let quadrant = turns.to_bits();
    let (a, b) = if quadrant & 1 == 0 { (sin, cos) } else { (cos, sin) };
    (flip(a, quadrant & 2), flip(b, quadrant.wrapping_add(1) & 2))
}

/// `x` with its sign changed if `bit` is 2 and not 0.
#[inline(always)]
fn flip(x: f32, bit: u32) -> f32 {
    f32::from_bits(x.to_bits() ^ (bit << 30))
}

#[inline(always)]
fn sine(r: f32) -> f32 {
    let z = r * r;
    let [a, b, c] = SINE;
    let p = (a * z + b) * z + c;
    p * z * r + r
}

#[inline(always)]
fn cosine(r: f32) -> f32 {
    let z = r * r;
    let [a, b, c] = COSINE;
    let p = (a * z + b) * z + c;
    p * z * z - 0.5 * z + 1.0
}
