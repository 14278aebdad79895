//! Sine and cosine of numbers side by side: without branches, so that a compiler can run them over vectors, and with the bits of libm's
//! functions, which take one number at a time.

use core::f64::consts::FRAC_2_PI;

/// First 33 bits of π/2, and the rest.
const HALF_PI_HIGH: f64 = 1.570_796_326_734_125_6;
const HALF_PI_LOW: f64 = 6.077_100_506_506_192e-11;
/// Adding this number rounds to an integer.
const ROUND: f64 = 6_755_399_441_055_744.0;
/// Largest angle that is reduced here, rad.
const LARGEST: f64 = 1e5;
/// Distance from a multiple of π/2, rad, beyond which libm may count from the next one.
const FARTHEST: f64 = 0.785;
/// Distance from a multiple of π/2, relative to the angle, below which libm takes more digits of π.
const NEAREST: f64 = 1.0 / 16_384.0;
/// Angle, rad, below which the sine is the angle in double precision.
const TINY: f64 = 1e-9;

/// Sines and cosines of angles in rad.
#[inline]
pub(super) fn sin_cos<const L: usize>(x: [f64; L]) -> ([f64; L], [f64; L]) {
    let (mut sin, mut cos, mut differs) = ([0.0; L], [0.0; L], [0_u64; L]);
    for i in 0..L {
        (sin[i], cos[i], differs[i]) = reduced(x[i]);
    }
    if differs.iter().fold(0, |all, own| all | own) != 0 {
        for i in 0..L {
            if differs[i] != 0 {
                (sin[i], cos[i]) = libm::sincos(x[i]);
            }
        }
    }
    (sin, cos)
}

/// Sines and cosines of any number of angles, four at a time; the last four overlap those before.
#[inline(always)]
pub(super) fn many<const N: usize>(x: &[f64; N]) -> ([f64; N], [f64; N]) {
    let (mut sin, mut cos) = ([0.0; N], [0.0; N]);
    for chunk in 0..N.div_ceil(4) {
        let start = (4 * chunk).min(N.saturating_sub(4));
        let of = |x: &[f64; N]| x.get(start..)?.first_chunk::<4>().copied();
        let four = of(x).unwrap_or_else(|| core::array::from_fn(|i| if i < N { x[i] } else { 0.0 }));
        let both = sin_cos(four);
        sin.iter_mut().skip(start).zip(both.0).for_each(|(sin, own)| *sin = own);
        cos.iter_mut().skip(start).zip(both.1).for_each(|(cos, own)| *cos = own);
    }
    (sin, cos)
}

/// The sine, the cosine, and 0 if they have the bits of libm's.
///
/// Source: FreeBSD's `s_sin.c`, `k_sin.c` and `k_cos.c`, by way of libm: the first round of the reduction by multiples of π/2, and the same polynomials.
#[inline(always)]
fn reduced(x: f64) -> (f64, f64, u64) {
    let shifted = x * FRAC_2_PI + ROUND;
    let n = shifted - ROUND;
    let (r, w) = (x - n * HALF_PI_HIGH, n * HALF_PI_LOW);
    let y = r - w;
    let rest = (r - y) - w;
    let sin = if n == 0.0 { sine_alone(y) } else { sine(y, rest) };
    let sin = if x.abs() < TINY { x } else { sin };
    let cos = cosine(y, rest);
    // n in the low bits: a quarter turn exchanges both, a half turn changes their signs.
    let quarters = shifted.to_bits();
    let (a, b) = if quarters & 1 == 0 { (sin, cos) } else { (cos, sin) };
    let flipped = |x: f64, half: u64| f64::from_bits(x.to_bits() ^ (half & 2) << 62);
    let (near, far) = (NEAREST * x.abs(), y.abs());
    let is_same = x.abs() < LARGEST && far < FARTHEST && (n == 0.0 || far > near);
    (flipped(a, quarters), flipped(b, quarters.wrapping_add(1)), u64::from(!is_same))
}

const S1: f64 = -0.166_666_666_666_666_32;

/// z r of sin y = y + y³ (S₁ + z r), z = y².
#[inline(always)]
fn sine_terms(z: f64) -> f64 {
    const S: [f64; 5] = [
        8.333_333_333_322_49e-3,
        -1.984_126_982_985_795e-4,
        2.755_731_370_707_006_8e-6,
        -2.505_076_025_340_686_3e-8,
        1.589_690_995_211_55e-10,
    ];
    S[0] + z * (S[1] + z * S[2]) + z * (z * z) * (S[3] + z * S[4])
}

#[inline(always)]
fn sine_alone(y: f64) -> f64 {
    let z = y * y;
    y + z * y * (S1 + z * sine_terms(z))
}

/// sin(y + rest).
#[inline(always)]
fn sine(y: f64, rest: f64) -> f64 {
    let z = y * y;
    let cube = z * y;
    y - ((z * (0.5 * rest - cube * sine_terms(z)) - rest) - cube * S1)
}

/// cos(y + rest).
#[inline(always)]
fn cosine(y: f64, rest: f64) -> f64 {
    const C: [f64; 6] = [
        4.166_666_666_666_66e-2,
        -1.388_888_888_887_411e-3,
        2.480_158_728_947_673e-5,
        -2.755_731_435_139_066_3e-7,
        2.087_572_321_298_175e-9,
        -1.135_964_755_778_819_5e-11,
    ];
    let z = y * y;
    let w = z * z;
    let r = z * (C[0] + z * (C[1] + z * C[2])) + w * w * (C[3] + z * (C[4] + z * C[5]));
    let half = 0.5 * z;
    let w = 1.0 - half;
    w + (((1.0 - w) - half) + (z * r - y * rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn compare(x: [f64; 8]) -> usize {
        let (sin, cos) = sin_cos(x);
        for (i, x) in x.into_iter().enumerate() {
            let (s, c) = libm::sincos(x);
            let same = |a: f64, b: f64| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan();
            assert!(same(sin[i], s) && same(cos[i], c), "{x:e}: {:e} {:e} for {s:e} {c:e}", sin[i], cos[i]);
        }
        x.into_iter().filter(|x| reduced(*x).2 != 0).count()
    }

    #[test]
    fn constants_are_those_of_libm() {
        let hex = [HALF_PI_HIGH, HALF_PI_LOW, FRAC_2_PI, S1].map(f64::to_bits);
        assert_eq!(
            hex,
            [0x3ff9_21fb_5440_0000, 0x3dd0_b461_1a62_6331, 0x3fe4_5f30_6dc9_c883, 0xbfc5_5555_5555_5549]
        );
    }

    /// Angles around all multiples of π/8 up to eight turns, on both sides and at all distances.
    #[test]
    fn angles_near_multiples_of_pi_have_the_bits_of_libm() {
        for k in -128..=128 {
            let middle = f64::from(k) * core::f64::consts::FRAC_PI_8;
            for exponent in 1..60 {
                let step = libm::exp2(-f64::from(exponent));
                let factors = [1.0, -1.0, 1.1, -1.1, 1.37, -1.37, 1.9, -1.9];
                compare(factors.map(|factor| middle + factor * step));
            }
        }
    }

    #[test]
    fn many_angles_have_the_bits_of_one_alone() {
        use crate::scalar::Scalar;
        fn check<const N: usize>() {
            let x: [f64; N] = core::array::from_fn(|i| 0.7 * i as f64 - 2.0);
            let (sin, cos) = Scalar::sin_cos_of(&x);
            let alone = x.map(libm::sincos);
            assert_eq!(sin.map(f64::to_bits), alone.map(|(sin, _)| sin.to_bits()));
            assert_eq!(cos.map(f64::to_bits), alone.map(|(_, cos)| cos.to_bits()));
        }
        check::<1>();
        check::<4>();
        check::<7>();
        check::<12>();
    }

    #[test]
    fn angles_of_all_sizes_have_the_bits_of_libm() {
        let (mut word, mut alone, count) = (1_u64, 0, 200_000);
        for _ in 0..count {
            alone += compare(core::array::from_fn(|i| {
                word = word.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let unit = (word >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
                unit * libm::exp2(2.0 * i as f64 - 7.0)
            }));
        }
        assert!(alone < count / 50, "{alone} numbers were computed one by one");
        let special =
            [0.0, -0.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MIN_POSITIVE, 1e300, -1e22];
        compare(special);
        compare(special.map(|x| x / 3.0));
    }
}
