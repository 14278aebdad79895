//! Floating, held by the model's gravity alone.

use crate::common::Perturbed;
use leastaction_core::energy::trigonometric::{ACROBOT, PENDULUM};
use leastaction_core::forces::{Coulomb, DryFriction, System};
use leastaction_firmware_sim::scenario::{Floating, GravityConfig, gravity};

/// Largest distance by which the push moved a coordinate, rad.
fn way(floating: &Floating<2>) -> f32 {
    floating.peak.into_iter().fold(0.0, f32::max)
}

#[test]
fn an_exact_model_neither_falls_nor_drifts_and_slows_down_by_the_drag() {
    let plant = System::conservative(ACROBOT);
    for seed in 0..4 {
        let mut config = GravityConfig::acrobot();
        config.setup.seed = seed;
        let (summary, floating) = gravity(&plant, &plant, &config, |_| {}).unwrap();
        assert!(summary.success && summary.incidents.model == 0, "{summary:?}");
        assert!(floating.drift.iter().all(|v| v.abs() < 0.02), "{floating:?}");
        assert!(way(&floating) > 0.02, "{floating:?}");
        // Without drag nothing stops it.
        config.drag = 0.0;
        let (free, floats) = gravity(&plant, &plant, &config, |_| {}).unwrap();
        assert!(!free.success && floats.rest_after.is_none() && way(&floats) > way(&floating), "{floats:?}");
    }
}

#[test]
fn the_push_is_of_the_seed_and_the_firmware_is_not_told() {
    let plant = System::conservative(PENDULUM);
    let config = GravityConfig::pendulum();
    let run = |seed| {
        let mut config = config;
        config.setup.seed = seed;
        gravity(&plant, &plant, &config, |_| {}).unwrap()
    };
    assert_eq!(run(1), run(1));
    assert_ne!(run(1).1.peak, run(2).1.peak);
    let mut quiet = config;
    quiet.setup.push.most = [0.0];
    let (_, floating) = gravity(&plant, &plant, &quiet, |_| {}).unwrap();
    assert!(floating.peak[0] < 0.02 && floating.rest_after == Some(0.0), "{floating:?}");
}

/// Smooth dry friction bears the error of the model's gravity, while the mechanism creeps.
#[test]
fn friction_bears_what_the_model_does_not_know() {
    let dry = DryFriction { constant: 1.0, width: 0.02, ..DryFriction::none() };
    let plant = System { lagrangian: PENDULUM, forces: Coulomb { coordinates: [dry] } };
    let model = Perturbed::new(&PENDULUM, 0.05, 1);
    let mut config = GravityConfig::pendulum();
    config.setup.push.most = [6.0];
    let (summary, floating) = gravity(&plant, &model.system(), &config, |_| {}).unwrap();
    assert!(summary.success && floating.drift[0].abs() < 0.05, "{floating:?}");
    config.setup.push.begin = f32::NAN;
    assert!(gravity(&plant, &plant, &config, |_| {}).unwrap_err().to_string().starts_with("push"));
}
