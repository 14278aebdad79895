//! Fits of known mechanisms: what is found, and what cannot be seen.

mod common;
mod dynamics;
mod exact;
mod excitation;
mod panda;
mod samples;
mod simulated;

use common::tree;
use leastaction_data::Rows;
use leastaction_learning::torque::Samples;
use leastaction_learning::torque::fit::{
    Arm, Bodies, JOINT, JointNumber, JointNumbers, Learned, SOFTNESS, Shown, alone, fit, fit_by_folds,
    mean_nmse, squared_errors, variances,
};
use leastaction_learning::torque::linear::{BaseParameters, Design, Terms};
use leastaction_models::tree::{INERTIAL, Inertia, LogCholesky, Tree};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const JOINTS: [[f64; 7]; 4] = [
    [0.1, 0.3, 0.5, 0.1, 0.1, 0.2, SOFTNESS],
    [0.2, 0.2, 0.4, 0.05, 0.2, -0.1, SOFTNESS],
    [0.3, 0.1, 0.3, 0.0, 0.3, 0.0, SOFTNESS],
    [0.4, 0.4, 0.2, 0.15, 0.15, 0.3, SOFTNESS],
];

/// A joint whose friction is alike in both directions.
fn joint(numbers: [f64; 7]) -> JointNumbers {
    let [rotor, viscous, coulomb, load, width, offset, smoothing] = numbers;
    JointNumbers { rotor, viscous, coulomb, load, width, offset, smoothing, ..JointNumbers::default() }
}

fn arm(tree: Tree) -> Arm {
    Arm { tree, joints: JOINTS.map(joint).into() }
}

/// Random states under the torques of an arm, with noise.
fn samples(arm: &Arm, count: usize, noise: f64, seed: u64) -> Samples {
    let mut random = Pcg64::seed_from_u64(seed);
    let n = arm.joints.len();
    let mut rows = |size: f64| {
        Rows::from_flat(n, (0..n * count).map(|_| random.random_range(-size..size)).collect()).unwrap()
    };
    let (q, v, a, noise) = (rows(2.5), rows(1.5), rows(5.0), rows(noise.max(1e-300)));
    let mut samples = Samples { t: (0..count).map(|k| k as f64).collect(), q, v, a, tau: noise.clone() };
    let torques = arm.torques(&samples).iter().zip(noise.as_flat()).map(|(x, noise)| x + noise).collect();
    samples.tau = Rows::from_flat(n, torques).unwrap();
    samples
}

/// A tree whose bodies are off by a fifth, to serve as a prior.
fn near(tree: &Tree) -> Tree {
    let number = |(k, x): (usize, &f64)| x * (1.0 + 0.2 * ((k / INERTIAL) as f64).cos());
    tree.with_parameters(&tree.parameters().iter().enumerate().map(number).collect::<Vec<_>>())
}

#[test]
fn an_arm_is_found_again_with_its_friction() {
    let truth = arm(tree(3));
    let (train, test) = (samples(&truth, 300, 1e-3, 1), samples(&truth, 100, 0.0, 2));
    let found = fit(&near(&truth.tree), &train, &Learned::default(), 1e-3).unwrap();
    let error = mean_nmse(&squared_errors(&found.arm.torques(&test), &test), &variances(&test));
    assert!(error < 1e-6, "{error}");
    for (found, truth) in found.arm.joints.iter().zip(&truth.joints) {
        for (found, truth) in found.array().iter().zip(truth.array()).skip(1) {
            assert!((found - truth).abs() < 0.01, "{found} {truth}");
        }
    }
    let base = BaseParameters::of(&truth.tree);
    let pairs = [&found.arm.tree, &truth.tree].map(|tree| base.values(&tree.parameters()));
    pairs[0].iter().zip(&pairs[1]).for_each(|(a, b)| assert!((a - b).abs() < 0.01, "{a} {b}"));
    assert!(found.arm.tree.bodies().iter().all(|body| body.inertia.consistency() > 0.0));
    // The smoothing is known.
    assert_eq!(found.parameters, 5 * INERTIAL + 4 * (JOINT - 3));
    // The rank counts all numbers of a joint but the rotor, which may be part of a base parameter already.
    assert_eq!(found.rank, base.count() + 4 * (JOINT - 4));
}

#[test]
fn known_friction_stays_and_the_rest_is_found() {
    let mut truth = arm(tree(3));
    truth.joints.iter_mut().zip([0.1, 0.5, 1.0, 2.0]).for_each(|(joint, s)| joint.smoothing = s);
    let mut held = vec![
        (0, JointNumber::Coulomb, 0.5),
        (1, JointNumber::Load, 0.05),
        (2, JointNumber::Width, 0.3),
        (3, JointNumber::Viscous, 0.4),
    ];
    let smoothing = truth.joints.iter().enumerate();
    held.extend(smoothing.map(|(i, joint)| (i, JointNumber::Smoothing, joint.smoothing)));
    let (train, test) = (samples(&truth, 300, 1e-3, 1), samples(&truth, 100, 0.0, 2));
    let error = |held: &[(usize, JointNumber, f64)]| {
        let learned = Learned { held: held.to_vec(), ..Learned::default() };
        let found = fit(&near(&truth.tree), &train, &learned, 1e-3).unwrap();
        for (joint, number, value) in held {
            assert_eq!(found.arm.joints[*joint].array()[*number as usize], *value);
        }
        let errors = squared_errors(&found.arm.torques(&test), &test);
        (mean_nmse(&errors, &variances(&test)), found)
    };
    let (known, found) = error(&held);
    assert!(known < 1e-6, "{known}");
    assert_eq!(found.parameters, 5 * INERTIAL + 4 * (JOINT - 3) - 4);
    for (found, truth) in found.arm.joints.iter().zip(&truth.joints) {
        for (found, truth) in found.array().iter().zip(truth.array()).skip(1) {
            assert!((found - truth).abs() < 0.01, "{found} {truth}");
        }
    }
    // With the default smoothing instead of the true one, the fit assumes a different friction law, so its error is larger.
    let (usual, _) = error(&held[..4]);
    assert!(usual > 2.0 * known, "{usual} {known}");
    // A smoothing is learned as well as the rest if friction grows with the load.
    let learned = Learned { smoothing: [1e-3, 1e2], ..Learned::default() };
    let found = fit(&near(&truth.tree), &train, &learned, 1e-3).unwrap();
    assert!((found.arm.joints[3].smoothing - 2.0).abs() < 0.1, "{:?}", found.arm.joints[3]);
}

#[test]
fn what_the_samples_do_not_show_stays_at_the_prior() {
    let (truth, prior) = (arm(tree(4)), near(&tree(4)));
    let mut train = samples(&truth, 200, 1e-3, 1);
    let flat = |x: f64| Rows::from_flat(4, vec![x; 800]).unwrap();
    (train.q, train.v, train.a) = (flat(0.3), flat(0.0), flat(0.0));
    let noisy = truth.torques(&train).into_iter().enumerate().map(|(k, x)| x + 0.1 * (k as f64).sin());
    train.tau = Rows::from_flat(4, noisy.collect()).unwrap();
    let found = fit(&prior, &train, &Learned::default(), 1.0).unwrap();
    // One posture at rest: four torques, which the offsets explain.
    assert!(found.rank <= 4, "{}", found.rank);
    let (a, b) = (found.arm.tree.bodies(), prior.bodies());
    for (found, prior) in a.iter().zip(b) {
        let theta = LogCholesky::around(&prior.inertia).unwrap().numbers(&found.inertia).unwrap();
        assert!(theta.iter().all(|x| x.abs() < 1e-3), "{theta:?}");
    }
}

#[test]
fn bodies_stay_consistent_where_least_squares_is_not() {
    let truth = arm(tree(5));
    let train = samples(&truth, 40, 2.0, 1);
    let free =
        fit(&truth.tree, &train, &Learned { bodies: Bodies::Free, ..Learned::default() }, 1e-6).unwrap();
    let consistent = fit(&truth.tree, &train, &Learned::default(), 1e-3).unwrap();
    let least = |arm: &Arm| arm.tree.bodies().iter().all(|body| body.inertia.consistency() > 0.0);
    assert!(!least(&free.arm) && least(&consistent.arm));
}

#[test]
fn folds_choose_a_strong_prior_that_is_right_and_a_weak_one_where_it_is_wrong() {
    let truth = arm(tree(6));
    let train = samples(&truth, 60, 1.0, 1);
    let folds: Vec<usize> = (0..60).map(|k| k / 12).collect();
    let strengths = [1e4, 1e2, 1.0, 1e-2];
    let choose =
        |prior: &Tree| fit_by_folds(prior, &train, &Learned::default(), (&strengths, &folds)).unwrap();
    let (right, tried) = choose(&truth.tree);
    assert_eq!((right.prior, tried.len()), (1e4, 4));
    let wrong =
        truth.tree.with_parameters(&truth.tree.parameters().iter().map(|x| 4.0 * x).collect::<Vec<_>>());
    assert!(choose(&wrong).0.prior < 1e4);
}

#[test]
fn least_squares_finds_base_parameters_and_counts_what_is_not_seen() {
    let mut truth = arm(tree(7));
    truth.joints =
        vec![JointNumbers { width: 0.05, viscous: 0.3, coulomb: 0.2, ..JointNumbers::default() }; 4];
    let rotors = truth.tree.rotors.clone();
    truth.joints.iter_mut().zip(rotors).for_each(|(joint, rotor)| joint.rotor = rotor);
    let train = samples(&truth, 200, 0.0, 1);
    let terms = Terms { rotors: true, viscous: true, coulomb: Some(0.05), offsets: true };
    let design = Design::new(&truth.tree, &train, &terms);
    let found = design.solve().unwrap();
    let base = BaseParameters::of(&truth.tree);
    assert_eq!(found.rank, base.count() + 3 * 4);
    assert!(found.condition.is_finite() && found.condition > 1.0);
    let parameters = truth.tree.parameter_count();
    let (values, expected) =
        (base.values(&found.numbers[..parameters]), base.values(&truth.tree.parameters()));
    values.iter().zip(&expected).for_each(|(a, b)| assert!((a - b).abs() < 1e-8, "{a} {b}"));
    assert!(
        (found.numbers[parameters] - 0.3).abs() < 1e-9 && (found.numbers[parameters + 4] - 0.2).abs() < 1e-9
    );
    // Scales of rows do not matter if the fit is exact.
    let again = Design::new(&truth.tree, &train, &terms).over(&[1.0, 2.0, 3.0, 4.0]).solve().unwrap();
    base.values(&again.numbers[..parameters])
        .iter()
        .zip(&values)
        .for_each(|(a, b)| assert!((a - b).abs() < 1e-8));
}

#[test]
fn what_cannot_be_fitted_is_said() {
    let truth = arm(tree(8));
    let train = samples(&truth, 10, 0.0, 1);
    let mut parameters = truth.tree.parameters();
    parameters[INERTIAL] = -1.0;
    let error = fit(&truth.tree.with_parameters(&parameters), &train, &Learned::default(), 1.0).unwrap_err();
    assert!(error.to_string().contains("link1"), "{error}");
    let two = Samples { q: Rows::from_flat(2, vec![0.0; 20]).unwrap(), ..train };
    let error = fit(&truth.tree, &two, &Learned::default(), 1.0).unwrap_err();
    assert!(error.to_string().contains("2 coordinates, and an arm of 4"), "{error}");
}

proptest! {
    #[test]
    fn log_cholesky_numbers_go_there_and_back(
        theta in proptest::array::uniform10(-1.5..1.5), other in proptest::array::uniform10(-0.5..0.5),
    ) {
        let start = Inertia::of_centre(2.0, nalgebra::Vector3::new(0.1, 0.2, -0.1), nalgebra::Matrix3::identity() * 0.1);
        let prior = LogCholesky::around(&start).unwrap().inertia(&other);
        let chart = LogCholesky::around(&prior).unwrap();
        let inertia = chart.inertia(&theta);
        prop_assert!(inertia.consistency() > 0.0);
        for (a, b) in chart.numbers(&inertia).unwrap().iter().zip(&theta) {
            prop_assert!((a - b).abs() < 1e-6, "{a} {b}");
        }
        for (a, b) in chart.inertia(&[0.0; 10]).0.iter().zip(&prior.0) {
            prop_assert!((a - b).abs() < 1e-12);
        }
        let slopes = chart.slopes(&theta);
        for k in 0..INERTIAL {
            let at = |h: f64| { let mut moved = theta; moved[k] += h; chart.inertia(&moved).0 };
            let (ahead, behind) = (at(1e-5), at(-1e-5));
            for j in 0..INERTIAL {
                let difference = (ahead[j] - behind[j]) / 2e-5;
                prop_assert!((difference - slopes[k][j]).abs() < 1e-6 * (1.0 + difference.abs()), "{k} {j}");
            }
        }
    }

    #[test]
    fn friction_solves_its_equation_and_has_its_slopes(
        bodies in -30.0..30.0, v in -2.0..2.0, a in -5.0..5.0, load in 0.0..0.9, width in 0.05..0.5,
        smoothing in 0.05..2.0, viscous_asymmetry in -1.0..1.0, asymmetry in -1.0..1.0,
    ) {
        let joint = JointNumbers {
            rotor: 0.2, viscous: 0.3, coulomb: 0.4, load, width, offset: 0.6, smoothing, viscous_asymmetry, asymmetry,
        };
        let tau = joint.torque(bodies, v, a) - joint.offset;
        let size = tau.hypot(smoothing) - smoothing;
        let t = (v / width).tanh();
        let friction = 0.3 * (1.0 + viscous_asymmetry * t) * v + (0.4 * (1.0 + asymmetry * t) + load * size) * t;
        prop_assert!((tau - (bodies + 0.2 * a + friction)).abs() < 1e-9 * (1.0 + tau.abs()), "{tau}");
        let (value, gain, slopes) = joint.slopes(bodies, v, a);
        prop_assert!((value - tau - joint.offset).abs() < 1e-12 * (1.0 + tau.abs()));
        let h = 1e-6;
        let difference = (joint.torque(bodies + h, v, a) - joint.torque(bodies - h, v, a)) / (2.0 * h);
        prop_assert!((difference - gain).abs() < 1e-5 * (1.0 + gain.abs()), "{difference} {gain}");
        for k in 0..JOINT {
            let at = |h: f64| { let mut moved = joint.array(); moved[k] += h; JointNumbers::of_array(moved).torque(bodies, v, a) };
            let difference = (at(h) - at(-h)) / (2.0 * h);
            prop_assert!((difference - slopes[k]).abs() < 1e-4 * (1.0 + slopes[k].abs()), "{k} {difference} {}", slopes[k]);
        }
    }
}

/// Friction that differs by direction is found again, and without it the fit is worse.
#[test]
fn friction_by_direction_is_found_again() {
    let mut truth = arm(tree(3));
    let asymmetries = [[0.4, -0.3], [-0.2, 0.5], [0.0, 0.25], [0.6, 0.1]];
    for (joint, [beta, delta]) in truth.joints.iter_mut().zip(asymmetries) {
        (joint.viscous_asymmetry, joint.asymmetry) = (beta, delta);
    }
    let (train, test) = (samples(&truth, 600, 1e-3, 1), samples(&truth, 100, 0.0, 2));
    let found = |asymmetries: [bool; 2]| {
        let learned = Learned { asymmetries, ..Learned::default() };
        let arm = fit(&near(&truth.tree), &train, &learned, 1e-3).unwrap().arm;
        (mean_nmse(&squared_errors(&arm.torques(&test), &test), &variances(&test)), arm.joints)
    };
    let ((error, joints), (without, _)) = (found([true; 2]), found([false; 2]));
    assert!(error < 1e-6 && without > 30.0 * error, "{error} {without}");
    for (joint, [beta, delta]) in joints.iter().zip(asymmetries) {
        assert!((joint.viscous_asymmetry - beta).abs() < 0.02, "{joint:?}");
        assert!((joint.asymmetry - delta).abs() < 0.02, "{joint:?}");
    }
}

#[test]
fn what_samples_say_alone_has_errors_of_its_size_and_leaves_the_prior_out() {
    let truth = arm(tree(8));
    let train = samples(&truth, 400, 0.3, 1);
    let learned = Learned::default();
    let found = alone(&near(&truth.tree), &train, &learned).unwrap();
    let other = alone(&near(&near(&truth.tree)), &train, &learned).unwrap();
    let numbers = found.of_model(&truth.tree.parameters(), &truth.joints);
    assert_eq!(numbers.len(), found.base.count() + 4 * (JOINT - 4));
    for ((found, other), truth) in found.estimates.iter().zip(&other.estimates).zip(&numbers) {
        if let Shown::Within(error) = found.shown {
            assert!((found.value - truth).abs() < 5.0 * error && error < 0.3, "{found:?} {truth}");
            assert!((found.value - other.value).abs() < 0.02 * error, "{found:?} {other:?}");
        }
    }
    let shown = found.estimates.iter().filter(|of| matches!(of.shown, Shown::Within(_))).count();
    assert!(shown + 4 > numbers.len() && found.hidden == 0, "{shown} of {}", numbers.len());
}

#[test]
fn of_known_bodies_nothing_is_said_and_what_was_never_seen_is_hidden() {
    let truth = arm(tree(9));
    let mut train = samples(&truth, 200, 0.1, 1);
    let learned = Learned { known: vec![0, 1, 2, 3], rotors: false, ..Learned::default() };
    let found = alone(&truth.tree, &train, &learned).unwrap();
    assert!(found.base.independent.iter().all(|column| (4 * INERTIAL..5 * INERTIAL).contains(column)));
    // The load hangs on its own joint and moves with all joints: all its numbers are seen, except those that need the second coordinate to
    // turn alone.
    assert_eq!((found.base.count(), found.hidden), (INERTIAL, 0));
    let still = |rows: &Rows| Rows::from_flat(4, vec![0.0; rows.as_flat().len()]).unwrap();
    (train.v, train.a) = (still(&train.v), still(&train.a));
    let at_rest = alone(&truth.tree, &train, &learned).unwrap();
    assert!(at_rest.hidden >= INERTIAL - 4, "{}", at_rest.hidden);
    assert!(at_rest.estimates.iter().any(|of| of.shown == Shown::Together));
}
