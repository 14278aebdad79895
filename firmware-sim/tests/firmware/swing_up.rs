//! Swing-up and hold: pendulum by a weak joint, cart-pole by its cart, with exact and wrong models.

use crate::common::{Exact, Perturbed};
use core::f32::consts::PI;
use leastaction_core::energy::trigonometric::{CARTPOLE, PENDULUM, Trigonometric};
use leastaction_core::forces::{Coulomb, DryFriction, System, Viscous};
use leastaction_core::model::BodiesModel;
use leastaction_firmware_sim::devices::Drive;
use leastaction_firmware_sim::observer::LearnZeros;
use leastaction_firmware_sim::scenario::{SwingUpConfig, swing_up_cartpole, swing_up_pendulum};
use leastaction_firmware_sim::{Mode, SetupError, wrap};

const STARTS: u64 = 20;

fn pendulum(model: &Exact<1>, config: &SwingUpConfig<1>) -> leastaction_firmware_sim::Summary<1> {
    let plant = System::conservative(PENDULUM);
    swing_up_pendulum(&plant, model, config, |tick| assert!(tick.applied[0].abs() <= 2.0)).unwrap()
}

fn cartpole(model: &Exact<2>, config: &SwingUpConfig<2>) -> leastaction_firmware_sim::Summary<2> {
    let plant = System::conservative(CARTPOLE);
    let within = |u: [f32; 2]| u[0].abs() <= 10.0 && u[1] == 0.0;
    swing_up_cartpole(&plant, model, config, |tick| assert!(within(tick.applied))).unwrap()
}

#[test]
fn pendulum_from_twenty_starts() {
    for seed in 0..STARTS {
        let mut config = SwingUpConfig::pendulum();
        config.setup.seed = seed;
        let summary = pendulum(&System::conservative(PENDULUM), &config);
        assert!(summary.success, "seed {seed}: {summary:?}");
        assert_eq!(summary.incidents.model, 0);
    }
}

#[test]
fn cartpole_from_twenty_starts() {
    for seed in 0..STARTS {
        let mut config = SwingUpConfig::cartpole();
        config.setup.seed = seed;
        let summary = cartpole(&System::conservative(CARTPOLE), &config);
        assert!(summary.success, "seed {seed}: {summary:?}");
        assert!(summary.max_q[0] < 1.5 && summary.newton.iterations <= 3, "seed {seed}: {summary:?}");
    }
}

#[test]
fn from_anywhere_and_with_a_slower_tick() {
    for seed in 0..STARTS {
        let mut config = SwingUpConfig::pendulum();
        (config.setup.seed, config.setup.tick) = (seed, 0.02);
        (config.setup.start.q_spread, config.setup.start.v_spread) = ([PI], [3.0]);
        assert!(pendulum(&System::conservative(PENDULUM), &config).success, "pendulum, seed {seed}");
        let mut config = SwingUpConfig::cartpole();
        (config.setup.seed, config.setup.tick) = (seed, 0.02);
        (config.setup.start.q_spread, config.setup.start.v_spread) = ([0.5, PI], [0.3, 3.0]);
        assert!(cartpole(&System::conservative(CARTPOLE), &config).success, "cart-pole, seed {seed}");
    }
}

#[test]
fn with_a_model_five_percent_wrong_and_faulty_devices() {
    for seed in 0..STARTS {
        let model = Perturbed::new(&PENDULUM, 0.05, seed);
        let mut config = SwingUpConfig::pendulum();
        config.setup.seed = seed;
        disturb(&mut config);
        assert!(pendulum(&model.system(), &config).success, "pendulum, seed {seed}");
        let model = Perturbed::new(&CARTPOLE, 0.05, seed).with_ripple(0.01);
        let mut config = SwingUpConfig::cartpole();
        config.setup.seed = seed;
        disturb(&mut config);
        assert!(cartpole(&model.system(), &config).success, "cart-pole, seed {seed}");
    }
}

/// A tenth of the samples dropped, a fifth of the ticks late by up to half a tick, one in twenty missed.
fn disturb<const N: usize>(config: &mut SwingUpConfig<N>) {
    let devices = &mut config.setup.devices;
    devices.encoders.iter_mut().for_each(|encoder| encoder.drop = 0.1);
    (devices.clock.late, devices.clock.jitter, devices.clock.missed) = (0.2, 0.5, 0.05);
}

#[test]
fn from_exactly_hanging_with_ideal_devices() {
    let mut config = SwingUpConfig::cartpole();
    config.setup = config.setup.perfect();
    config.setup.start.q_spread = [0.0; 2];
    config.setup.start.v_spread = [0.0; 2];
    assert!(cartpole(&System::conservative(CARTPOLE), &config).success);
}

#[test]
fn a_damped_plant_with_a_damped_model() {
    let forces = Viscous { coefficients: [0.5, 0.01] };
    let damped = System { lagrangian: CARTPOLE, forces };
    let summary = swing_up_cartpole(&damped, &damped, &SwingUpConfig::cartpole(), |_| {}).unwrap();
    assert!(summary.success, "{summary:?}");
}

#[test]
fn it_swings_first_and_holds_last() {
    let system = System::conservative(CARTPOLE);
    let (mut modes, mut last) = (Vec::new(), f32::NAN);
    let summary = swing_up_cartpole(&system, &system, &SwingUpConfig::cartpole(), |tick| {
        if modes.last() != Some(&tick.mode) {
            modes.push(tick.mode);
        }
        last = wrap(tick.q[1]);
    })
    .unwrap();
    assert_eq!(modes.first(), Some(&Mode::Wait), "velocities are unknown at first");
    assert_eq!(modes.get(1), Some(&Mode::Swing));
    assert_eq!(modes.last(), Some(&Mode::Hold));
    assert!(last.abs() < 0.02 && summary.settled_at.is_some_and(|t| t > 1.0));
}

#[test]
fn without_force_it_fails() {
    let mut config = SwingUpConfig::cartpole();
    config.setup.devices.actuator.limit = [0.0; 2];
    let summary = cartpole(&System::conservative(CARTPOLE), &config);
    assert!(!summary.success && summary.max_force == [0.0; 2]);
}

#[test]
fn a_short_track_makes_it_fail() {
    let mut config = SwingUpConfig::cartpole();
    config.setup.goal.bounds[0] = 0.3;
    let summary = cartpole(&System::conservative(CARTPOLE), &config);
    assert!(!summary.success && summary.settled_at.is_some());
}

#[test]
fn a_model_that_hangs_upright_is_refused() {
    let model = Perturbed::new(&PENDULUM, -2.0, 0);
    let refused = swing_up_pendulum(&model.system(), &model.system(), &SwingUpConfig::pendulum(), |_| {});
    assert!(matches!(refused, Err(SetupError::OutOfRange { .. })), "{refused:?}");
}

/// A cart-pole like one on a table: dry friction of 5% of the largest force under the cart, encoders off by 0.02, drives 8 ms late.
fn on_the_table(seed: u64) -> SwingUpConfig<2> {
    let mut config = SwingUpConfig::cartpole();
    config.setup.seed = seed;
    config.setup.devices.encoders.iter_mut().for_each(|encoder| encoder.zero = 0.02);
    (config.setup.devices.actuator.delay, config.setup.observer.delay) = (0.8, 0.8);
    config
}

fn dry(force: f32) -> System<Trigonometric<'static, 2>, (Viscous<f32, 2>, Coulomb<f32, 2>)> {
    let cart = DryFriction { constant: force, width: 0.05, ..DryFriction::none() };
    let coulomb = Coulomb { coordinates: [cart, DryFriction::none()] };
    System { lagrangian: CARTPOLE, forces: (Viscous::none(), coulomb) }
}

#[test]
fn friction_zeros_and_delay_do_not_keep_it_down() {
    let learning = Some(LearnZeros { deviation: 0.02, innovation: 3e-3 });
    // The model knows the friction, and learns the zeros; then neither.
    for (model, zeros) in [(dry(0.5), learning), (dry(0.0), None)] {
        for seed in 0..STARTS {
            let mut config = on_the_table(seed);
            config.setup.observer.zeros = zeros;
            let summary = swing_up_cartpole(&dry(0.5), &model, &config, |_| {}).unwrap();
            assert!(summary.success && summary.incidents.model == 0, "seed {seed}: {summary:?}");
        }
    }
}

/// A cart-pole on a table with a drive that gives nine tenths of the commanded force, while the firmware assumes another drive.
fn weak_drive(seed: u64, known: Drive<2>) -> SwingUpConfig<2> {
    let mut config = on_the_table(seed);
    config.setup.devices.actuator.drive = Drive { gain: [0.9, 1.0], offset: [0.0; 2] };
    config.setup.known_drive = known;
    config
}

/// A model file at an address from which its weights can be read.
#[repr(C, align(4))]
struct Aligned<const N: usize>([u8; N]);

static LEARNED: Aligned<{ include_bytes!("../../chip/models/cartpole-dry.postcard").len() }> =
    Aligned(*include_bytes!("../../chip/models/cartpole-dry.postcard"));

/// The model of `chip/models/make.sh`, learned from logs of the same machine: `docs/book/src/swing-up.md`.
#[test]
fn learned_from_the_machines_own_logs() {
    type Friction = (Viscous<f32, 2>, Coulomb<f32, 2>);
    let model = BodiesModel::<2, f32, Friction>::load(&LEARNED.0).unwrap();
    let file = model.actuator().unwrap().unwrap();
    let mut hashes = std::collections::HashSet::new();
    for seed in 0..STARTS {
        let (_, known) = file.at_step(0.01).unwrap();
        let mut config = weak_drive(seed, Drive { gain: known.gain, offset: known.offset });
        config.setup.observer.delay = file.delay() / config.setup.tick;
        config.setup.observer.zeros = Some(LearnZeros { deviation: 0.02, innovation: 3e-3 });
        let summary = swing_up_cartpole(&dry(0.5), &model.system, &config, |_| {}).unwrap();
        assert!(summary.success && summary.incidents.model == 0, "seed {seed}: {summary:?}");
        hashes.insert(summary.hash);
    }
    assert_eq!(hashes.len() as u64, STARTS);
}

#[test]
fn a_drive_that_is_turned_round_is_commanded_the_other_way() {
    let turned = Drive { gain: [-0.5, 1.0], offset: [0.3, 0.0] };
    for (known, expected) in [(turned, true), (Drive::ideal(), false)] {
        let mut config = weak_drive(0, known);
        (config.setup.devices.actuator.drive, config.setup.devices.actuator.limit) = (turned, [20.0, 0.0]);
        let within = |u: [f32; 2]| (u[0] - 0.3).abs() <= 10.0 && u[1] == 0.0;
        let summary =
            swing_up_cartpole(&dry(0.5), &dry(0.5), &config, |tick| assert!(within(tick.applied))).unwrap();
        assert_eq!(summary.success, expected, "{known:?}: {summary:?}");
    }
}
