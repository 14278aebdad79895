//! The templates' loop around a simulated machine: it comes upright, and its trace is the one that emulated boards must have.

use leastaction_core::energy::trigonometric::CARTPOLE;
use leastaction_core::forces::System;
use leastaction_firmware_sim::scenario::{SwingUpConfig, run_on};
use leastaction_machine::{Counted, Counter, ENCODERS, Encoder, control, model, ticks};

#[test]
fn the_machine_comes_upright_and_its_trace_is_the_expected_one() {
    let model = model().unwrap();
    let processor = Counted::new(control(&model).unwrap());
    let setup = SwingUpConfig::cartpole().setup;
    let summary = run_on(&System::conservative(CARTPOLE), processor, &setup, [0.0; 2], |_| ()).unwrap();
    assert!(summary.success, "{summary:?}");
    let expected = include_str!("../../expected.txt");
    assert_eq!(
        format!("{:016x}\n", summary.hash),
        expected,
        "write it into firmware-sim/boards/expected.txt"
    );
}

#[test]
fn counts_are_positions_of_their_encoder() {
    let backwards = Encoder { zero: -7, unit: -0.25 };
    for encoder in ENCODERS.into_iter().chain([backwards]) {
        for counts in [-5000, -7, 0, 3, 20_000] {
            assert_eq!(encoder.counts(encoder.position(counts)), counts);
        }
    }
    assert_eq!(backwards.position(-3), -1.0);
}

#[test]
fn a_counter_keeps_its_rounds() {
    for (range, speed) in [(4096, 2047), (4096, -2047), (1 << 16, 30_000), (1 << 16, -30_000)] {
        let mut counter = Counter::new(range);
        for i in 0..20 {
            let total: i32 = 5 + i * speed;
            assert_eq!(counter.read(total.rem_euclid(range) as u16), total);
        }
    }
}

#[test]
fn elapsed_time_is_a_whole_number_of_ticks_and_at_least_one() {
    assert_eq!([0, 9_999, 10_400, 15_000, 20_100].map(|time| ticks(time, 10_000)), [1, 1, 1, 2, 2]);
    assert_eq!((ticks(u64::MAX / 2, 1), ticks(7, 0)), (u32::MAX, 1));
}
