//! A log of positions and forces leads to a pole held upright, without the mechanism's equations on the way.

mod common;

use leastaction_core::energy::trigonometric::CARTPOLE;
use leastaction_core::forces::System;
use leastaction_firmware_sim::scenario::{SwingUpConfig, swing_up_cartpole};
use leastaction_firmware_sim::{Mode, wrap};
use leastaction_models::file::decode;

const STARTS: u64 = 20;

#[test]
fn a_learned_cartpole_swings_up_from_twenty_starts() {
    let model = decode(&common::model_file(common::config(16, 30), &common::log(12))).unwrap();
    let weights = model.weights_f32();
    let system = model.architecture.family.inertia_network().unwrap().system::<f32, 2, 16>(&weights).unwrap();
    let plant = System::conservative(CARTPOLE);
    for seed in 0..STARTS {
        let mut config = SwingUpConfig::cartpole();
        config.setup.seed = seed;
        config.setup.observer.order = model.facts.trained_step.unwrap().order;
        let devices = config.setup.devices;
        assert!(devices.actuator.delay == 1.0 && devices.encoders.iter().all(|encoder| encoder.noise > 0.0));
        let mut last = None;
        let summary = swing_up_cartpole(&plant, &system, &config, |tick| last = Some(*tick)).unwrap();
        println!(
            "seed {seed}: settled at {:?} s, cart {} m, estimate {:?} {:?}",
            summary.settled_at, summary.max_q[0], summary.rms_estimate_q, summary.rms_estimate_v
        );
        assert!(summary.success, "seed {seed}: {summary:?}");
        assert_eq!(summary.incidents.model, 0, "seed {seed}");
        assert!(
            last.is_some_and(|tick| tick.mode == Mode::Hold && wrap(tick.q[1]).abs() < 0.1),
            "seed {seed}"
        );
    }
}
