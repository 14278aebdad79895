//! Decisions at every tick over a receding horizon.

use crate::common::Perturbed;
use crate::common::plans::{CARTPOLE_UP, PENDULUM_UP};
use core::f32::consts::PI;
use leastaction_core::continuous::ContinuousState;
use leastaction_core::discrete::Order;
use leastaction_core::energy::trigonometric::{CARTPOLE, PENDULUM, Trigonometric};
use leastaction_core::forces::{ControlKind, System};
use leastaction_core::model::TrainedStep;
use leastaction_firmware_sim::control::{
    Command, Controller, Coordinates, Mpc, MpcSettings, Plans, States, Target, blank_nodes,
};
use leastaction_firmware_sim::devices::Drive;
use leastaction_firmware_sim::observer::OtherStep;
use leastaction_firmware_sim::scenario::{Decided, MpcConfig, Push, SwingUpConfig, mpc};
use leastaction_firmware_sim::{Mechanism, Mode, SetupError, Summary, Tick, Trained};

const STARTS: u64 = 8;

/// Runs a seed over a plant and another model; commands must keep to the limits.
fn run<P: Mechanism<N>, M: Mechanism<N>, const N: usize, const D: usize>(
    (plant, model): (&P, &M),
    config: &MpcConfig<N>,
    seed: u64,
) -> (Summary<N>, Decided)
where
    Coordinates<N>: States<D>,
{
    let mut config = *config;
    config.setup.seed = seed;
    let limit = config.setup.devices.actuator.limit;
    let within = |tick: &Tick<N>| assert!((0..N).all(|i| tick.applied[i].abs() <= limit[i]), "{tick:?}");
    mpc::<P, M, N, D>(plant, model, &[], &config, within).unwrap()
}

/// Runs all seeds over an exact model.
#[track_caller]
fn succeeds<const N: usize, const D: usize>(exact: Trigonometric<'static, N>, config: &MpcConfig<N>)
where
    Coordinates<N>: States<D>,
{
    let system = System::conservative(exact);
    for seed in 0..STARTS {
        let (summary, decided) = run::<_, _, N, D>((&system, &system), config, seed);
        assert!(summary.success, "seed {seed}: {summary:?}");
        assert_eq!((summary.incidents.model, decided.followed, decided.floated), (0, 0, 0));
    }
}

#[test]
fn pendulum_from_hanging() {
    succeeds::<1, 2>(PENDULUM, &MpcConfig::<1>::pendulum());
}

#[test]
fn cartpole_from_hanging() {
    succeeds::<2, 4>(CARTPOLE, &MpcConfig::<2>::cartpole());
}

#[test]
fn from_anywhere() {
    let mut config = MpcConfig::<1>::pendulum();
    (config.setup.start.q_spread, config.setup.start.v_spread) = ([PI], [3.0]);
    succeeds::<1, 2>(PENDULUM, &config);
    let mut config = MpcConfig::<2>::cartpole();
    (config.setup.start.q_spread, config.setup.start.v_spread) = ([0.5, PI], [0.3, 3.0]);
    succeeds::<2, 4>(CARTPOLE, &config);
}

#[test]
fn a_push_is_survived() {
    let mut config = MpcConfig::<1>::pendulum();
    config.setup.push = Push { begin: 4.5, end: 4.6, most: [6.0] };
    succeeds::<1, 2>(PENDULUM, &config);
    let mut config = MpcConfig::<2>::cartpole();
    config.setup.push = Push { begin: 4.5, end: 4.6, most: [0.0, 2.0] };
    succeeds::<2, 4>(CARTPOLE, &config);
}

/// A model 5% off, a tenth of the samples dropped, a fifth of the ticks late by up to half a tick, one in twenty missed.
#[test]
fn with_a_model_five_percent_wrong_and_faulty_devices() {
    for seed in 0..STARTS {
        let (exact, model) = (System::conservative(CARTPOLE), Perturbed::new(&CARTPOLE, 0.05, seed));
        let mut config = MpcConfig::<2>::cartpole();
        let devices = &mut config.setup.devices;
        devices.encoders.iter_mut().for_each(|encoder| encoder.drop = 0.1);
        (devices.clock.late, devices.clock.jitter, devices.clock.missed) = (0.2, 0.5, 0.05);
        let (summary, _) = run::<_, _, 2, 4>((&exact, &model.system()), &config, seed);
        assert!(summary.success, "seed {seed}: {summary:?}");
    }
}

#[test]
fn every_tick_after_the_first_samples_decides_and_bits_repeat() {
    let system = System::conservative(CARTPOLE);
    let runs = [0, 1].map(|_| run::<_, _, 2, 4>((&system, &system), &MpcConfig::<2>::cartpole(), 3));
    assert_eq!(runs[0], runs[1]);
    let (summary, Decided { decided, .. }) = runs[0];
    assert!(summary.ticks - decided < 10, "{decided} of {} ticks", summary.ticks);
    let other = run::<_, _, 2, 4>((&system, &system), &MpcConfig::<2>::cartpole(), 4);
    assert_ne!(other.0.hash, summary.hash);
}

/// A goal that takes a force is held without an offset, by a drive with another gain and an offset.
#[test]
fn a_goal_that_takes_a_force_is_held() {
    let drive = Drive { gain: [-0.5], offset: [0.3] };
    let mut config = MpcConfig::<1>::pendulum();
    (config.settings.goal, config.setup.known_drive) = ([0.3], drive);
    (config.setup.devices.actuator.drive, config.setup.devices.actuator.limit) = (drive, [6.0]);
    config.setup.goal.tolerance = [0.02];
    let system = System::conservative(PENDULUM);
    for seed in 0..STARTS {
        let mut last = [0.0];
        config.setup.seed = seed;
        let (summary, _) =
            mpc::<_, _, 1, 2>(&system, &system, &[], &config, |tick| last = tick.applied).unwrap();
        assert!(summary.success, "seed {seed}: {summary:?}");
        // The force is minus that of gravity, mgl/2 sin θ.
        assert!((last[0] + 4.905 * 0.3_f32.sin()).abs() < 0.3, "{last:?}");
    }
}

/// From exactly hanging, over a horizon of half a second and without random commands, a plan shows a shorter way up than the search finds.
#[test]
fn a_plan_is_taken() {
    let written = PENDULUM_UP.plan::<2>();
    let (plan, system) = (written.plan(), System::conservative(PENDULUM));
    let settled = |drive: Option<Drive<1>>| {
        let mut config = MpcConfig::<1>::pendulum();
        (config.setup.tick, config.setup.devices.actuator.limit) = (0.01, [2.25]);
        config.setup = config.setup.perfect();
        (config.setup.start.q_spread, config.setup.start.v_spread) = ([0.0], [0.0]);
        (config.settings.ticks, config.settings.stride, config.settings.sample_every) = (2, 2, 0);
        config.settings.plan = drive;
        let (summary, _) = mpc::<_, _, 1, 2>(&system, &system, &[plan], &config, |_| {}).unwrap();
        summary.settled_at.unwrap()
    };
    let (with, without) = (settled(Some(Drive::ideal())), settled(None));
    assert!(with < plan.seconds() && without > with + 0.5, "{with} s with the plan, {without} s without");
}

/// Without a motion: the last one, then gravity alone, then no command.
#[test]
fn where_no_motion_can_be_computed_the_last_one_is_followed_then_gravity() {
    let model = System::conservative(CARTPOLE);
    let (config, mut nodes) = (MpcConfig::<2>::cartpole(), blank_nodes());
    let mut mpc =
        Mpc::<2, 4>::new(&model, config.settings, &config.program(), Plans::new(), &mut nodes).unwrap();
    let target = Target::of(&[0.0; 2], 0.0, 0.02);
    let mut command = |elapsed: u32, v: f32| {
        Controller::<2>::read(&mut mpc, elapsed, &[None; 2]);
        let state = ContinuousState { q: [0.1, 2.0], v: [0.0, v] };
        mpc.command(&model, &target, &state)
    };
    let absurd = 1e18;
    assert_eq!(command(1, absurd).unwrap().mode, Mode::Float, "nothing was decided yet");
    assert_eq!(command(1, 0.1).unwrap().mode, Mode::Mpc);
    let Command { u, mode } = command(1, absurd).unwrap();
    assert_eq!(mode, Mode::Track);
    assert!(u[0].abs() <= 10.0 && u[1] == 0.0, "{u:?}");
    assert_eq!(command(50, absurd).unwrap().mode, Mode::Float, "the last motion is over");
    let lost = command(1, f32::NAN);
    assert!(
        lost.is_err() || lost.is_ok_and(|command| command.u[0].is_nan()),
        "the firmware gives no command"
    );
    assert_eq!(command(1, 0.1).unwrap().mode, Mode::Mpc);
}

/// The refusal of settings over a cart-pole.
fn refused(change: impl FnOnce(&mut MpcConfig<2>)) -> SetupError {
    let mut config = MpcConfig::<2>::cartpole();
    change(&mut config);
    let system = System::conservative(CARTPOLE);
    config.program().mpc(&system, &[], &mut blank_nodes()).err().unwrap()
}

/// The name of the number that a refusal is about.
fn named(error: SetupError) -> &'static str {
    let SetupError::OutOfRange { what, .. } = error else { panic!("{error}") };
    what
}

#[test]
fn settings_out_of_range_are_refused() {
    for x in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert_eq!(named(refused(|config| config.settings.tolerance.q[1] = x)), "regulator tolerance");
        assert_eq!(named(refused(|config| config.settings.tolerance.u = x)), "regulator tolerance");
    }
    assert_eq!(named(refused(|config| config.settings.goal[0] = f32::NAN)), "goal posture");
    assert_eq!(named(refused(|config| config.settings.drag = -1.0)), "drag");
    type Field = fn(&mut MpcSettings<2>) -> &mut u16;
    let counts: [(&str, Field); 5] = [
        ("ticks of a node", |settings| &mut settings.ticks),
        ("stride", |settings| &mut settings.stride),
        ("iterations of a decision", |settings| &mut settings.iterations),
        ("trials of a line search", |settings| &mut settings.trials),
        ("nodes of a random command", |settings| &mut settings.piece),
    ];
    for (what, field) in counts {
        assert_eq!(named(refused(|config| *field(&mut config.settings) = 0)), what);
    }
}

#[test]
fn goals_that_cannot_be_held_are_refused() {
    let tilted = refused(|config| config.settings.goal = [0.0, 0.5]);
    assert_eq!(named(tilted), "acceleration at the goal");
    assert!(tilted.to_string().contains("no command of the driven coordinates holds"), "{tilted}");
    let mut config = MpcConfig::<1>::pendulum();
    config.settings.goal = [0.5 * PI];
    let pendulum = System::conservative(PENDULUM);
    let heavy = config.program().mpc(&pendulum, &[], &mut blank_nodes()).err().unwrap();
    assert_eq!(named(heavy), "command that holds the goal");
    let undriven = refused(|config| config.setup.devices.actuator.limit = [0.0; 2]);
    assert_eq!(undriven, SetupError::NotStabilisable);
    let massless = System::conservative(Trigonometric { inertia: &[], ..PENDULUM });
    let program = MpcConfig::<1>::pendulum().program();
    assert_eq!(program.mpc(&massless, &[], &mut blank_nodes()).err(), Some(SetupError::SingularInertia));
}

#[test]
fn what_does_not_fit_the_program_is_refused() {
    assert_eq!(refused(|config| config.settings.plan = Some(Drive::ideal())), SetupError::NoPlan);
    let turned = Drive { gain: [0.0; 2], offset: [0.0; 2] };
    assert_eq!(named(refused(|config| config.settings.plan = Some(turned))), "actuator gain");
    let system = System::conservative(CARTPOLE);
    let mut config = MpcConfig::<2>::cartpole();
    config.settings.plan = Some(Drive::ideal());
    let written = CARTPOLE_UP.plan::<4>();
    let other = config.program().mpc(&system, &[written.plan()], &mut blank_nodes()).err();
    assert_eq!(other, Some(SetupError::PlanTick { planned: 0.01, tick: 0.02 }));
    assert_eq!(config.program().start(&system).err(), Some(SetupError::NoMpc));
    assert_eq!(
        SwingUpConfig::cartpole().program().mpc(&system, &[], &mut blank_nodes()).err(),
        Some(SetupError::NoMpc)
    );
}

/// A model that learned its own step is not stepped by another one, unless that is accepted.
#[test]
fn a_model_keeps_the_step_that_it_learned() {
    let system = System::conservative(CARTPOLE);
    let step = TrainedStep { order: Order::Two, h: 0.02, control: ControlKind::Held };
    let model = Trained { system: &system, step: Some(step) };
    let mut config = MpcConfig::<2>::cartpole();
    let error = config.program().mpc(&model, &[], &mut blank_nodes()).err().unwrap();
    assert_eq!(error.to_string(), "stride is 2, but must be 1, the step that the model was trained for");
    config.setup.observer.other_step = OtherStep::Accepted;
    assert!(config.program().mpc(&model, &[], &mut blank_nodes()).is_ok());
    (config.setup.observer.other_step, config.settings.stride) = (OtherStep::Refused, 1);
    assert!(config.program().mpc(&model, &[], &mut blank_nodes()).is_ok());
}

#[test]
fn a_faster_tick_keeps_the_horizon() {
    let config = MpcConfig::<1>::pendulum().with_tick(0.01);
    let MpcSettings { ticks, stride, .. } = config.settings;
    assert_eq!((ticks, stride, config.setup.tick), (6, 6, 0.01));
    assert_eq!(config.with_tick(1.0).settings.ticks, 1);
    assert_eq!(named(refused(|config| *config = config.with_tick(f32::NAN))), "tick");
    succeeds::<1, 2>(PENDULUM, &config);
}
