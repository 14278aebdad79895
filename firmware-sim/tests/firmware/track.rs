//! Tracking a reference with every coordinate actuated.

use crate::common::Perturbed;
use leastaction_core::energy::trigonometric::{ACROBOT, CARTPOLE, PENDULUM, Trigonometric};
use leastaction_core::forces::System;
use leastaction_firmware_sim::control::{Reference, Trajectory};
use leastaction_firmware_sim::scenario::{TrackConfig, track};

/// Largest errors over 20 seeds against the exact plant.
fn worst<const N: usize>(exact: Trigonometric<'static, N>, wrong: f64, config: &TrackConfig<N>) -> [f32; N] {
    let plant = System::conservative(exact);
    let mut worst = [0.0_f32; N];
    for seed in 0..20 {
        let model = Perturbed::new(&exact, wrong, seed);
        let mut config = *config;
        config.setup.seed = seed;
        let summary = track(&plant, &model.system(), &config, |_| {}).unwrap();
        assert_eq!(summary.incidents.model, 0);
        worst = core::array::from_fn(|i| worst[i].max(summary.max_error[i]));
    }
    worst
}

fn assert_below<const N: usize>(errors: [f32; N], bounds: [f32; N]) {
    assert!(errors.iter().zip(bounds).all(|(error, bound)| *error < bound), "{errors:?} {bounds:?}");
}

#[test]
fn the_exact_model_follows_within_noise() {
    assert_below(worst(PENDULUM, 0.0, &TrackConfig::pendulum()), [5e-3]);
    assert_below(worst(CARTPOLE, 0.0, &TrackConfig::cartpole()), [2e-3, 5e-3]);
    assert_below(worst(ACROBOT, 0.0, &TrackConfig::acrobot()), [5e-3, 5e-3]);
}

#[test]
fn ideal_devices_leave_the_error_of_the_hold() {
    let mut config = TrackConfig::acrobot();
    config.setup = config.setup.perfect();
    assert_below(worst(ACROBOT, 0.0, &config), [1e-4, 1e-4]);
}

#[test]
fn a_model_five_percent_wrong_follows_within_tolerance() {
    assert_below(worst(PENDULUM, 0.05, &TrackConfig::pendulum()), [0.05]);
    assert_below(worst(CARTPOLE, 0.05, &TrackConfig::cartpole()), [0.05, 0.05]);
    assert_below(worst(ACROBOT, 0.05, &TrackConfig::acrobot()), [0.05, 0.05]);
}

#[test]
fn feed_forward_does_the_work() {
    let plant = System::conservative(ACROBOT);
    let weightless = System::conservative(Trigonometric { potential: &[], ..ACROBOT });
    let config = TrackConfig::acrobot();
    let blind = track(&plant, &weightless, &config, |_| {}).unwrap();
    let seeing = track(&plant, &plant, &config, |_| {}).unwrap();
    assert!(blind.rms_error[0] > 20.0 * seeing.rms_error[0], "{blind:?} {seeing:?}");
}

/// A drive whose force lags by two ticks is followed nearly as well as one without a lag if the firmware knows of it.
#[test]
fn a_lag_that_is_known_does_little() {
    let plant = System::conservative(PENDULUM);
    let error = |lag: f32, known: f32| {
        let mut config = TrackConfig::<1>::pendulum();
        (config.setup.devices.actuator.lag, config.setup.observer.lag) = (lag, known);
        track(&plant, &plant, &config, |_| {}).unwrap().rms_error[0]
    };
    let [none, known, unknown] = [error(0.0, 0.0), error(2.0, 2.0), error(2.0, 0.0)];
    assert!(known < 2.0 * none && unknown > 5.0 * known, "{none} {known} {unknown}");
}

#[test]
fn velocity_and_acceleration_are_the_derivatives() {
    let from = [-0.5, 3.0];
    let mut reference = Reference::there_and_back(-0.5, from, [0.5, 0.2], [0.4, 0.25]);
    check_derivatives(&reference);
    let rest = Reference { begin: 1.0, ..reference }.at(0.9);
    let near = |a: [f32; 2], b: [f32; 2]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
    assert!(near(rest.q, from) && rest.v == [0.0; 2] && rest.a == [0.0; 2], "{rest:?}");
    reference.waves[0] = [[0.2, -0.1], [0.0, 0.1], [0.05, 0.0], [0.0; 2], [0.02, 0.03]];
    (reference.begin, reference.ramp) = (0.1, 1.5);
    check_derivatives(&reference);
    let begins = reference.at(0.1);
    assert!(near(begins.v, [0.0; 2]) && near(begins.a, [0.0; 2]), "{begins:?}");
}

fn check_derivatives(reference: &Reference<2>) {
    let e = 4e-3;
    for t in [0.0, 0.3, 1.7, 3.9] {
        let (before, now, after) = (reference.at(t - e), reference.at(t), reference.at(t + e));
        for i in 0..2 {
            let v = (after.q[i] - before.q[i]) / (2.0 * e);
            let a = (after.v[i] - before.v[i]) / (2.0 * e);
            assert!((v - now.v[i]).abs() < 1e-3 && (a - now.a[i]).abs() < 1e-2, "t = {t}: {now:?}, {v} {a}");
        }
    }
}
