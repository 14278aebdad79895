//! Every fault has its effect, and none ends the loop.

use leastaction_core::energy::trigonometric::{CARTPOLE, Trigonometric, Wave};
use leastaction_core::forces::System;
use leastaction_core::lagrangian::{Dynamics, Energies, Gradient, Hessian, Lagrangian};
use leastaction_firmware_sim::scenario::{SwingUpConfig, TrackConfig, swing_up_cartpole, track};
use leastaction_firmware_sim::{Mode, SetupError, Summary, Tick};
use proptest::prelude::*;

/// The cart-pole's tracking under a change of the configuration.
fn tracking(change: impl FnOnce(&mut TrackConfig<2>)) -> (Summary<2>, Vec<Tick<2>>) {
    let system = System::conservative(CARTPOLE);
    let mut config = TrackConfig::cartpole();
    config.setup.seconds = 4.0;
    change(&mut config);
    let mut ticks = Vec::new();
    let summary = track(&system, &system, &config, |tick| ticks.push(*tick)).unwrap();
    (summary, ticks)
}

#[test]
fn noise_and_quantisation_spoil_the_estimate() {
    let (plain, _) = tracking(|_| {});
    let (noisy, _) = tracking(|c| c.setup.devices.encoders[1].noise *= 10.0);
    let (coarse, _) = tracking(|c| c.setup.devices.encoders[1].resolution = 0.02);
    assert!(noisy.rms_estimate_q[1] > 5.0 * plain.rms_estimate_q[1], "{noisy:?}");
    assert!(coarse.rms_estimate_q[1] > 3.0 * plain.rms_estimate_q[1], "{coarse:?}");
}

#[test]
fn drops_are_counted_and_bridged() {
    let (plain, _) = tracking(|_| {});
    let (summary, ticks) = tracking(|c| c.setup.devices.encoders.iter_mut().for_each(|e| e.drop = 0.3));
    let dropped = ticks.iter().flat_map(|tick| tick.measured).filter(Option::is_none).count();
    assert_eq!((summary.incidents.dropped as usize, plain.incidents.dropped), (dropped, 0));
    assert!((180..300).contains(&dropped) && summary.success, "{summary:?}");
    assert!(summary.rms_error[1] > plain.rms_error[1]);
}

#[test]
fn blind_firmware_commands_no_force() {
    let (summary, ticks) = tracking(|c| c.setup.devices.encoders[0].drop = 1.0);
    assert!(ticks.iter().all(|tick| tick.mode == Mode::Wait && tick.applied == [0.0; 2]));
    assert!(!summary.success && summary.incidents.dropped == 400 && summary.rms_estimate_q == [0.0; 2]);
}

#[test]
fn late_ticks_are_late() {
    let (summary, ticks) =
        tracking(|c| (c.setup.devices.clock.late, c.setup.devices.clock.jitter) = (0.5, 0.8));
    let late = ticks.iter().filter(|tick| tick.lateness > 0.0).count();
    assert!((150..250).contains(&late) && summary.incidents.late as usize == late);
    assert!(ticks.iter().all(|tick| tick.lateness < 0.008) && summary.success);
    assert!(summary.rms_error[1] > 1.5 * tracking(|_| {}).0.rms_error[1], "{summary:?}");
}

#[test]
fn missed_ticks_repeat_the_command() {
    let (summary, ticks) = tracking(|c| c.setup.devices.clock.missed = 0.2);
    assert!((50..110).contains(&summary.incidents.missed) && summary.success, "{summary:?}");
    for pair in ticks.windows(2).filter(|pair| pair[1].missed) {
        assert_eq!((pair[1].measured, pair[1].commanded), ([None; 2], pair[0].commanded));
        assert_eq!(pair[1].q_estimate, pair[0].q_estimate);
    }
    let (sleepy, ticks) = tracking(|c| (c.setup.devices.clock.missed, c.setup.observer.patience) = (0.6, 1));
    let waits = ticks.iter().skip(10).filter(|tick| tick.mode == Mode::Wait && !tick.missed).count();
    assert!(waits > 20 && sleepy.incidents.model == 0, "{waits} {sleepy:?}");
    let (never, ticks) = tracking(|c| c.setup.devices.clock.missed = 1.0);
    assert!(never.incidents.missed == 400 && ticks.iter().all(|tick| tick.applied == [0.0; 2]));
}

#[test]
fn a_part_of_a_tick_of_delay_counts_too() {
    let (exact, _) = tracking(|c| (c.setup.devices.actuator.delay, c.setup.observer.delay) = (2.0, 2.0));
    let (known, _) = tracking(|c| (c.setup.devices.actuator.delay, c.setup.observer.delay) = (1.6, 1.6));
    let (unknown, _) = tracking(|c| (c.setup.devices.actuator.delay, c.setup.observer.delay) = (1.6, 0.0));
    let worst = |summary: &Summary<2>| summary.rms_error[0].max(summary.rms_error[1]);
    assert!(worst(&known) < 1.5 * worst(&exact), "{known:?} {exact:?}");
    assert!(worst(&unknown) > 5.0 * worst(&known), "{unknown:?} {known:?}");
}

#[test]
fn an_unknown_delay_costs_accuracy_and_a_known_one_does_not() {
    let (plain, _) = tracking(|_| {});
    let (unknown, _) = tracking(|c| c.setup.devices.actuator.delay = 4.0);
    let (known, _) = tracking(|c| (c.setup.devices.actuator.delay, c.setup.observer.delay) = (4.0, 4.0));
    assert!(unknown.rms_error[1] > 3.0 * plain.rms_error[1], "{unknown:?}");
    assert!(known.rms_error[1] < 2.0 * plain.rms_error[1], "{known:?}");
}

#[test]
fn saturation_limits_the_force() {
    let (summary, _) = tracking(|c| c.setup.devices.actuator.limit = [1.0, 0.1]);
    assert!(!summary.success && summary.max_force == [1.0, 0.1]);
    let (none, ticks) = tracking(|c| c.setup.devices.actuator.limit = [0.0; 2]);
    assert!(!none.success && ticks.iter().all(|tick| tick.commanded == [0.0; 2]));
}

#[test]
fn devices_do_not_shift_each_others_luck() {
    let faulty = |c: &mut TrackConfig<2>| {
        c.setup.devices.clock.late = 0.3;
        c.setup.devices.clock.jitter = 0.5;
        c.setup.devices.clock.missed = 0.1;
    };
    let (_, first) = tracking(faulty);
    let (_, second) = tracking(|c| {
        faulty(c);
        c.setup.devices.encoders[0].drop = 0.5;
        c.setup.devices.encoders[1].noise = 0.02;
    });
    assert!(first.iter().zip(&second).all(|(a, b)| a.lateness == b.lateness && a.missed == b.missed));
    assert_ne!(first, second);
}

/// A cart-pole model that returns NaN between 0.1 m and 0.2 m.
struct Holed;

impl Holed {
    fn known(q: &[f32; 2]) -> f32 {
        if (0.1..0.2).contains(&q[0]) { f32::NAN } else { 1.0 }
    }
}

impl Lagrangian<f32, 2> for Holed {
    fn energies(&self, q: &[f32; 2], v: &[f32; 2]) -> Energies<f32> {
        CARTPOLE.energies(q, v)
    }
    fn gradient(&self, q: &[f32; 2], v: &[f32; 2]) -> Gradient<f32, 2> {
        let Gradient { l_q, l_v } = CARTPOLE.gradient(q, v);
        Gradient { l_q: l_q.map(|x| x * Self::known(q)), l_v }
    }
    fn dynamics(&self, q: &[f32; 2], v: &[f32; 2]) -> Dynamics<f32, 2> {
        let d: Dynamics<f32, 2> = CARTPOLE.dynamics(q, v);
        Dynamics { l_q: d.l_q.map(|x| x * Self::known(q)), ..d }
    }
    fn hessian(&self, q: &[f32; 2], v: &[f32; 2]) -> Hessian<f32, 2> {
        let h: Hessian<f32, 2> = CARTPOLE.hessian(q, v);
        Hessian { l_q: h.l_q.map(|x| x * Self::known(q)), ..h }
    }
}

#[test]
fn where_the_model_fails_the_firmware_is_safe_and_goes_on_after() {
    let (plant, model) = (System::conservative(CARTPOLE), System::conservative(Holed));
    let mut ticks = Vec::new();
    let summary = track(&plant, &model, &TrackConfig::cartpole(), |tick| ticks.push(*tick)).unwrap();
    assert!(summary.incidents.safe > 0 && summary.incidents.model >= summary.incidents.safe, "{summary:?}");
    let safe = |tick: &Tick<2>| tick.mode == Mode::Safe;
    assert!(ticks.iter().filter(|tick| safe(tick)).all(|tick| tick.commanded == [0.0; 2]));
    assert!(ticks.iter().all(|tick| tick.q_estimate.iter().chain(&tick.v_estimate).all(|x| x.is_finite())));
    let after = ticks.iter().rposition(safe).unwrap();
    assert!(ticks[after + 1..].iter().any(|tick| tick.mode == Mode::Track), "last safe tick {after}");
}

#[test]
fn a_model_of_nonsense_never_acts() {
    let plant = System::conservative(CARTPOLE);
    let potential = [Wave { amplitude: f64::NAN, wave: [0.0, 1.0] }];
    let nonsense = System::conservative(Trigonometric { potential: &potential, ..CARTPOLE });
    let summary =
        track(&plant, &nonsense, &TrackConfig::cartpole(), |tick| assert_eq!(tick.applied, [0.0; 2]))
            .unwrap();
    assert!(!summary.success && summary.incidents.model > 900, "{summary:?}");
}

#[test]
fn a_configuration_out_of_range_is_named() {
    type Change = fn(&mut TrackConfig<2>);
    let changes: [(&str, Change); 10] = [
        ("tick", |c| c.setup.tick = 0.0),
        ("length of the run", |c| c.setup.seconds = f32::INFINITY),
        ("plant substeps", |c| c.setup.substeps = 0),
        ("start", |c| c.setup.start.q[1] = f32::NAN),
        ("encoder drop probability", |c| c.setup.devices.encoders[0].drop = 1.5),
        ("actuator limit", |c| c.setup.devices.actuator.limit[0] = -1.0),
        ("actuator delay", |c| c.setup.devices.actuator.delay = 9.0),
        ("observer memory", |c| c.setup.observer.memory = 0),
        ("observer delay", |c| c.setup.observer.delay = f32::NAN),
        ("reference frequency", |c| c.reference.frequency[0] = 0.0),
    ];
    let system = System::conservative(CARTPOLE);
    for (name, change) in changes {
        let mut config = TrackConfig::cartpole();
        change(&mut config);
        let error = track(&system, &system, &config, |_| {}).unwrap_err();
        assert!(matches!(error, SetupError::OutOfRange { what, .. } if what == name), "{error:?}");
        assert!(error.to_string().starts_with(name), "{error}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn no_mixture_of_faults_ends_the_loop(
        seed in any::<u64>(),
        (drop, noise, resolution) in (0.0_f32..=1.0, 0.0_f32..0.3, 0.0_f32..0.5),
        (late, jitter, missed) in (0.0_f32..=1.0, 0.0_f32..=1.0, 0.0_f32..=1.0),
        (actual, assumed) in (0.0_f32..=8.0, 0.0_f32..=8.0),
        (limit, tick) in (0.0_f32..100.0, 0.002_f32..0.1),
    ) {
        let system = System::conservative(CARTPOLE);
        let mut config = SwingUpConfig::cartpole();
        let setup = &mut config.setup;
        (setup.seed, setup.tick, setup.seconds) = (seed, tick, 200.0 * tick);
        for encoder in &mut setup.devices.encoders {
            (encoder.drop, encoder.noise, encoder.resolution) = (drop, noise, resolution);
        }
        (setup.devices.clock.late, setup.devices.clock.jitter, setup.devices.clock.missed) = (late, jitter, missed);
        (setup.devices.actuator.delay, setup.observer.delay) = (actual, assumed);
        setup.devices.actuator.limit[0] = limit;
        let mut commands_within = true;
        let summary = swing_up_cartpole(&system, &system, &config, |tick| {
            commands_within &= tick.commanded[0].abs() <= limit && tick.applied[0].abs() <= limit;
            commands_within &= tick.q.iter().chain(&tick.q_estimate).all(|x| x.is_finite());
        }).unwrap();
        prop_assert!(commands_within);
        prop_assert_eq!(summary.ticks, 200);
    }
}
