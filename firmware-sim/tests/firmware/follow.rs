//! Plans that the firmware follows: of mechanisms that swing up, with perfect, ordinary and bad devices; and plans that it refuses.

use crate::common::Perturbed;
use crate::common::plans::{CARTPOLE_UP, H, MODEL, PENDULUM_UP, SwingUp, Written, resting};
use core::f32::consts::TAU;
use leastaction_core::energy::trigonometric::{CARTPOLE, PENDULUM};
use leastaction_core::forces::System;
use leastaction_core::plan::PlanError;
use leastaction_firmware_sim::control::Target;
use leastaction_firmware_sim::devices::{Drive, EncoderConfig};
use leastaction_firmware_sim::scenario::{FollowConfig, Followed, follow};
use leastaction_firmware_sim::{InUse, Mode, Program, SetupError, Summary, Tick};

const ROTARY: [EncoderConfig; 1] = [EncoderConfig::rotary()];
const CART_AND_POLE: [EncoderConfig; 2] = [EncoderConfig::linear(), EncoderConfig::rotary()];

/// A run along a plan of the pendulum, by its exact model.
fn pendulum<'p>(
    written: &'p Written,
    config: &FollowConfig<1>,
    sink: impl FnMut(&Tick<1>),
) -> (Summary<1>, Followed<'p, 1>) {
    let plant = System::conservative(PENDULUM);
    follow(&plant, &plant, &written.plan(), config, sink).unwrap()
}

/// The run of a plan from its start, with perfect devices.
fn perfect<const N: usize>(written: &Written, encoders: [EncoderConfig; N]) -> FollowConfig<N> {
    let config = FollowConfig::new(&written.plan::<N>(), encoders);
    let mut setup = config.setup.perfect();
    setup.start.q_spread = [0.0; N];
    FollowConfig { setup, ..config }
}

#[test]
fn perfect_devices_keep_to_the_plan() {
    let written = PENDULUM_UP.plan::<2>();
    let (summary, followed) = pendulum(&written, &perfect(&written, ROTARY), |tick| {
        assert!(tick.applied[0].abs() <= 2.25);
    });
    assert!(summary.success && followed.deviation[0] < 2e-3, "{summary:?} {followed:?}");
    assert!(followed.held[0] < 1e-3 && followed.end.is_some_and(|end| end[0].abs() < 2e-3), "{followed:?}");
    assert_eq!((followed.off_start, summary.incidents.model), ([[0.0]; 2], 0));
    // The plan used its share of the limit, four fifths; hardly more was needed.
    assert!((0.79..0.85).contains(&followed.share[0]), "{followed:?}");
    let written = CARTPOLE_UP.plan::<4>();
    let plant = System::conservative(CARTPOLE);
    let config = perfect(&written, CART_AND_POLE);
    let (summary, followed) = follow(&plant, &plant, &written.plan(), &config, |_| {}).unwrap();
    assert!(summary.success, "{summary:?} {followed:?}");
    assert!(followed.deviation.iter().all(|x| *x < 4e-3) && followed.share[1] == 0.0, "{followed:?}");
}

#[test]
fn ordinary_and_bad_devices_and_a_wrong_model_are_borne() {
    let written = CARTPOLE_UP.plan::<4>();
    let plan = written.plan::<2>();
    let plant = System::conservative(CARTPOLE);
    for seed in 0..10 {
        let mut config = FollowConfig::new(&plan, CART_AND_POLE);
        config.setup.seed = seed;
        let (summary, followed) = follow(&plant, &plant, &plan, &config, |_| {}).unwrap();
        assert!(summary.success && followed.held[1] < 0.1, "{seed}: {summary:?} {followed:?}");
        // A tenth of the samples dropped, ticks missed and late, and masses and gravity 2% off.
        let devices = &mut config.setup.devices;
        devices.encoders = devices.encoders.map(|encoder| EncoderConfig { drop: 0.1, ..encoder });
        (devices.clock.missed, devices.clock.late, devices.clock.jitter) = (0.05, 0.2, 0.5);
        let model = Perturbed::new(&CARTPOLE, 0.02, seed);
        let (summary, followed) = follow(&plant, &model.system(), &plan, &config, |_| {}).unwrap();
        assert!(summary.incidents.missed > 0 && summary.incidents.dropped > 0);
        assert!(summary.success, "{seed}: {summary:?} {followed:?}");
    }
}

/// A pendulum is not what its plan was made for, and numbers of the firmware's model have followed it: without those numbers in ū, feedback alone
/// would make up for the difference.
#[test]
fn plans_are_followed_by_the_numbers_in_use() {
    let written = PENDULUM_UP.plan::<2>();
    let config = perfect(&written, ROTARY);
    for seed in 0..4 {
        let changed = Perturbed::new(&PENDULUM, 0.1, seed);
        let (plant, learned) = (changed.system(), System::conservative(PENDULUM));
        let deviation = |of_file| {
            let model = InUse { used: plant, of_file };
            follow(&plant, &model, &written.plan(), &config, |_| {}).unwrap().1.deviation[0]
        };
        let (kept, followed) = (deviation(&plant), deviation(&learned));
        assert!(followed < 0.2 * kept, "{seed}: {followed} and {kept}");
    }
}

/// The mode is that of the plan's tick: a missed tick is one of the plan, too.
#[test]
fn missed_ticks_are_ticks_of_the_plan() {
    let written = resting((MODEL, H), ([0.5], true), &[0], [0.25, 2.0, 1.0]);
    let (plan, model) = (written.plan::<1>(), System::conservative(PENDULUM));
    let config = perfect(&written, ROTARY);
    let start = || config.program().follow_with(&model, || Ok::<_, SetupError>(plan)).unwrap();
    let (mut every, mut some) = (start(), start());
    let target = Target::of(&[0.0], 0.0, H);
    let waits = (0..).find(|_| {
        let [one, _] = [&mut every, &mut some].map(|firmware| firmware.run(&model, 1, &[Some(0.5)], &target));
        one.command.mode != Mode::Wait
    });
    assert_eq!(waits, Some(2), "the estimate is trusted after three samples");
    let modes: Vec<_> = (0..3).map(|_| every.run(&model, 1, &[Some(0.5)], &target).command.mode).collect();
    assert_eq!(modes, [Mode::Track, Mode::Hold, Mode::Hold]);
    assert_eq!(some.run(&model, 2, &[Some(0.5)], &target).command.mode, Mode::Hold);
    // A command is that of the plan at the estimate.
    let outcome = some.run(&model, 1, &[Some(0.4)], &target);
    let expected = plan.force(4, &outcome.estimate.q, &outcome.estimate.v).unwrap();
    assert_eq!((outcome.command.u, outcome.command.u[0] > 0.25), (expected, true));
}

/// Without a trusted estimate nothing is commanded, and the plan goes on.
#[test]
fn the_plan_goes_on_while_an_encoder_is_silent() {
    let written = PENDULUM_UP.plan::<2>();
    let (plan, model) = (written.plan::<1>(), System::conservative(PENDULUM));
    let mut config = perfect(&written, ROTARY);
    config.setup.observer.patience = 3;
    let mut firmware = config.program().follow_with(&model, || Ok::<_, SetupError>(plan)).unwrap();
    let target = Target::of(&[0.0], 0.0, H);
    let mut run = |readings: u32, reading: Option<f32>| {
        (0..readings).map(|_| firmware.run(&model, 1, &[reading], &target).command).last().unwrap()
    };
    assert_eq!(run(10, Some(3.1)).mode, Mode::Track);
    let silent = run(300, None);
    assert_eq!((silent.mode, silent.u), (Mode::Wait, [0.0]));
    assert_eq!(run(10, Some(3.1)).mode, Mode::Hold, "3 s are over");
}

#[test]
fn what_the_plan_asks_for_is_applied_through_any_drive() {
    let planned = Drive { gain: [0.5], offset: [0.3] };
    let written = SwingUp { limit: 4.5, drive: planned, ..PENDULUM_UP }.plan::<2>();
    let mut config = perfect(&written, ROTARY);
    let actual = Drive { gain: [-0.8], offset: [-0.2] };
    config.drive = planned;
    (config.setup.known_drive, config.setup.devices.actuator.drive) = (actual, actual);
    let plan = written.plan::<1>();
    let mut first = None;
    let (summary, followed) = pendulum(&written, &config, |tick| {
        if tick.mode == Mode::Track && first.is_none() {
            first = Some(tick.applied[0]);
        }
        // The plan allows commands of ±4.5, from -1.95 to 2.55 N m.
        assert!(tick.mode == Mode::Wait || (-1.951..2.551).contains(&tick.applied[0]), "{tick:?}");
    });
    assert!(summary.success && followed.deviation[0] < 0.05, "{summary:?} {followed:?}");
    let [expected] = planned.force(&plan.reference(0).u);
    // While the firmware waits, the drive's offset moves the pendulum a little.
    assert!((first.unwrap() - expected).abs() < 0.1, "{first:?} {expected}");
    assert!((0.7..0.95).contains(&followed.share[0]), "{followed:?}");
}

#[test]
fn the_actuators_own_limit_holds_too() {
    let written = PENDULUM_UP.plan::<2>();
    let mut config = perfect(&written, ROTARY);
    config.setup.devices.actuator.limit = [1.0];
    let (summary, followed) = pendulum(&written, &config, |tick| assert!(tick.applied[0].abs() <= 1.0));
    assert!(!summary.success && followed.share[0] > 0.44 && followed.share[0] < 0.45, "{followed:?}");
}

/// A delay moves the motion as a whole, and does not take the mechanism from it.
#[test]
fn a_delay_moves_the_motion() {
    let written = PENDULUM_UP.plan::<2>();
    for delay in [0.0, 1.0, 2.5] {
        let mut config = perfect(&written, ROTARY);
        (config.setup.devices.actuator.delay, config.setup.observer.delay) = (delay, delay);
        let (summary, followed) = pendulum(&written, &config, |_| {});
        assert!(summary.success && followed.deviation[0] < 4e-3, "{delay}: {summary:?} {followed:?}");
        let begun = followed.begun.unwrap();
        assert!((begun - (2.0 + delay) * H).abs() < 1e-6, "{begun}");
    }
}

/// A joint with limits does not turn over: which of the readings' turns it is on, its plan knows.
#[test]
fn the_start_tells_whole_turns() {
    let written = resting((MODEL, H), ([0.5 + TAU], false), &[0], [0.0, 20.0, 5.0]);
    let mut config = perfect(&written, ROTARY);
    config.setup.start.q = [0.6];
    let mut largest = 0.0_f32;
    let (_, followed) = pendulum(&written, &config, |tick| largest = largest.max(tick.applied[0].abs()));
    assert!((followed.off_start[0][0] - 0.1).abs() < 1e-5 && largest < 4.0, "{largest} {followed:?}");
}

#[test]
fn a_command_that_is_no_number_is_safe() {
    let written = resting((MODEL, H), ([0.5], true), &[0], [0.0, f32::MAX, -f32::MAX]);
    let (plan, model) = (written.plan::<1>(), System::conservative(PENDULUM));
    let program = perfect(&written, ROTARY).program();
    let mut firmware = program.follow_with(&model, || Ok::<_, SetupError>(plan)).unwrap();
    let target = Target::of(&[0.0], 0.0, H);
    let mut outcome = firmware.run(&model, 1, &[Some(1.6)], &target);
    for i in 1..6_u8 {
        outcome = firmware.run(&model, 1, &[Some(1.6 + 0.1 * f32::from(i))], &target);
    }
    assert_eq!((outcome.command.mode, outcome.command.u, outcome.errors), (Mode::Safe, [0.0], 1));
}

/// The refusal of a program to follow a plan.
fn refusal(program: Program<1>, written: &Written) -> SetupError {
    let model = System::conservative(PENDULUM);
    program.follow_with(&model, || Ok::<_, SetupError>(written.plan())).err().unwrap()
}

#[test]
fn what_does_not_fit_the_program_is_refused() {
    let written = resting((MODEL, H), ([0.5], true), &[0], [0.0; 3]);
    let program = perfect(&written, ROTARY).program();
    let model = System::conservative(PENDULUM);
    assert_eq!(program.start(&model).err(), Some(SetupError::NoPlan));
    assert_eq!(program.follow(&model).err(), Some(SetupError::NoPlan));
    let other = Program { tick: 0.02, ..program };
    assert_eq!(refusal(other, &written), SetupError::PlanTick { planned: H, tick: 0.02 });
    let linear = Program { angle: [false], ..program };
    assert_eq!(refusal(linear, &written), SetupError::PlanAngle { coordinate: 0 });
    let mut config = perfect(&written, ROTARY);
    config.drive.gain = [0.0];
    let error = refusal(config.program(), &written);
    assert!(matches!(error, SetupError::OutOfRange { what: "actuator gain", .. }), "{error}");
    let error = SetupError::from(PlanError::OtherModel { planned: 1, given: 2 });
    assert!(error.to_string().starts_with("the plan: made for the model with fingerprint 00000001"));
}
