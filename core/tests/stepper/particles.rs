//! Graphs with rods.

use crate::common::file::{self, Aligned};
use crate::{actuator, commands, naive, step, with};
use leastaction_core::constraints::{ConstraintError, Holonomic};
use leastaction_core::discrete::rattle::ParticleState;
use leastaction_core::discrete::{Newton, Order, Report};
use leastaction_core::energy::graph::{Edge, GraphError};
use leastaction_core::forces::{Actuator, ControlKind};
use leastaction_core::model::{GraphModel, Header, ModelError, TrainedStep};
use leastaction_core::stepper::{
    Actuated, Actuation, Direct, Drive, Held, Kind, Linear, ParticleMemory, ParticleStepper, particle_numbers,
};

/// Three nodes in the plane, three edges and two rods, with messages of two numbers.
type Web<'a> = GraphModel<'a, 2, 6, 5, 1>;
type Webs<'a, K, A, const PAST: usize> = ParticleStepper<'a, Web<'a>, Drive<K, A, 6, PAST>, 2, 6>;
const NUMBERS: usize = particle_numbers::<2>(3, 2, 1, 3 * 4);
type Memory<const NUMBERS: usize> = ParticleMemory<2, 3, 2, NUMBERS>;

/// Positions on rods of 0.5 and 2 m.
const Q: [f32; 6] = [0.3, -0.4, 1.0, 1.0, 1.5, -2.0];
const V: [f32; 6] = [0.0, 0.0, 0.2, -0.1, 0.0, 0.0];

/// q, p, and the report of a step.
type Seen = ([f32; 6], [f32; 6], Report<f32>);

fn web(trained_step: Option<TrainedStep>, actuator: &[u8]) -> Aligned {
    let header = Header { trained_step, ..with(file::web_header(file::web()), actuator) };
    Aligned::new(&file::write(header, &file::web_weights(file::WEB_NUMBERS)))
}

fn flat(vectors: &[[f32; 2]]) -> [f32; 6] {
    vectors.as_flattened().try_into().unwrap()
}

/// Steps with separate calls under the given forces.
fn by_hand(bytes: &[u8], forces: &[[f32; 6]]) -> Vec<Seen> {
    let (mut edges, mut rods) = ([Edge::default(); 3], [Holonomic::default(); 2]);
    let model = Web::load(bytes, "ring", &mut edges, &mut rods).unwrap();
    let (mechanism, rattle) = (model.system.constrained().unwrap(), model.rattle::<f32>().unwrap());
    let (mut numbers, mut workspace) = ([0.0; 256], [0.0; 256]);
    let (q, v) = (Q.as_chunks().0, V.as_chunks().0);
    let mut state = ParticleState::new(&mechanism, q, v, &mut numbers, &mut workspace).unwrap();
    let step = |force: &[f32; 6]| {
        let force = Some(force.as_chunks().0);
        let report = rattle.step(&mechanism, &mut state, force, &mut workspace).unwrap();
        (flat(state.q()), flat(state.p()), report)
    };
    forces.iter().map(step).collect()
}

fn by_stepper<K: Kind, A: Actuation<6>, const PAST: usize>(bytes: &[u8], commands: &[[f32; 6]]) -> Vec<Seen> {
    let mut memory = Memory::<NUMBERS>::new();
    let mut stepper = Webs::<K, A, PAST>::new(bytes, "ring", &mut memory).unwrap();
    stepper.start(Q, V).unwrap();
    let step = |u: &[f32; 6]| {
        let report = stepper.step(*u).unwrap();
        (stepper.q(), stepper.p(), report)
    };
    commands.iter().map(step).collect()
}

#[test]
fn steps_are_those_of_rattle_by_hand() {
    let commands = commands::<6>(17);
    for order in [Order::Two, Order::Four] {
        let bytes = web(step(order, 0.01, ControlKind::Held), &[]);
        let found = by_stepper::<Held, Direct, 0>(bytes.bytes(), &commands);
        assert_eq!(found, by_hand(bytes.bytes(), &commands));

        let bytes = web(step(order, 0.01, ControlKind::Linear), &[]);
        let starts = [&[[0.0; 6]], &commands[..]].concat();
        let mean = |(a, b): (&[f32; 6], &[f32; 6])| core::array::from_fn(|i| a[i] * 0.5 + b[i] * 0.5);
        let forces: Vec<_> = starts.iter().zip(&commands).map(mean).collect();
        let found = by_stepper::<Linear, Direct, 1>(bytes.bytes(), &commands);
        assert_eq!(found, by_hand(bytes.bytes(), &forces));
    }
}

const PAIRS: [[f32; 2]; 6] = [[0.8, 0.05], [1.25, -0.1], [-0.5, 0.2], [1.5, 0.1], [2.0, 0.0], [0.75, -0.05]];

/// The actuator with a delay of 2.3 steps.
fn late(kind: ControlKind) -> (Aligned, Vec<[f32; 6]>) {
    let bytes = web(step(Order::Two, 0.01, kind), &actuator(0.023, &PAIRS));
    let mut of_actuator = Actuator::ideal();
    (of_actuator.gain, of_actuator.offset) = (PAIRS.map(|[gain, _]| gain), PAIRS.map(|[_, offset]| offset));
    of_actuator.delay = 0.023_f32 / 0.01 - 2.0;
    let forces = naive(kind, (2, of_actuator), &commands::<6>(19));
    (bytes, forces.iter().map(|control| control.at(0.5)).collect())
}

#[test]
fn actuators_with_delays_are_a_naive_loop() {
    let (bytes, forces) = late(ControlKind::Held);
    let found = by_stepper::<Held, Actuated<6>, 3>(bytes.bytes(), &commands::<6>(19));
    assert_eq!(found, by_hand(bytes.bytes(), &forces));
    let (bytes, forces) = late(ControlKind::Linear);
    let found = by_stepper::<Linear, Actuated<6>, 5>(bytes.bytes(), &commands::<6>(19));
    assert_eq!(found, by_hand(bytes.bytes(), &forces));
}

#[test]
fn two_positions_start_as_rattle_does() {
    let bytes = web(step(Order::Four, 0.01, ControlKind::Held), &[]);
    let u = [0.5, 0.25, -0.5, 0.0, 0.125, 0.75];
    let q1 = by_hand(bytes.bytes(), &[u])[0].0;
    let (mut edges, mut rods) = ([Edge::default(); 3], [Holonomic::default(); 2]);
    let model = Web::load(bytes.bytes(), "ring", &mut edges, &mut rods).unwrap();
    let (mechanism, rattle) = (model.system.constrained().unwrap(), model.rattle::<f32>().unwrap());
    let (mut numbers, mut workspace) = ([0.0; 256], [0.0; 256]);
    let [from, to, force] = [&Q, &q1, &u].map(|x| x.as_chunks().0);
    let by_hand = rattle.start(&mechanism, [from, to], Some(force), &mut numbers, &mut workspace).unwrap();
    let mut memory = Memory::<NUMBERS>::new();
    let mut stepper = Webs::<Held, Direct, 0>::new(bytes.bytes(), "ring", &mut memory).unwrap();
    stepper.start_from([Q, q1], u).unwrap();
    assert_eq!([stepper.q(), stepper.v(), stepper.p()], [by_hand.q(), by_hand.v(), by_hand.p()].map(flat));
    assert_eq!(stepper.state().lambda(), by_hand.lambda());
}

#[test]
fn errors_leave_it_as_it_was() {
    let bytes = late(ControlKind::Held).0;
    let mut memories = [Memory::<NUMBERS>::new(), Memory::new()];
    let mut both = memories
        .each_mut()
        .map(|memory| Webs::<Held, Actuated<6>, 3>::new(bytes.bytes(), "ring", memory).unwrap());
    let refused = Err(ConstraintError::NotFinite);
    for stepper in &mut both {
        assert_eq!(stepper.step([0.0; 6]).map(drop), refused, "it is not started");
        assert!(stepper.q().iter().chain(&stepper.v()).all(|x| x.is_nan()));
        stepper.start(Q, V).unwrap();
        stepper.step([0.5; 6]).unwrap();
    }
    let [tried, kept] = &mut both;
    let bad = [f32::NAN; 6];
    assert_eq!(tried.step(bad).map(drop), refused);
    assert_eq!(tried.commanded(bad), refused);
    assert_eq!(tried.start(bad, V), refused);
    assert_eq!(tried.start(Q, bad), refused);
    assert!(matches!(tried.start([0.5; 6], V), Err(ConstraintError::Off { .. })));
    for k in 0..4 {
        let u = [0.1 * k as f32; 6];
        assert_eq!((tried.step(u), tried.q(), tried.p()), (kept.step(u), kept.q(), kept.p()));
    }
    assert!(tried.start_from([Q, [9.0; 6]], [0.0; 6]).is_err());
    assert_eq!(tried.step([0.0; 6]).map(drop), refused, "it must be started again");
    tried.start(Q, V).unwrap();
    tried.step([0.0; 6]).unwrap();
}

#[test]
fn bounds_of_newton_are_the_caller_s() {
    let bytes = web(step(Order::Two, 0.01, ControlKind::Held), &[]);
    let mut memory = Memory::<NUMBERS>::new();
    let stepper = Webs::<Held, Direct, 0>::new(bytes.bytes(), "ring", &mut memory).unwrap();
    let mut stepper = stepper.with_newton(Newton { max_iterations: 0, stop: 0.0, accept: 0.0 });
    stepper.start(Q, V).unwrap();
    assert!(matches!(stepper.step([0.5; 6]), Err(ConstraintError::NotConverged(_))));
    assert_eq!(stepper.q(), Q);
}

#[test]
fn files_and_memories_that_do_not_fit_are_refused() {
    let bytes = web(step(Order::Two, 0.01, ControlKind::Held), &[]);
    let refused = |error: ModelError, expected: ModelError| assert_eq!(error, expected);
    let mut small = Memory::<{ NUMBERS - 1 }>::new();
    refused(
        Webs::<Held, Direct, 0>::new(bytes.bytes(), "ring", &mut small).unwrap_err(),
        ModelError::Shape { what: "numbers of memory", found: NUMBERS, compiled: NUMBERS - 1 },
    );
    let mut tiny = Memory::<3>::new();
    refused(
        Webs::<Held, Direct, 0>::new(bytes.bytes(), "ring", &mut tiny).unwrap_err(),
        ModelError::Shape { what: "numbers of memory", found: NUMBERS, compiled: 3 },
    );
    let mut memory = Memory::<NUMBERS>::new();
    refused(
        Webs::<Linear, Direct, 1>::new(bytes.bytes(), "ring", &mut memory).unwrap_err(),
        ModelError::Control { found: ControlKind::Held },
    );
    refused(
        Webs::<Held, Actuated<6>, 3>::new(bytes.bytes(), "ring", &mut memory).unwrap_err(),
        ModelError::Actuator { found: false },
    );
    type Pair<'a> = ParticleStepper<'a, Web<'a>, Drive<Held, Direct, 6, 0>, 2, 6>;
    refused(
        Pair::new(bytes.bytes(), "pair", &mut memory).unwrap_err(),
        ModelError::Graph(GraphError::Coordinates { found: 4, compiled: 6 }),
    );
    let free = web(None, &[]);
    refused(Pair::new(free.bytes(), "ring", &mut memory).unwrap_err(), ModelError::NoStep);
    refused(
        Pair::with_step(free.bytes(), "ring", &mut memory, -1.0).unwrap_err(),
        ModelError::OutOfRange { what: "step h" },
    );
    let mut stepper = Pair::with_step(free.bytes(), "ring", &mut memory, 0.01).unwrap();
    stepper.start(Q, V).unwrap();
    let trained = web(step(Order::Four, 0.01, ControlKind::Held), &[]);
    let report = stepper.step([0.25; 6]).unwrap();
    assert_eq!((stepper.q(), stepper.p(), report), by_hand(trained.bytes(), &[[0.25; 6]])[0]);
}
