//! A log instead of a plant.

use leastaction_core::energy::trigonometric::{ACROBOT, CARTPOLE};
use leastaction_core::forces::System;
use leastaction_firmware_sim::devices::Drive;
use leastaction_firmware_sim::observer::LearnZeros;
use leastaction_firmware_sim::scenario::{
    Logged, SwingUpConfig, TrackConfig, replay, swing_up_cartpole, track,
};
use leastaction_firmware_sim::{InPlace, Program, SetupError};

/// The log of a swing-up, and its estimates.
fn log(config: &SwingUpConfig<2>) -> Vec<(Logged<2>, [f32; 2])> {
    let system = System::conservative(CARTPOLE);
    let mut log = Vec::new();
    swing_up_cartpole(&system, &system, config, |tick| {
        let logged = Logged { elapsed: 1, time: tick.time, measured: tick.measured, command: tick.commanded };
        log.push((logged, tick.q_estimate));
    })
    .unwrap();
    log
}

#[test]
fn the_log_of_a_loop_is_estimated_as_in_the_loop() {
    let mut config = SwingUpConfig::cartpole();
    config.setup.devices.encoders[1].drop = 0.1;
    config.setup.observer.delay = 1.0;
    let (system, log) = (System::conservative(CARTPOLE), log(&config));
    let program = Program::listening(config.setup.tick, [false, true], Drive::ideal(), config.setup.observer);
    let mut estimates = Vec::new();
    let rows = log.iter().map(|(logged, _)| *logged);
    let firmware = InPlace { model: &system, firmware: program.listen(&system).unwrap() };
    let summary = replay(firmware, &program, rows, |tick, _| estimates.push(tick.q_estimate)).unwrap();
    assert!(summary.success && summary.ticks == 1000 && summary.incidents.dropped > 50, "{summary:?}");
    assert!(estimates.iter().eq(log.iter().map(|(_, estimate)| estimate)), "the same bits");
    assert!(summary.rms_error[1] < 3e-3 && summary.rms_error[1] > 1e-4, "{summary:?}");
}

#[test]
fn a_new_recording_begins_anew_and_keeps_the_zeros() {
    let system = System::conservative(ACROBOT);
    let mut config = TrackConfig::<2>::acrobot();
    config.setup.devices = config.setup.devices.perfect();
    config.setup.devices.encoders[0].zero = 0.03;
    config.setup.observer.delay = 0.0;
    let mut rows: Vec<Logged<2>> = Vec::new();
    track(&system, &system, &config, |tick| {
        rows.push(Logged { elapsed: 1, time: tick.time, measured: tick.measured, command: tick.commanded });
    })
    .unwrap();
    config.setup.observer.zeros = Some(LearnZeros { deviation: 0.05, innovation: 1e-3 });
    let program = Program::listening(config.setup.tick, [true; 2], Drive::ideal(), config.setup.observer);
    let again = Logged { elapsed: Logged::<2>::FIRST, ..rows[0] };
    let both: Vec<_> = rows.iter().chain([&again]).chain(&rows[1..]).copied().collect();
    let mut outcomes = Vec::new();
    let firmware = InPlace { model: &system, firmware: program.listen(&system).unwrap() };
    let summary = replay(firmware, &program, both, |_, outcome| outcomes.push(*outcome));
    assert!(summary.unwrap().success);
    let (last, first) = (outcomes[rows.len() - 1], outcomes[rows.len()]);
    assert!((last.zeros[0] - 0.03).abs() < 3e-3 && last.zeros[1].abs() < 3e-3, "{:?}", last.zeros);
    assert_eq!((first.zeros, first.estimate.v), (last.zeros, [0.0; 2]));
}

#[test]
fn a_program_out_of_range_is_refused() {
    let (system, config) = (System::conservative(CARTPOLE), SwingUpConfig::cartpole());
    let program = Program::listening(-1.0, [false, true], Drive::ideal(), config.setup.observer);
    assert!(matches!(program.listen(&system).err(), Some(SetupError::OutOfRange { what: "tick", .. })));
}
