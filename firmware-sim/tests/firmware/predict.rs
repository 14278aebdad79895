//! The model stepped beside the plant, without feedback.

use crate::common::Perturbed;
use leastaction_core::energy::trigonometric::{ACROBOT, CARTPOLE, PENDULUM};
use leastaction_core::forces::{System, Viscous};
use leastaction_firmware_sim::observer::Order;
use leastaction_firmware_sim::scenario::{Predict, predict};

#[test]
fn the_exact_model_stays_close_for_five_seconds() {
    for seed in 0..10 {
        let (mut a, mut b, mut c) = (Predict::pendulum(), Predict::cartpole(), Predict::acrobot());
        (a.setup.seed, b.setup.seed, c.setup.seed) = (seed, seed, seed);
        let (p, q, r) =
            (System::conservative(PENDULUM), System::conservative(CARTPOLE), System::conservative(ACROBOT));
        let a = predict(&p, &p, &a, |_| {}).unwrap();
        let b = predict(&q, &q, &b, |_| {}).unwrap();
        let c = predict(&r, &r, &c, |_| {}).unwrap();
        for (success, max_error) in
            [(a.success, a.max_error[0]), (b.success, b.max_error[1]), (c.success, c.max_error[1])]
        {
            assert!(success && max_error < 2e-3, "seed {seed}: {a:?} {b:?} {c:?}");
        }
    }
}

#[test]
fn damping_is_predicted_too() {
    let damped = System { lagrangian: CARTPOLE, forces: Viscous { coefficients: [0.3, 0.02] } };
    let summary = predict(&damped, &damped, &Predict::cartpole(), |_| {}).unwrap();
    assert!(summary.max_error[1] < 1e-3, "{summary:?}");
}

/// Largest error of the pendulum over 2 s at order 2.
fn order_two_error(tick: f32) -> f32 {
    let system = System::conservative(PENDULUM);
    let mut config = Predict::pendulum();
    (config.setup.tick, config.setup.seconds, config.setup.observer.order) = (tick, 2.0, Order::Two);
    (config.setup.start.q_spread, config.excitation.amplitude) = ([0.0], [0.0]);
    config.setup.start.q = [1.0];
    predict(&system, &system, &config, |_| {}).unwrap().max_error[0]
}

#[test]
fn order_two_has_order_two() {
    let slope = (order_two_error(0.04) / order_two_error(0.02)).log2();
    assert!((slope - 2.0).abs() < 0.2, "{slope}");
}

#[test]
fn a_wrong_model_drifts_away() {
    let model = Perturbed::new(&CARTPOLE, 0.05, 1);
    let summary =
        predict(&System::conservative(CARTPOLE), &model.system(), &Predict::cartpole(), |_| {}).unwrap();
    assert!(!summary.success && summary.max_error[1] > 0.05, "{summary:?}");
}

#[test]
fn no_velocity_is_needed() {
    let system = System::conservative(CARTPOLE);
    let mut first = None;
    predict(&system, &system, &Predict::cartpole(), |tick| {
        if tick.index == 1 {
            first = Some(*tick);
        }
    })
    .unwrap();
    let tick = first.unwrap();
    assert_eq!(tick.error, [0.0; 2], "the second position is given");
    assert!((tick.v_estimate[1] - tick.v[1]).abs() < 1e-3, "{tick:?}");
}
