//! The stepper against the calls that it makes.

#[path = "../common/mod.rs"]
mod common;
mod particles;

use common::file::{self, Aligned, HEADER};
use common::{Random, sections};
use leastaction_core::discrete::{
    Control, Del, Galerkin, Midpoint, Newton, Order, Path, Report, State, StepError,
};
use leastaction_core::forces::{Actuator, ControlKind, Forces, Lag, System};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::model::{
    ActuatorBytes, Header, InertiaNetworkModel, Model, ModelError, ModularModel, TrainedStep,
};
use leastaction_core::stepper::{Actuated, Actuation, Direct, Drive, Held, Kind, Lagged, Linear, Stepper};

/// 2 coordinates.
type Cartpole<'a> = InertiaNetworkModel<'a, 2, 7, 2>;
/// 3 coordinates.
type Arm<'a> = ModularModel<'a, 3, 3, 5, 2>;

const STEPS: usize = 40;

fn step(order: Order, h: f32, control: ControlKind) -> Option<TrainedStep> {
    Some(TrainedStep { order, h, control })
}

/// The delay, then gain and offset of every coordinate.
fn actuator(delay: f32, pairs: &[[f32; 2]]) -> Vec<u8> {
    let numbers = [&[delay], pairs.as_flattened()].concat();
    numbers.iter().flat_map(|x| x.to_le_bytes()).collect()
}

const PAIRS: [[f32; 2]; 3] = [[0.8, 0.05], [1.25, -0.1], [-0.5, 0.2]];

fn with<'a>(header: Header<'a>, actuator: &'a [u8]) -> Header<'a> {
    let actuator = (!actuator.is_empty()).then(|| ActuatorBytes::new(actuator).unwrap());
    Header { actuator, ..header }
}

fn cartpole(trained_step: Option<TrainedStep>, actuator: &[u8]) -> Aligned {
    let header = Header { trained_step, ..with(HEADER, actuator) };
    Aligned::new(&file::write(header, &file::weights(&file::CARTPOLE)))
}

fn arm(trained_step: Option<TrainedStep>, actuator: &[u8]) -> Aligned {
    let header = Header { trained_step, ..with(file::arm_header(file::arm()), actuator) };
    Aligned::new(&file::write(header, &file::arm_weights(file::ARM_NUMBERS)))
}

/// Commands of a few newtons.
fn commands<const N: usize>(seed: u64) -> Vec<[f32; N]> {
    let mut random = Random(seed);
    (0..STEPS).map(|_| random.array::<N>(0.5).map(|u| u as f32)).collect()
}

/// Position and velocity of a moving start.
fn begin<const N: usize>() -> [[f32; N]; 2] {
    core::array::from_fn(|row| core::array::from_fn(|i| 0.1 + 0.2 * i as f32 - 0.15 * row as f32))
}

/// State and report of a stepper, to the last bit.
type Seen<const N: usize> = (State<f32, N>, Report<f32>);

/// Steps with three separate calls, under the given forces.
fn by_hand<L, F, P, const N: usize>(model: &Model<System<L, F>>, forces: &[Control<f32, N>]) -> Vec<Seen<N>>
where
    L: Lagrangian<f32, N>,
    F: Forces<f32, N>,
    P: Path,
{
    let [q, v] = begin();
    let (del, mut state) =
        (model.del::<f32, P>().unwrap(), State::new(&model.system.lagrangian, q, v).unwrap());
    let step = |force| {
        let report = del.step(&model.system, &mut state, force).unwrap();
        (state, report)
    };
    forces.iter().map(step).collect()
}

/// Steps of a stepper under the given commands.
fn by_stepper<L, F, P, K, A, const N: usize, const PAST: usize>(
    model: Model<System<L, F>>,
    commands: &[[f32; N]],
) -> Vec<Seen<N>>
where
    L: Lagrangian<f32, N>,
    F: Forces<f32, N>,
    P: Path,
    K: Kind,
    A: Actuation<N>,
{
    let [q, v] = begin();
    let mut stepper = Stepper::<_, P, Drive<K, A, N, PAST>, N>::new(model).unwrap();
    stepper.start(q, v).unwrap();
    let step = |u: &[f32; N]| {
        let report = stepper.step(*u).unwrap();
        (*stepper.state(), report)
    };
    commands.iter().map(step).collect()
}

/// The force over every step, computed from all commands so far.
fn naive<const N: usize>(
    kind: ControlKind,
    (whole, actuator): (usize, Actuator<f32, N>),
    commands: &[[f32; N]],
) -> Vec<Control<f32, N>> {
    let at = |k: usize, late: usize| k.checked_sub(late).map_or([0.0; N], |k| commands[k]);
    let force = |k| {
        let [now, before, first] = [0, 1, 2].map(|more| at(k, whole + more));
        match kind {
            ControlKind::Held => actuator.held(&before, &now),
            ControlKind::Linear => actuator.linear(&first, &before, &now),
        }
    };
    (0..commands.len()).map(force).collect()
}

/// Stepper and naive loop agree over a model, in memory of exactly `PAST` commands and of more.
fn agree<L, F, P, K, const N: usize, const PAST: usize, const MORE: usize>(model: Model<System<L, F>>)
where
    L: Lagrangian<f32, N> + Copy,
    F: Forces<f32, N> + Copy,
    P: Path,
    K: Kind,
{
    let commands = commands::<N>(7);
    let h = model.step().unwrap().h;
    let (whole, actuator) = model.actuator().unwrap().unwrap().at_step(h).unwrap();
    assert!(whole > 0 && actuator.delay > 0.0);
    let forces = naive(K::KIND, (whole.into(), actuator), &commands);
    let expected = by_hand::<_, _, P, N>(&model, &forces);
    assert_eq!(by_stepper::<_, _, P, K, Actuated<N>, N, PAST>(model, &commands), expected);
    assert_eq!(by_stepper::<_, _, P, K, Actuated<N>, N, MORE>(model, &commands), expected);
    assert_eq!(
        Drive::<K, _, N, 1>::new(Actuated { whole, actuator }).map(drop),
        Err(ModelError::Shape { what: "past commands of the actuator", found: PAST, compiled: 1 })
    );
}

#[test]
fn held_commands_without_an_actuator_are_the_three_calls() {
    for order in [Order::Two, Order::Four] {
        let bytes = cartpole(step(order, 0.05, ControlKind::Held), &[]);
        let (model, commands) = (Cartpole::load(bytes.bytes()).unwrap(), commands::<2>(3));
        let forces: Vec<_> = commands.iter().map(|u| Control::held(*u)).collect();
        let [found, expected] = if order == Order::Two {
            [
                by_stepper::<_, _, Midpoint, Held, Direct, 2, 0>(model, &commands),
                by_hand::<_, _, Midpoint, 2>(&model, &forces),
            ]
        } else {
            [
                by_stepper::<_, _, Galerkin, Held, Direct, 2, 0>(model, &commands),
                by_hand::<_, _, Galerkin, 2>(&model, &forces),
            ]
        };
        assert_eq!(found, expected);
    }
    assert_eq!(size_of::<Drive<Held, Direct, 2, 0>>(), 0, "no actuator costs nothing");
}

#[test]
fn linear_commands_without_an_actuator_join_the_samples() {
    let bytes = arm(step(Order::Four, 0.01, ControlKind::Linear), &[]);
    let (model, commands) = (Arm::load(bytes.bytes(), "arm").unwrap(), commands::<3>(5));
    let starts = [&[[0.0; 3]], &commands[..]].concat();
    let forces: Vec<_> =
        starts.iter().zip(&commands).map(|(start, end)| Control { start: *start, end: *end }).collect();
    let found = by_stepper::<_, _, Galerkin, Linear, Direct, 3, 1>(model, &commands);
    assert_eq!(found, by_hand::<_, _, Galerkin, 3>(&model, &forces));
}

#[test]
fn actuators_with_delays_are_a_naive_loop() {
    let (two, four) = (Order::Two, Order::Four);
    // Delays of 2.3 and 1.6 steps.
    let (of_cartpole, of_arm) = (actuator(0.115, &PAIRS[..2]), actuator(0.016, &PAIRS));
    let inertia_network = |order, kind| cartpole(step(order, 0.05, kind), &of_cartpole);
    let tree = |order, kind| arm(step(order, 0.01, kind), &of_arm);
    let (held, linear) = (ControlKind::Held, ControlKind::Linear);
    agree::<_, _, Midpoint, Held, 2, 3, 7>(Cartpole::load(inertia_network(two, held).bytes()).unwrap());
    agree::<_, _, Galerkin, Held, 2, 3, 4>(Cartpole::load(inertia_network(four, held).bytes()).unwrap());
    agree::<_, _, Galerkin, Linear, 2, 4, 5>(Cartpole::load(inertia_network(four, linear).bytes()).unwrap());
    agree::<_, _, Midpoint, Linear, 3, 3, 6>(Arm::load(tree(two, linear).bytes(), "arm").unwrap());
    agree::<_, _, Galerkin, Held, 3, 2, 3>(Arm::load(tree(four, held).bytes(), "arm").unwrap());
}

/// The force over every step behind a lag that begins at rest, y = 0.
fn naive_lagging<const N: usize>(
    kind: ControlKind,
    (whole, actuator, lag): (usize, Actuator<f32, N>, Lag<f32>),
    commands: &[[f32; N]],
) -> Vec<Control<f32, N>> {
    let at = |k: usize, late: usize, i: usize| k.checked_sub(late).map_or(0.0, |k| commands[k][i]);
    let mut y = [0.0; N];
    let force = |k| {
        let (force, end) = actuator.lagging(|i| {
            let [now, before, first] = [0, 1, 2].map(|more| at(k, whole + more, i));
            match kind {
                ControlKind::Held => lag.held(y[i], before, now),
                ControlKind::Linear => lag.linear(y[i], [first, before, now]),
            }
        });
        y = end;
        force
    };
    (0..commands.len()).map(force).collect()
}

#[test]
fn actuators_with_lags_are_a_naive_loop() {
    for (delay, lag) in [(0.0, 0.02), (0.115, 0.07), (0.1, 0.004)] {
        let numbers = [&actuator(delay, &PAIRS[..2])[..], &f32::to_le_bytes(lag)].concat();
        let h = 0.05;
        let taken = ActuatorBytes::new(&numbers).unwrap().at_step_with_lag::<2>(h).unwrap();
        let taken = (taken.0.into(), taken.1, taken.2);
        let commands = commands::<2>(17);
        let file = |kind| cartpole(step(Order::Four, h, kind), &numbers);
        let bytes = file(ControlKind::Held);
        let model = Cartpole::load(bytes.bytes()).unwrap();
        let forces = naive_lagging(ControlKind::Held, taken, &commands);
        let found = by_stepper::<_, _, Galerkin, Held, Lagged<2>, 2, 3>(model, &commands);
        assert_eq!(found, by_hand::<_, _, Galerkin, 2>(&model, &forces));
        let bytes = file(ControlKind::Linear);
        let model = Cartpole::load(bytes.bytes()).unwrap();
        let forces = naive_lagging(ControlKind::Linear, taken, &commands);
        let found = by_stepper::<_, _, Galerkin, Linear, Lagged<2>, 2, 4>(model, &commands);
        assert_eq!(found, by_hand::<_, _, Galerkin, 2>(&model, &forces));
    }
}

#[test]
fn errors_leave_a_lag_as_it_was() {
    let numbers = [&actuator(0.0, &PAIRS[..2])[..], &f32::to_le_bytes(0.07)].concat();
    let bytes = cartpole(step(Order::Four, 0.05, ControlKind::Held), &numbers);
    let model = Cartpole::load(bytes.bytes()).unwrap();
    let mut stepper = Stepper::<_, Galerkin, Drive<Held, Lagged<2>, 2, 0>, 2>::new(model).unwrap();
    let [q, v] = begin();
    stepper.start(q, v).unwrap();
    stepper.step([0.5, 0.25]).unwrap();
    for bad in [f32::NAN, f32::INFINITY] {
        let (mut tried, mut kept) = (stepper, stepper);
        assert_eq!(tried.step([0.25, bad]), Err(StepError::NotFinite));
        assert_eq!(tried.commanded([0.25, bad]), Err(StepError::NotFinite));
        assert_eq!(tried.start_from([q, q], [0.25, bad]), Err(StepError::NotFinite));
        for u in [[0.5, -0.25], [0.125, 0.75]] {
            assert_eq!((tried.step(u), tried.q(), tried.p()), (kept.step(u), kept.q(), kept.p()));
        }
    }
    // A command without a step moves y, and a start does not.
    let mut moved = stepper;
    moved.commanded([2.0, 1.0]).unwrap();
    moved.start(q, v).unwrap();
    stepper.start(q, v).unwrap();
    moved.step([0.5, 0.25]).unwrap();
    stepper.step([0.5, 0.25]).unwrap();
    assert_ne!(moved.p(), stepper.p());
}

/// With a delay of whole steps, no command is kept for a fraction of a step.
#[test]
fn a_delay_of_whole_steps_is_older_commands() {
    let bytes = cartpole(step(Order::Two, 0.125, ControlKind::Held), &actuator(0.25, &PAIRS[..2]));
    let (model, commands) = (Cartpole::load(bytes.bytes()).unwrap(), commands::<2>(11));
    let (whole, actuator) = model.actuator().unwrap().unwrap().at_step(0.125).unwrap();
    assert_eq!((whole, actuator.delay), (2, 0.0));
    let forces = naive(ControlKind::Held, (2, actuator), &commands);
    let found = by_stepper::<_, _, Midpoint, Held, Actuated<2>, 2, 2>(model, &commands);
    assert_eq!(found, by_hand::<_, _, Midpoint, 2>(&model, &forces));
}

type Late<'a> = Stepper<Cartpole<'a>, Galerkin, Drive<Held, Actuated<2>, 2, 3>, 2>;
type Lagging<'a> = Stepper<Cartpole<'a>, Galerkin, Drive<Held, Lagged<2>, 2, 3>, 2>;
type Ideal<'a, P = Galerkin> = Stepper<Cartpole<'a>, P, Drive<Held, Direct, 2, 0>, 2>;

fn late() -> Aligned {
    cartpole(step(Order::Four, 0.05, ControlKind::Held), &actuator(0.115, &PAIRS[..2]))
}

#[test]
fn two_positions_start_as_del_does() {
    let (positions, u) = ([[0.0, 0.1], [0.01, 0.13]], [0.25, -0.5]);
    let bytes = file::golden();
    let bytes = Aligned::new(&bytes);
    let mut stepper = Ideal::<Galerkin>::new(Cartpole::load(bytes.bytes()).unwrap()).unwrap();
    stepper.start_from(positions, u).unwrap();
    let system = stepper.model().system;
    let del = Del::<f32, Galerkin>::new(stepper.h());
    let [q0, q1] = positions;
    assert_eq!(stepper.state(), &del.start(&system, &q0, &q1, &Control::held(u)).unwrap());

    // The next step treats `u` as the last command.
    let bytes = late();
    let model = Cartpole::load(bytes.bytes()).unwrap();
    let (whole, actuator) = model.actuator().unwrap().unwrap().at_step(0.05).unwrap();
    let sent = [[0.5, 0.25], [-0.5, 0.125], u, [0.125, 0.5], [0.25, 0.75]];
    let forces = naive(ControlKind::Held, (whole.into(), actuator), &sent);
    let mut stepper = Late::new(model).unwrap();
    sent[..2].iter().for_each(|u| stepper.commanded(*u).unwrap());
    stepper.start_from(positions, u).unwrap();
    let mut state = del.start(&system, &q0, &q1, &forces[2]).unwrap();
    for k in [3, 4] {
        assert_eq!(stepper.state(), &state);
        let report = stepper.step(sent[k]).unwrap();
        assert_eq!(report, del.step(&system, &mut state, &forces[k]).unwrap());
    }
    assert_eq!((stepper.q(), stepper.p()), (state.q(), state.p()));
}

/// The stepper returns the velocity at which it starts, up to rounding.
#[test]
fn velocities_come_back() {
    let bytes = Aligned::new(&file::golden());
    let mut stepper = Ideal::<Galerkin>::new(Cartpole::load(bytes.bytes()).unwrap()).unwrap();
    assert!(stepper.q().iter().chain(&stepper.p()).all(|x| x.is_nan()));
    assert_eq!(stepper.v(), Err(StepError::NotFinite));
    let [q, v] = begin();
    stepper.start(q, v).unwrap();
    assert_eq!(stepper.q(), q);
    stepper.v().unwrap().iter().zip(v).for_each(|(found, v)| assert!((found - v).abs() < 1e-5));
}

/// Asserts that two steppers have equal states and equal pending commands.
fn assert_same(mut a: Late, mut b: Late) {
    assert_eq!(a.state(), b.state());
    for u in [[0.5, -0.25], [0.125, 0.75], [-0.5, 0.0], [0.25, 1.0]] {
        assert_eq!((a.step(u), a.q(), a.p()), (b.step(u), b.q(), b.p()));
    }
}

#[test]
fn errors_leave_it_as_it_was() {
    let bytes = late();
    let mut stepper = Late::new(Cartpole::load(bytes.bytes()).unwrap()).unwrap();
    for _ in 0..5 {
        assert_eq!(stepper.step([1.0, 0.0]), Err(StepError::NotFinite), "it is not started");
    }
    let [q, v] = begin();
    stepper.start(q, v).unwrap();
    stepper.step([0.5, 0.25]).unwrap();
    for bad in [f32::NAN, f32::INFINITY, -f32::INFINITY, f32::MAX] {
        let (mut tried, bad) = (stepper, [0.25, bad]);
        let refused = Err(StepError::NotFinite);
        assert_eq!(tried.step(bad).map(drop), refused);
        assert_eq!(tried.commanded(bad), refused);
        assert_eq!(tried.start_from([q, q], bad), refused);
        if !bad[1].is_finite() {
            assert_eq!(tried.start(bad, v), refused);
            assert_eq!(tried.start(q, bad), refused);
            assert_eq!(tried.start_from([q, bad], [0.0; 2]), refused);
        }
        assert_same(tried, stepper);
    }
    let mut hasty = stepper.with_newton(Newton { max_iterations: 0, stop: 0.0, accept: 0.0 });
    assert!(matches!(hasty.step([2.0, 1.0]), Err(StepError::NotConverged(_))));
    assert_same(hasty.with_newton(Newton::new()), stepper);
}

#[test]
fn files_of_another_kind_are_refused() {
    let (held, linear) = (ControlKind::Held, ControlKind::Linear);
    let ideal = cartpole(step(Order::Four, 0.05, held), &[]);
    let model = Cartpole::load(ideal.bytes()).unwrap();
    assert!(Ideal::<Galerkin>::new(model).is_ok());
    let refused = |error: ModelError, words: &str| assert!(error.to_string().contains(words), "{error}");

    let error = Ideal::<Midpoint>::new(model).unwrap_err();
    assert_eq!(error, ModelError::Order { found: 4, compiled: 2 });
    let error = Stepper::<_, Galerkin, Drive<Linear, Direct, 2, 1>, 2>::new(model).unwrap_err();
    assert_eq!(error, ModelError::Control { found: held });
    refused(error, "trained with commands held, but this program takes them as linear");
    let error = Late::new(model).unwrap_err();
    assert_eq!(error, ModelError::Actuator { found: false });
    refused(error, "no actuator");

    let bytes = late();
    let error = Ideal::<Galerkin>::new(Cartpole::load(bytes.bytes()).unwrap()).unwrap_err();
    assert_eq!(error, ModelError::Actuator { found: true });
    refused(error, "has an actuator");
    let lagging = [&actuator(0.115, &PAIRS[..2])[..], &f32::to_le_bytes(0.008)].concat();
    let lagging = cartpole(step(Order::Four, 0.05, held), &lagging);
    let error = Late::new(Cartpole::load(lagging.bytes()).unwrap()).unwrap_err();
    assert_eq!(error, ModelError::Lag { found: true });
    refused(error, "has a lag");
    let error = Lagging::new(Cartpole::load(bytes.bytes()).unwrap()).unwrap_err();
    assert_eq!(error, ModelError::Lag { found: false });
    refused(error, "has no lag");
    assert_eq!(Lagging::new(model).unwrap_err(), ModelError::Actuator { found: false });
    let bytes = cartpole(step(Order::Four, 0.05, linear), &[]);
    let error = Ideal::<Galerkin>::new(Cartpole::load(bytes.bytes()).unwrap()).unwrap_err();
    refused(error, "linear between samples, but this program takes them as held");
    let bytes = cartpole(step(Order::Four, 0.05, held), &actuator(0.2, &PAIRS[..2]));
    let error = Late::new(Cartpole::load(bytes.bytes()).unwrap()).unwrap_err();
    assert_eq!(error, ModelError::Shape { what: "past commands of the actuator", found: 4, compiled: 3 });
    refused(error, "4 past commands of the actuator, but this program was compiled for 3");
}

#[test]
fn a_model_without_a_step_takes_any() {
    let bytes = cartpole(None, &[]);
    let model = Cartpole::load(bytes.bytes()).unwrap();
    assert_eq!(Ideal::<Galerkin>::new(model).unwrap_err(), ModelError::NoStep);
    for h in [0.0, -0.01, f32::NAN, f32::INFINITY] {
        assert_eq!(Ideal::<Galerkin>::with_step(model, h).unwrap_err(), sections::out_of_range("step h"));
    }
    let mut stepper = Ideal::<Galerkin>::with_step(model, 0.02).unwrap();
    let [q, v] = begin();
    stepper.start(q, v).unwrap();
    let (mut state, u) = (*stepper.state(), [0.25, 0.5]);
    let report = Del::<f32, Galerkin>::new(0.02).step(&model.system, &mut state, &Control::held(u));
    assert_eq!((stepper.step(u), stepper.state()), (report, &state));
}
