//! Friction by direction: its limits, dissipation, and what both laws of it have in common.

use crate::common::Random;
use crate::common::forces::{directional, sticking};
use crate::forces::check_inverse_under;
use leastaction_core::energy::trigonometric::CARTPOLE;
use leastaction_core::forces::{
    Coulomb, Directional, DirectionalFriction, DryFriction, Forces, Sticking, StickingFriction,
};
use leastaction_core::linear::dot;

/// Far from rest the friction is b⁺v + c⁺ forwards and b⁻v − c⁻ backwards.
#[test]
fn each_direction_has_its_own_numbers() {
    let law = directional::<f64, 3>();
    for (i, of) in law.coordinates.iter().enumerate() {
        for (v, sign) in [(9.0, 1.0), (-9.0, -1.0)] {
            let b = of.viscous * (1.0 + sign * of.viscous_asymmetry);
            let c = sign * of.constant * (1.0 + sign * of.asymmetry);
            let mut all = [0.0; 3];
            all[i] = v;
            let found = law.force(&[0.0; 3], &all, &[0.0; 3])[i];
            assert!((found + b * v + c).abs() < 1e-6, "{found} instead of {}", -(b * v + c));
        }
    }
}

/// The smooth law of friction that sticks is the same far from rest, and grows with the load like [`Coulomb`].
#[test]
fn sticking_friction_has_a_smooth_law_of_the_same_levels() {
    let law = sticking::<f64, 3>();
    for (v, forward) in [(9.0, true), (-9.0, false)] {
        let coordinates = law.coordinates.map(|of| {
            let StickingFriction { constant, asymmetry, load, smoothing, width, .. } = of;
            let sign = if forward { 1.0 } else { -1.0 };
            DryFriction { constant: constant * (1.0 + sign * asymmetry), load, smoothing, width }
        });
        let tau = [0.7, -2.0, 0.1];
        let [found, expected] =
            [law.force(&[0.0; 3], &[v; 3], &tau), Coulomb { coordinates }.force(&[0.0; 3], &[v; 3], &tau)];
        assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-6), "{found:?}, {expected:?}");
        let grips = law.grips(&tau).map(|grip| if forward { -grip.forward } else { grip.backward });
        assert!(grips.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-6), "{grips:?}, {expected:?}");
    }
    assert_eq!(law.single_valued(&[1.0; 3], &[2.0; 3], &[3.0; 3]), [0.0; 3]);
    let (in_q, in_v) = law.single_valued_derivatives(&[1.0; 3], &[2.0; 3], &[3.0; 3]);
    assert_eq!((in_q, in_v), ([[0.0; 3]; 3], [[0.0; 3]; 3]));
}

/// Both laws only take energy away, whatever their numbers and the direction.
#[test]
fn power_is_never_positive() {
    let (mut random, mut sign) = (Random(4), Random(5));
    let mut size = || 10_f64.powf(random.symmetric(3.0));
    for _ in 0..10_000 {
        let [viscous, constant, width, v]: [f64; 4] = core::array::from_fn(|_| size());
        let [viscous_asymmetry, asymmetry] = [sign.symmetric(1.0), sign.symmetric(1.0)];
        let of = DirectionalFriction { viscous, viscous_asymmetry, constant, asymmetry, width };
        let by_direction = Directional { coordinates: [of] };
        let at_rest = StickingFriction { constant, asymmetry, width, ..StickingFriction::none() };
        let at_rest = Sticking { coordinates: [at_rest] };
        for v in [v, -v] {
            let power = [by_direction.force(&[0.0], &[v], &[0.0]), at_rest.force(&[0.0], &[v], &[0.0])];
            assert!(power.iter().all(|force| dot(force, &[v]) <= 0.0), "{power:?} at {v}");
        }
    }
}

#[test]
fn a_command_is_found_from_an_acceleration() {
    check_inverse_under(&CARTPOLE, directional());
    check_inverse_under(&CARTPOLE, sticking());
    check_inverse_under(&CARTPOLE, (directional(), sticking()));
}
