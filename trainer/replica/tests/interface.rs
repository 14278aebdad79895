//! Requests that are refused, repeated, delayed or handed on.

mod common;

use common::{GraphSample, InertiaNetworkSample, TREES, TreeSample, bytes, file, step};
use leastaction_core::discrete::{Order, StepError};
use leastaction_core::energy::inertia_network::Inertia;
use leastaction_core::energy::modular::PairInput;
use leastaction_core::forces::{Actuator, Lag};
use leastaction_core::model::{
    ActuatorBytes, CoordinateRange, Header, Interval, Laws, ModelError, Outside, TrainingRange,
};
use leastaction_core::network::Activation;
use leastaction_replica::{
    COORDINATES, Control, ModelFile, OfSize, ParticleSystem, ReplicaError, Step, SystemOf, Visitor,
};

fn arm(coordinates: &str, widths: [u16; 4]) -> InertiaNetworkSample {
    InertiaNetworkSample {
        coordinates: coordinates.to_owned(),
        widths,
        activation: Activation::Tanh,
        inertia: Inertia::Cholesky { epsilon: 0.1 },
        laws: Laws::FRICTION,
        seed: 3,
    }
}

/// Loads a file that must be refused.
fn refusal(bytes: &[u8], part: Option<&str>) -> ReplicaError {
    let file = match ModelFile::new(bytes) {
        Ok(file) => file,
        Err(error) => return error,
    };
    file.replica(part).err().expect("the file must be refused")
}

#[test]
fn every_truncation_and_every_changed_byte_is_refused() {
    let whole = arm("aa", [2, 0, 0, 0]).file(Order::Four);
    for length in 0..whole.len() {
        assert!(ModelFile::new(&whole[..length]).is_err(), "{length} bytes");
    }
    for i in 0..whole.len() {
        let mut damaged = whole.clone();
        damaged[i] ^= 0x10;
        assert!(ModelFile::new(&damaged).is_err(), "byte {i}");
    }
}

#[test]
fn too_many_coordinates_are_refused_with_the_limit() {
    let error = refusal(&arm(&"a".repeat(9), [4, 0, 0, 0]).file(Order::Four), None);
    assert_eq!(error, ReplicaError::Coordinates { found: 9 });
    assert_eq!(
        error.to_string(),
        "the model has 9 coordinates; the chip's arithmetic, in which sizes are types, is compiled here for 1, 2, 3, 4, 5, \
         6, 7, 8, 12"
    );
    let tree = TreeSample::chain(16, 4, PairInput::Distance, Laws::NONE, 0).file(Order::Two);
    assert_eq!(refusal(&tree, Some(TREES[1])), ReplicaError::Coordinates { found: 16 });
}

#[test]
fn too_many_units_are_refused_with_the_limit() {
    let too_wide = |found, compiled| {
        let what = "units in a hidden layer";
        ReplicaError::Model(ModelError::Shape { what, found, compiled })
    };
    assert_eq!(refusal(&arm("a", [1025, 0, 0, 0]).file(Order::Four), None), too_wide(1025, 1024));
    let tree = TreeSample::chain(2, 65, PairInput::Distance, Laws::NONE, 0).file(Order::Two);
    assert_eq!(refusal(&tree, None), too_wide(65, 64));
    assert_eq!(refusal(&GraphSample::row(3, 4, 65, 0).file(Order::Two), None), too_wide(65, 64));
}

#[test]
fn the_widest_model_that_is_taken_can_be_stepped() {
    let file = ModelFile::new(&arm("aaaaaaaaaaaa", [1024, 1024, 5, 0]).file(Order::Four)).unwrap();
    let (chip, rest) = (file.replica(None).unwrap(), [0.0; 12]);
    let mut motion = chip.motion_at(step(Order::Four).into(), &rest, &rest).unwrap();
    assert!(motion.step(Control::held(&rest)).is_ok());
}

#[test]
fn a_part_that_is_not_there_is_refused() {
    let tree = TreeSample::chain(3, 4, PairInput::Distance, Laws::NONE, 0).file(Order::Two);
    assert_eq!(refusal(&tree, Some("leg")), ReplicaError::Model(ModelError::NoSuchTree { trees: 2 }));
    let graph = GraphSample::row(2, 3, 4, 0).file(Order::Two);
    assert_eq!(refusal(&graph, Some("leg")), ReplicaError::Model(ModelError::NoSuchGraph { graphs: 2 }));
    let file = ModelFile::new(&tree).unwrap();
    assert_eq!([None, Some(TREES[0]), Some(TREES[1])].map(|part| file.replica(part).unwrap().n()), [1, 1, 3]);
}

#[test]
fn slices_of_another_length_are_refused_and_change_nothing() {
    let files = [arm("aa", [4, 0, 0, 0]).file(Order::Four), GraphSample::row(2, 1, 4, 0).file(Order::Four)];
    for bytes in files {
        let file = ModelFile::new(&bytes).unwrap();
        let chip = file.replica(None).unwrap();
        let (two, three) = ([0.5; 2], [0.5; 3]);
        let length = |what| ReplicaError::Length { what, expected: 2, found: 3 };
        let mut evaluator = chip.evaluator().unwrap();
        assert_eq!(evaluator.energies(&two, &three), Err(length("v")));
        assert_eq!(evaluator.acceleration(&two, &two, &three, &mut [0.0; 2]), Err(length("tau")));
        assert_eq!(evaluator.inverse_dynamics(&three, &two, &two, &mut [0.0; 2]), Err(length("q")));
        assert_eq!(chip.outside(&two, &two, &three), Err(length("u")));
        assert_eq!(chip.motion_at(step(Order::Two).into(), &three, &two).err(), Some(length("q")));
        let mut motion = chip.motion_at(step(Order::Two).into(), &two, &two).unwrap();
        assert_eq!(motion.step(Control { start: &two, end: &three }), Err(length("tau")));
        assert_eq!(motion.q(), two);
    }
}

#[test]
fn a_step_that_cannot_be_solved_leaves_the_motion_where_it_was() {
    let file = ModelFile::new(&arm("aa", [4, 0, 0, 0]).file(Order::Four)).unwrap();
    let chip = file.replica(None).unwrap();
    let mut motion = chip.motion_at(step(Order::Four).into(), &[0.1, 0.2], &[0.3, 0.4]).unwrap();
    let before = [motion.q().to_vec(), motion.p().to_vec()];
    let infinite = motion.step(Control::held(&[f32::INFINITY, 0.0]));
    assert_eq!(infinite, Err(ReplicaError::Step(StepError::NotFinite)));
    assert_eq!([motion.q().to_vec(), motion.p().to_vec()], before);
    assert!(motion.step(Control::held(&[0.1, 0.0])).is_ok());
}

#[test]
fn a_motion_continues_from_its_numbers_with_the_same_bits() {
    let files = [arm("taa", [9, 5, 0, 0]).file(Order::Four), GraphSample::row(2, 1, 4, 0).file(Order::Four)];
    for (bytes, order) in files.iter().flat_map(|bytes| [(bytes, Order::Two), (bytes, Order::Four)]) {
        let file = ModelFile::new(bytes).unwrap();
        let chip = file.replica(None).unwrap();
        let (q, v) = (vec![0.1; chip.n()], vec![0.3; chip.n()]);
        let force = vec![0.5; chip.n()];
        let mut whole = chip.motion_at(step(order).into(), &q, &v).unwrap();
        for _ in 0..20 {
            let mut resumed = chip.motion_resumed(step(order).into(), &whole.saved()).unwrap();
            whole.step(Control::held(&force)).unwrap();
            resumed.step(Control::held(&force)).unwrap();
            assert_eq!(resumed.saved(), whole.saved());
        }
        let short = whole.saved().len() - 1;
        assert!(chip.motion_resumed(step(order).into(), &whole.saved()[..short]).is_err());
        let nan = vec![f32::NAN; whole.saved().len()];
        assert!(chip.motion_resumed(step(order).into(), &nan).is_err());
    }
}

#[test]
fn the_same_motion_repeats_and_its_velocity_belongs_to_its_momentum() {
    let file = ModelFile::new(&arm("taa", [9, 5, 0, 0]).file(Order::Four)).unwrap();
    let run = || {
        let chip = file.replica(None).unwrap();
        let mut motion =
            chip.motion_at(step(Order::Four).into(), &[0.1, 0.2, 0.3], &[1.0, -1.0, 0.5]).unwrap();
        let mut v = [0.0; 3];
        motion.velocity(&mut v).unwrap();
        for (v, expected) in v.iter().zip([1.0, -1.0, 0.5]) {
            assert!((v - expected).abs() < 1e-5, "{v} instead of {expected}");
        }
        for _ in 0..50 {
            motion.step(Control::held(&[0.5, 0.0, -0.25])).unwrap();
        }
        [motion.q().to_vec(), motion.p().to_vec()]
    };
    assert_eq!(run(), run());
}

/// 0.5 rad on either side of 0 and of all whole turns, 2 rad/s, 3 N m.
fn range() -> [CoordinateRange; 2] {
    let within = |x: f32| Interval { least: -x, most: x };
    [std::f32::consts::TAU, 0.0].map(|period| CoordinateRange {
        q: within(0.5),
        v: within(2.0),
        u: within(3.0),
        period,
    })
}

#[test]
fn what_lies_outside_of_the_training_data_is_named() {
    let sample = arm("ta", [4, 0, 0, 0]);
    let bytes: Vec<u8> = range().iter().flat_map(|range| range.to_bytes()).collect();
    let header = Header { range: Some(TrainingRange::new(&bytes).unwrap()), ..sample.header(Order::Two) };
    let bytes = file(&header, &sample.weights());
    let file = ModelFile::new(&bytes).unwrap();
    let chip = file.replica(None).unwrap();
    let outside = |coordinate, quantity| Ok(Some(Outside { coordinate, quantity }));
    assert_eq!(chip.outside(&[6.2, 0.4], &[1.0; 2], &[-3.0; 2]), Ok(None));
    assert_eq!(chip.outside(&[6.2, 6.2], &[1.0; 2], &[0.0; 2]), outside(1, 'q'));
    assert_eq!(chip.outside(&[0.0; 2], &[2.5, 0.0], &[4.0; 2]), outside(0, 'v'));
    assert_eq!(chip.outside(&[0.0; 2], &[0.0; 2], &[0.0, f32::NAN]), outside(1, 'u'));
}

/// A model of two coordinates with these drives.
fn driven(actuator: ActuatorBytes) -> ModelFile {
    let sample = arm("ta", [4, 0, 0, 0]);
    let header = Header { actuator: Some(actuator), ..sample.header(Order::Two) };
    let weights: Vec<u8> = sample.weights().iter().flat_map(|w| w.to_le_bytes()).collect();
    ModelFile::new(&bytes(&header, &weights)).unwrap()
}

/// A delay of a step and a half: the file's actuator acts as core's does on the commands that have arrived.
#[test]
fn commands_act_as_the_actuator_of_the_file_says() {
    let numbers = [0.015_f32, 2.0, 0.5, -3.0, 0.25];
    let own: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
    let actuator = ActuatorBytes::new(&own).unwrap();
    let file = driven(actuator);
    let chip = file.replica(None).unwrap();
    let (late, core): (u16, Actuator<f32, 2>) = actuator.at_step(0.01).unwrap();
    assert_eq!(late, 1);
    let u = [[0.0; 2], [0.0; 2], [1.0, 2.0], [3.0, -1.0], [0.5, 0.75], [2.5, 4.0]];
    let (mut held, mut linear) = (chip.actuators(0.01).unwrap(), chip.actuators(0.01).unwrap());
    for k in 2..5 {
        let expected = core.held(&u[k - 2], &u[k - 1]);
        let found = held.held(&u[k]).unwrap();
        assert_eq!((found.start, found.end), (&expected.start[..], &expected.end[..]));
        let expected = core.linear(&u[k - 2], &u[k - 1], &u[k]);
        let found = linear.linear(&u[k], &u[k + 1]).unwrap();
        assert_eq!((found.start, found.end), (&expected.start[..], &expected.end[..]));
    }
}

#[test]
fn lagging_commands_have_the_bits_of_core() {
    let numbers = [0.015_f32, 2.0, 0.5, -3.0, 0.25, 0.008];
    let own: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
    let actuator = ActuatorBytes::new(&own).unwrap();
    let file = driven(actuator);
    let chip = file.replica(None).unwrap();
    let (late, core, lag): (u16, Actuator<f32, 2>, Lag<f32>) = actuator.at_step_with_lag(0.01).unwrap();
    assert_eq!(late, 1);
    // Two samples before the first are those that preceded it.
    for before in [None, Some([0.75, -1.5])] {
        let first = before.unwrap_or_default();
        let u = [first, first, [1.0, 2.0], [3.0, -1.0], [0.5, 0.75], [2.5, 4.0]];
        let (mut held, mut linear) = (chip.actuators(0.01).unwrap(), chip.actuators(0.01).unwrap());
        for actuators in [&mut held, &mut linear] {
            before.iter().for_each(|u| actuators.take_past(u).unwrap());
        }
        let (mut y, mut of_linear) = (first, first);
        for k in 2..5 {
            let (expected, end) = core.lagging(|i| lag.held(y[i], u[k - 2][i], u[k - 1][i]));
            let found = held.held(&u[k]).unwrap();
            assert_eq!((found.start, found.end), (&expected.start[..], &expected.end[..]));
            y = end;
            let (expected, end) =
                core.lagging(|i| lag.linear(of_linear[i], [u[k - 2][i], u[k - 1][i], u[k][i]]));
            let found = linear.linear(&u[k], &u[k + 1]).unwrap();
            assert_eq!((found.start, found.end), (&expected.start[..], &expected.end[..]));
            of_linear = end;
        }
    }
}

#[test]
fn without_an_actuator_the_command_is_the_force() {
    let file = ModelFile::new(&arm("a", [4, 0, 0, 0]).file(Order::Four)).unwrap();
    let chip = file.replica(None).unwrap();
    let mut actuators = chip.actuators(0.01).unwrap();
    assert_eq!(actuators.linear(&[1.5], &[2.5]), Ok(Control { start: &[1.5], end: &[2.5] }));
    assert_eq!(
        actuators.held(&[1.5, 2.5]).err(),
        Some(ReplicaError::Length { what: "u", expected: 1, found: 2 })
    );
}

#[test]
fn a_chip_is_of_one_size() {
    let file = ModelFile::new(&arm("taa", [4, 0, 0, 0]).file(Order::Four)).unwrap();
    let chip = file.replica(None).unwrap();
    let (two, three) = (OfSize::<2>::of_size(&chip), OfSize::<3>::of_size(&chip));
    assert!(two.is_none() && three.is_some_and(|system| system.forces.damping().iter().all(|c| *c > 0.0)));
}

/// A visitor that names the type it was given.
struct Named;

impl Visitor<'_> for Named {
    type Output = String;

    fn coordinates<const N: usize>(self, _: &SystemOf<N>) -> String {
        format!("{N} coordinates")
    }

    fn particles<const D: usize>(self, particles: &ParticleSystem<D>) -> String {
        format!("{} particles in {D} dimensions", particles.graph.nodes().len())
    }
}

#[test]
fn every_size_is_a_type_to_a_visitor() {
    let name = |bytes: &[u8]| ModelFile::new(bytes).unwrap().replica(None).unwrap().visit(Named);
    for n in COORDINATES {
        assert_eq!(name(&arm(&"a".repeat(n), [3, 0, 0, 0]).file(Order::Four)), format!("{n} coordinates"));
    }
    assert_eq!(name(&GraphSample::row(2, 70, 3, 0).file(Order::Two)), "70 particles in 2 dimensions");
    assert_eq!(name(&GraphSample::row(3, 300, 3, 0).file(Order::Two)), "300 particles in 3 dimensions");
}

#[test]
fn the_step_of_the_file_is_told() {
    let file = ModelFile::new(&arm("a", [4, 0, 0, 0]).file(Order::Two)).unwrap();
    let trained = file.replica(None).unwrap().trained_step();
    assert_eq!(trained.map(Step::from), Some(Step { order: Order::Two, h: 0.01 }));
}
