//! Dry friction: the closed form of inverse dynamics, dissipation, limits, and its bits.

use crate::common::Random;
use crate::common::forces::{coulomb, dry};
use leastaction_core::energy::trigonometric::CARTPOLE;
use leastaction_core::forces::{Coulomb, DryFriction, Forces, Viscous};
use leastaction_core::linear::dot;
use leastaction_core::scalar::Real;

/// 10 to a power between ± `decades`.
fn size(random: &mut Random, decades: f64) -> f64 {
    10_f64.powf(random.symmetric(decades))
}

/// Friction of one coordinate. Its numbers range over many orders of magnitude, and c_load is often near 1.
fn any_friction<R: Real>(random: &mut Random, decades: f64) -> DryFriction<R> {
    let away = 10_f64.powf(-6.5 * random.symmetric(1.0).abs());
    DryFriction {
        constant: R::constant(size(random, decades)),
        load: R::constant(1.0 - away),
        smoothing: R::constant(size(random, decades)),
        width: R::constant(size(random, decades)),
    }
}

/// The formula as it is written down.
#[test]
fn the_force_is_the_formula() {
    let (law, mut random) = (coulomb::<f64, 3>(), Random(1));
    for _ in 0..1_000 {
        let [q, v, tau] = [random.array(2.0), random.array(2.0), random.array(4.0)];
        let found = law.force(&q, &v, &tau);
        for i in 0..3 {
            let DryFriction { constant, load, smoothing, width } = law.coordinates[i];
            let grown = load * (tau[i].hypot(smoothing) - smoothing);
            let expected = -(constant + grown) * (v[i] / width).tanh();
            assert!((found[i] - expected).abs() <= 1e-14, "{} instead of {expected}", found[i]);
        }
    }
}

/// v·Q ≤ 0 in every coordinate for any numbers, even after rounding and if squares underflow.
#[test]
fn power_is_never_positive() {
    fn check<R: Real>(decades: f64) {
        let mut random = Random(2);
        let number = |random: &mut Random, decades| random.symmetric(1.0) * size(random, decades);
        for _ in 0..100_000 {
            let law = Coulomb::<R, 1> { coordinates: [any_friction(&mut random, decades)] };
            let [v, tau] = [0; 2].map(|_| R::constant(number(&mut random, decades)));
            let damping = R::constant(size(&mut random, decades));
            let pair = (Viscous { coefficients: [damping] }, law);
            for force in [law.force(&[v], &[v], &[tau]), pair.force(&[v], &[v], &[tau])] {
                assert!(dot(&force, &[v]) <= R::zero(), "{force:?} at {v:?} under {tau:?}: {law:?}");
            }
            let still = law.force(&[v], &[R::zero()], &[tau]);
            assert!(still[0].abs() == R::zero(), "{still:?} at rest");
        }
    }
    check::<f32>(12.0);
    check::<f64>(40.0);
    // τ_s² is 0 in single precision.
    let tiny = DryFriction { constant: 0.0, load: 0.5, smoothing: 1e-30_f32, width: 1.0 };
    let law = Coulomb { coordinates: [tiny] };
    for tau in [0.0, 1e-35, 1e-3] {
        let (force, slope) = (law.force(&[0.0], &[1.0], &[tau]), law.load_derivative(&[0.0], &[1.0], &[tau]));
        assert!(force[0] <= 0.0 && slope[0][0].is_finite(), "{force:?}, {slope:?}");
    }
}

/// τ + Q(v, τ) = total to rounding, for c_load up to 1 − 3·10⁻⁷ and loads of any size.
#[test]
fn the_closed_form_of_inverse_dynamics_is_exact() {
    fn check<R: Real>(decades: f64) {
        let mut random = Random(3);
        for _ in 0..100_000 {
            let friction = any_friction::<R>(&mut random, decades);
            let law = Coulomb { coordinates: [friction] };
            let v = R::constant(random.symmetric(4.0)) * friction.width;
            let total = R::constant(random.symmetric(1.0) * size(&mut random, decades));
            let [tau] = law.control(&[v], &[v], &[total]);
            let [force] = law.force(&[v], &[v], &[tau]);
            let terms = tau.abs() + force.abs() + total.abs() + friction.smoothing;
            let left = (tau + force - total).abs();
            assert!(
                left <= R::constant(8.0) * R::EPSILON * terms,
                "{left:?} of {terms:?}: {friction:?}, {v:?}"
            );
        }
    }
    check::<f32>(4.0);
    check::<f64>(4.0);
}

/// The textbook root cancels if k = c_load tanh(v/ε) and σ have opposite signs. The form used here does not: its
/// error against double precision stays at rounding even for k = 1 − 10⁻⁷.
#[test]
fn the_closed_form_does_not_cancel() {
    let single = DryFriction { constant: 0.0, load: 1.0 - 1e-7_f32, smoothing: 0.1, width: 1e-3 };
    let double =
        DryFriction { constant: 0.0, load: f64::from(single.load), smoothing: 0.1_f32.into(), width: 1e-3 };
    let (single, double) = (Coulomb { coordinates: [single] }, Coulomb { coordinates: [double] });
    for total in [-0.01_f32, -0.3, -1.0, -20.0, -3e4] {
        let [found] = single.control(&[0.0], &[1.0], &[total]);
        let [expected] = double.control(&[0.0], &[1.0], &[total.into()]);
        let error = (f64::from(found) / expected - 1.0).abs();
        assert!(error <= 4.0 * f64::from(f32::EPSILON), "{found} instead of {expected}");
    }
}

/// The start of inverse dynamics is its solution if only one law depends on the load, whatever the order of the laws.
#[test]
fn the_start_of_inverse_dynamics_is_exact_for_one_law_that_sees_the_load() {
    fn check<F: Forces<f64, 3>>(law: F) {
        let mut random = Random(4);
        for _ in 0..1_000 {
            let [q, v, total] = [random.array(2.0), random.array(2.0), random.array(9.0)];
            let tau = law.control(&q, &v, &total);
            let force = law.force(&q, &v, &tau);
            for i in 0..3 {
                let left = (tau[i] + force[i] - total[i]).abs();
                assert!(left <= 1e-14 * (1.0 + tau[i].abs()), "{left:e}: {tau:?}, {force:?}, {total:?}");
            }
        }
    }
    let (viscous, friction) = dry::<f64, 3>();
    let more = Viscous { coefficients: [0.7, 0.2, 0.4] };
    check(friction);
    check((viscous, friction));
    check((friction, viscous));
    check((viscous, (friction, more)));
    check(((friction, more), &viscous));
}

/// A change of velocity is taken in full unless it reverses a velocity from beyond half the width; such a change ends
/// at 0.
#[test]
fn a_change_of_sign_ends_at_rest() {
    let law = Coulomb { coordinates: [DryFriction { constant: 0.4, width: 0.2, ..DryFriction::none() }; 2] };
    let part = |v: [f64; 2], dv: [f64; 2]| law.trusted_part(&v, &dv);
    for (v, dv) in
        [(0.3, -0.2), (0.3, 0.9), (-0.3, 0.29), (0.09, -5.0), (-0.09, 5.0), (0.0, -5.0), (0.3, 0.0)]
    {
        assert_eq!(part([v, 1.0], [dv, 0.0]), 1.0, "{v}, {dv}");
    }
    assert_eq!(part([0.3, 1.0], [-1.2, 0.0]), 0.25);
    assert_eq!(part([-0.5, 1.0], [1.0, -10.0]), 0.1, "the smaller of two");
    let both = (Viscous { coefficients: [1.0; 2] }, &law);
    assert_eq!(both.trusted_part(&[0.3, 1.0], &[-1.2, 0.0]), 0.25);
    assert_eq!(Coulomb::<f64, 2>::none().trusted_part(&[9.0; 2], &[-18.0; 2]), 1.0, "no friction");
    assert_eq!(Viscous { coefficients: [1.0; 2] }.trusted_part(&[9.0; 2], &[-18.0; 2]), 1.0);
}

/// a = h c (M⁻¹)_ii/(2ε): the factor (1 − a)/(1 + a) of a midpoint step about rest.
#[test]
fn stiffness_is_that_of_the_step() {
    let law = coulomb::<f64, 2>();
    let mass = CARTPOLE.mass_matrix(&[0.0, 0.6]);
    let determinant = mass[0][0] * mass[1][1] - mass[0][1] * mass[1][0];
    let inverse = [mass[1][1] / determinant, mass[0][0] / determinant];
    let found = law.stiffness(0.02, mass, &[0.0, 3.0]).unwrap();
    let level = |i: usize, tau: f64| -law.force(&[0.0; 2], &[1e3; 2], &[tau; 2])[i];
    for (i, tau) in [0.0, 3.0].into_iter().enumerate() {
        let expected = 0.02 * level(i, tau) * inverse[i] / (2.0 * law.coordinates[i].width);
        assert!((found[i] / expected - 1.0).abs() < 1e-13, "{} instead of {expected}", found[i]);
    }
    assert!(law.stiffness(0.02, [[0.0; 2]; 2], &[0.0; 2]).is_err());
}

/// Equal bits on every target.
#[test]
fn the_force_has_these_bits() {
    let law = coulomb::<f32, 3>();
    let points: [([f32; 3], [f32; 3]); 5] = [
        ([0.25, -0.5, 1.0], [0.0, 0.0, 0.0]),
        ([1e-3, -1e-3, 1e-6], [0.5, -2.0, 8.0]),
        ([-0.4, 0.3, -2.5], [-1.5, 0.25, 3.0]),
        ([30.0, -30.0, 4.0], [1e4, -1e-4, 0.0625]),
        ([0.0, -0.0, 0.1], [1.0, 1.0, -0.3]),
    ];
    let bits = points.map(|(v, tau)| law.force(&v, &v, &tau).map(f32::to_bits));
    let golden = [
        [0xbe1b_090e, 0x3eab_8758, 0xbf14_13b9],
        [0xba49_2042, 0x3ae7_e452, 0xb6c2_4df5],
        [0x3ec9_96b1, 0xbe75_16da, 0x3fde_7724],
        [0xc51c_4267, 0x3ef0_a3d7, 0xbf24_48ac],
        [0x8000_0000, 0x0000_0000, 0xbdcd_6a67],
    ];
    assert_eq!(bits, golden, "{bits:#010x?}");
}
