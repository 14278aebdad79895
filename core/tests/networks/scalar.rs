//! Elementary functions against double precision, lanes against scalars, compensated sums.

use crate::common::Random;
use crate::common::shapes::{self, Model};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::scalar::{Compensated, LANES, Lanes, Real, Scalar, all_finite, max_abs, product, sum};
use proptest::prelude::*;

/// The distance between neighbouring f32 at |x|.
fn ulp_f32(x: f64) -> f64 {
    let x = (x.abs() as f32).max(f32::MIN_POSITIVE);
    f64::from(f32::from_bits(x.to_bits() + 1)) - f64::from(x)
}

/// The distance between neighbouring f64 at |x|.
fn ulp_f64(x: f64) -> f64 {
    let x = x.abs().max(f64::MIN_POSITIVE);
    f64::from_bits(x.to_bits() + 1) - x
}

/// Every `stride`th f32 between two positive numbers, with both signs.
fn sweep(from: f32, to: f32, stride: usize) -> impl Iterator<Item = f32> {
    (from.to_bits()..=to.to_bits()).step_by(stride).map(f32::from_bits).flat_map(|x| [x, -x])
}

/// Largest errors over a sweep: in ulp where the result is not small, and absolute.
#[derive(Debug, Default)]
struct Errors {
    ulp: f64,
    absolute: f64,
}

impl Errors {
    fn add(&mut self, found: f32, exact: f64) {
        let error = (f64::from(found) - exact).abs();
        self.absolute = self.absolute.max(error);
        // Next to a multiple of π/2 the reduced angle carries an absolute error.
        if exact.abs() > 0.01 {
            self.ulp = self.ulp.max(error / ulp_f32(exact));
        }
    }
}

#[test]
fn sine_and_cosine_in_f32_are_within_2_ulp() {
    let (mut near, mut far) = (Errors::default(), Errors::default());
    for x in sweep(1e-6, 8192.0, 97) {
        let (sin, cos) = Scalar::sin_cos(x);
        let errors = if x.abs() <= 2.0 * core::f32::consts::PI { &mut near } else { &mut far };
        errors.add(sin, f64::from(x).sin());
        errors.add(cos, f64::from(x).cos());
    }
    println!("sin, cos in f32: |x| ≤ 2π {near:?}, |x| ≤ 8192 {far:?}");
    assert!(near.ulp <= 2.0 && far.ulp <= 2.0, "{near:?} {far:?}");
    assert!(near.absolute <= 1.2e-7 && far.absolute <= 1.2e-7, "{near:?} {far:?}");
}

#[test]
fn sine_keeps_its_relative_accuracy_at_small_angles() {
    for x in sweep(1e-30, 0.1, 10_007) {
        let error = (f64::from(Scalar::sin_cos(x).0) - f64::from(x).sin()).abs();
        assert!(error <= 1.0 * ulp_f32(x.into()), "sin {x:e}");
    }
    assert_eq!(Scalar::sin_cos(0.0_f32), (0.0, 1.0));
}

#[test]
fn angles_without_meaning_give_nan() {
    for x in
        [f32::NAN, -f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 65_537.0, -1e30, f32::from_bits(u32::MAX)]
    {
        let (sin, cos) = Scalar::sin_cos(x);
        assert!(sin.is_nan() && cos.is_nan(), "{x}");
    }
    for x in [f64::NAN, f64::INFINITY] {
        assert!(Scalar::sin_cos(x).0.is_nan());
    }
    let (sin, cos) = Scalar::sin_cos(65_536.0_f32);
    assert!(
        (f64::from(sin) - 65_536.0_f64.sin()).abs() < 1e-6
            && (f64::from(cos) - 65_536.0_f64.cos()).abs() < 1e-6
    );
}

#[test]
fn tanh_in_f32_is_within_3_ulp() {
    let mut worst = 0.0_f64;
    for x in sweep(1e-30, 20.0, 499) {
        let (found, exact) = (Scalar::tanh(x), f64::from(x).tanh());
        worst = worst.max((f64::from(found) - exact).abs() / ulp_f32(exact));
        assert!(found.abs() <= 1.0, "tanh {x} = {found}");
    }
    println!("tanh in f32: {worst:.3} ulp");
    assert!(worst <= 3.0, "{worst} ulp");
}

#[test]
fn tanh_in_f64_is_within_3_ulp_of_libm() {
    let mut worst = 0.0_f64;
    for x in sweep(1e-30, 30.0, 499).map(f64::from).chain((1..400_000).map(|k| f64::from(k) * 5.3e-5 + 1e-9))
    {
        let (found, exact) = (Scalar::tanh(x), libm::tanh(x));
        worst = worst.max((found - exact).abs() / ulp_f64(exact));
        assert!(found.abs() <= 1.0, "tanh {x} = {found}");
    }
    println!("tanh in f64: {worst:.3} ulp from libm");
    assert!(worst <= 3.0, "{worst} ulp");
}

#[test]
fn tanh_at_the_ends() {
    assert_eq!(Scalar::tanh(0.0_f32).to_bits(), 0.0_f32.to_bits());
    assert_eq!(Scalar::tanh(-0.0_f64).to_bits(), (-0.0_f64).to_bits());
    for x in [50.0, f32::MAX, f32::INFINITY] {
        assert_eq!((Scalar::tanh(x), Scalar::tanh(-x)), (1.0, -1.0));
        assert_eq!((Scalar::tanh(f64::from(x)), Scalar::tanh(-f64::from(x))), (1.0, -1.0));
    }
    assert!(Scalar::tanh(f32::NAN).is_nan() && Scalar::tanh(f64::NAN).is_nan());
}

#[test]
fn elementary_functions_outside_their_domains() {
    assert!(
        Scalar::sqrt(-1.0_f32).is_nan() && Scalar::exp(f32::NAN).is_nan() && Scalar::ln_1p(-2.0_f64).is_nan()
    );
    assert_eq!(Scalar::exp(f32::NEG_INFINITY), 0.0);
    assert_eq!(Scalar::max(f32::NAN, 2.0), 2.0);
    assert!(Scalar::max(2.0, f32::NAN).is_nan());
    assert_eq!(Scalar::neg_abs(3.0_f32), -3.0);
    assert_eq!(Real::abs(-0.0_f64).to_bits(), 0);
}

#[test]
fn square_roots_of_lanes_have_the_bits_of_one_after_another() {
    for k in -40..40 {
        let x: [f64; LANES] = core::array::from_fn(|l| (1.3 + l as f64) * 7.1_f64.powi(k));
        assert_eq!(Lanes(x).sqrt().0, x.map(Scalar::sqrt));
    }
    let edges = [0.0, -0.0, f64::INFINITY, f64::MAX, f64::MIN_POSITIVE, 5e-324, -1.0, f64::NAN];
    let (wide, alone) = (Lanes(edges).sqrt().0, edges.map(Scalar::sqrt));
    assert!(wide.iter().zip(&alone).all(|(a, b)| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan()));
}

#[test]
fn norms_are_nan_where_a_number_is_not_finite() {
    assert_eq!(max_abs(&[1.0_f32, -3.0, 2.0]), 3.0);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for i in 0..3 {
            let mut x = [1.0, -2.0, 0.0];
            x[i] = bad;
            assert!(max_abs(&x).is_nan() && !all_finite(&x), "{x:?}");
        }
    }
}

/// A turn, 2π rounded to the type.
const TURN_F32: f32 = core::f32::consts::TAU;
const TURN_F64: f64 = core::f64::consts::TAU;

#[test]
fn wrapped_angles_just_outside_a_turn_stay_below_it() {
    for x in [-1e-9_f32, -f32::MIN_POSITIVE, -1e-45, -0.0, 0.0, TURN_F32, -TURN_F32, TURN_F32.next_down()] {
        assert!((0.0..TURN_F32).contains(&x.wrapped()), "{x:e}: {:e}", x.wrapped());
    }
    for x in [-1e-17_f64, -f64::MIN_POSITIVE, -5e-324, -0.0, 0.0, TURN_F64, -TURN_F64, TURN_F64.next_down()] {
        assert!((0.0..TURN_F64).contains(&x.wrapped()), "{x:e}: {:e}", x.wrapped());
    }
    // The number nearest to 2π − 1e-9 that is still below 2π.
    assert_eq!((-1e-9_f32).wrapped(), TURN_F32.next_down());
    assert_eq!((0.0_f32.wrapped(), 1.0_f64.wrapped()), (0.0, 1.0));
    for x in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert!(x.wrapped().is_nan() && f64::from(x).wrapped().is_nan(), "{x}");
    }
}

/// Distance of two angles the short way round, rad.
fn around(a: f64, b: f64) -> f64 {
    let whole = (a - b).abs() % TURN_F64;
    whole.min(TURN_F64 - whole)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 20_000, ..ProptestConfig::default() })]

    /// Angles of every magnitude; near whole turns too, where the quotient is rounded up.
    #[test]
    fn wrapped_angles_are_in_a_turn(bits in any::<u64>(), turns in -4000_i16..4000, ulps in -3_i8..=3) {
        let near = f32::from(turns) * TURN_F32;
        let near = f32::from_bits(near.to_bits().saturating_add_signed(ulps.into()));
        let random = f32::from_bits(bits as u32);
        for x in [random, near].into_iter().filter(|x| x.is_finite()) {
            let wrapped = x.wrapped();
            prop_assert!((0.0..TURN_F32).contains(&wrapped), "{x:e}: {wrapped:e}");
            if x.abs() < 1e4 {
                // 2π differs from its f32 by 1.7e-7, which counts once per turn.
                let error = around(wrapped.into(), x.into());
                prop_assert!(error <= 1e-6 + 1e-7 * f64::from(x.abs()), "{x:e}: {wrapped:e}, {error:e} off");
            }
        }
        let near = f64::from(turns) * TURN_F64;
        let near = f64::from_bits(near.to_bits().saturating_add_signed(ulps.into()));
        for x in [f64::from_bits(bits), near].into_iter().filter(|x| x.is_finite()) {
            let wrapped = x.wrapped();
            prop_assert!((0.0..TURN_F64).contains(&wrapped), "{x:e}: {wrapped:e}");
            prop_assert_eq!(Lanes([x; LANES]).wrapped(), Lanes([wrapped; LANES]));
        }
    }

    /// An angle for which x − 2π⌊x/2π⌋ in floating point stays within a turn is wrapped to exactly that value.
    #[test]
    fn ordinary_angles_are_wrapped_by_the_plain_formula(x in -100.0_f32..100.0, y in -100.0_f64..100.0) {
        let plain = x - libm::floorf(x / TURN_F32) * TURN_F32;
        prop_assert!(!(0.0..TURN_F32).contains(&plain) || plain.to_bits() == x.wrapped().to_bits(), "{x:e}");
        let plain = y - libm::floor(y / TURN_F64) * TURN_F64;
        prop_assert!(!(0.0..TURN_F64).contains(&plain) || plain.to_bits() == y.wrapped().to_bits(), "{y:e}");
    }
}

/// All numbers that a model returns at (q, v), one after another.
fn evaluated<S: Scalar<Weight = f64>, const N: usize>(model: &Model<N>, q: &[S; N], v: &[S; N]) -> Vec<S> {
    let inertia_network = model.in_f64();
    let (e, g, d, h) = (
        inertia_network.energies(q, v),
        inertia_network.gradient(q, v),
        inertia_network.dynamics(q, v),
        inertia_network.hessian(q, v),
    );
    let vectors = [g.l_q, g.l_v, d.l_q, d.l_v, d.l_vq_v, h.l_q, h.l_v].concat();
    let matrices = [d.mass.concat(), h.l_qq.concat(), h.l_vq.concat(), h.l_vv.concat()].concat();
    [vec![e.kinetic, e.potential], vectors, matrices].concat()
}

/// Eight samples in lanes give, lane by lane, the bits that each sample gives alone.
#[test]
fn lanes_are_bit_equal_to_scalars() {
    fn check<const N: usize>(model: &Model<N>) {
        let mut random = Random(77);
        let samples: [([f64; N], [f64; N]); LANES] =
            core::array::from_fn(|_| (random.array(4.0), random.array(3.0)));
        let q = core::array::from_fn(|i| Lanes(core::array::from_fn(|l| samples[l].0[i])));
        let v = core::array::from_fn(|i| Lanes(core::array::from_fn(|l| samples[l].1[i])));
        let in_lanes = evaluated(model, &q, &v);
        for (l, (q, v)) in samples.iter().enumerate() {
            let lane: Vec<u64> = in_lanes.iter().map(|x| x.0[l].to_bits()).collect();
            let alone: Vec<u64> = evaluated(model, q, v).into_iter().map(f64::to_bits).collect();
            assert_eq!(lane, alone, "lane {l}");
        }
    }
    shapes::for_each_shape!(check);
}

#[test]
fn compensated_sums_keep_what_rounding_takes() {
    let (mut plain, mut sum) = (1.0_f32, Compensated::new(1.0_f32));
    for _ in 0..1_000_000 {
        plain += 1e-8;
        sum = sum.plus(1e-8);
    }
    assert_eq!(plain, 1.0);
    let exact = 1.0 + 1e6 * f64::from(1e-8_f32);
    assert!((f64::from(sum.value()) - exact).abs() <= ulp_f32(1.0) / 2.0);
    assert!((f64::from(sum.value()) + f64::from(sum.carry()) - exact).abs() < 1e-8);
}

/// Sums keep both parts, whichever is the larger.
#[test]
fn compensated_sums_keep_what_a_large_increment_hides() {
    let sum = Compensated::new(1e-3_f32).plus(1e8);
    assert_eq!((sum.value(), sum.carry()), (1e8, 1e-3));
    let back = sum.plus(-1e8);
    assert_eq!((back.value(), back.carry()), (1e-3, 0.0));
}

/// Sums and products of two numbers of 24 digits of any size: the two returned parts are exact, in f64 and, checked
/// by integers, in f32.
#[test]
fn sums_and_products_come_with_what_rounding_took() {
    let mut random = Random(41);
    for _ in 0..20_000 {
        let mut draw = || (random.symmetric(4.0) * 2f64.powi((random.bits() % 12) as i32 - 6)) as f32;
        let (a, b) = (draw(), draw());
        let (high, low) = sum(a, b);
        assert_eq!(high, a + b);
        assert_eq!(f64::from(high) + f64::from(low), f64::from(a) + f64::from(b), "{a:e} + {b:e}");
        let (high, low) = product(a, b);
        assert_eq!(high, a * b);
        assert_eq!(f64::from(high) + f64::from(low), f64::from(a) * f64::from(b), "{a:e} × {b:e}");
    }
    for _ in 0..20_000 {
        let (a, b) = ((random.bits() >> 11) as i128, (random.bits() >> 11) as i128);
        let (high, low) = product(a as f64, b as f64);
        assert_eq!(high as i128 + low as i128, a * b, "{a} × {b}");
        let (high, low) = sum(a as f64 * 2f64.powi(30), b as f64);
        assert_eq!(high as i128 + low as i128, (a << 30) + b, "{a}·2³⁰ + {b}");
    }
}
