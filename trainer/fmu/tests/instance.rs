//! Instances without an importer.

mod common;

use common::model;
use leastaction_fmu::{FmuError, Instance, Interface, Kind, Phase, State, Unit, Variable};
use leastaction_replica::{Control, ModelFile};

fn reference(kind: Kind, index: usize) -> u32 {
    Variable { kind, index }.reference()
}

fn instance(name: &str, interface: Interface) -> Instance {
    let unit = Unit::new(&model(name)).unwrap();
    let token = unit.token();
    Instance::new(unit, interface, &token).unwrap()
}

/// An instance of a cart-pole after its initialisation at q = (0.1, 3), v = (−0.2, 0.5).
fn cartpole(interface: Interface) -> Instance {
    let mut own = instance("cartpole", interface);
    let start = |index| [reference(Kind::StartPosition, index), reference(Kind::StartVelocity, index)];
    own.set(&[start(0), start(1)].concat(), &[0.1, -0.2, 3.0, 0.5]).unwrap();
    own.set_start(2.0).unwrap();
    own.enter_initialization().unwrap();
    own.exit_initialization().unwrap();
    own
}

fn positions(own: &Instance) -> [f32; 2] {
    let found = own.get(&[reference(Kind::Position, 0), reference(Kind::Position, 1)]).unwrap();
    [found[0] as f32, found[1] as f32]
}

#[test]
fn co_simulation_has_the_bits_of_core() {
    let file = ModelFile::new(&model("cartpole")).unwrap();
    let chip = file.replica(None).unwrap();
    let step = chip.trained_step().unwrap();
    let mut motion = chip.motion_at(step.into(), &[0.1, 3.0], &[-0.2, 0.5]).unwrap();
    let mut own = cartpole(Interface::CoSimulation);
    let h = Unit::new(&model("cartpole")).unwrap().h().unwrap();
    for k in 0..300 {
        let u = (0.013 * k as f32).sin();
        own.set(&[reference(Kind::Force, 0)], &[u.into()]).unwrap();
        own.do_step(2.0 + h * f64::from(k), h).unwrap();
        motion.step(Control::held(&[u, 0.0])).unwrap();
        assert_eq!(positions(&own), motion.q(), "step {k}");
    }
}

#[test]
fn times_are_sums_with_rounding_errors() {
    let mut own = instance("cartpole", Interface::CoSimulation);
    let h = Unit::new(&model("cartpole")).unwrap().h().unwrap();
    // At such a time, every addition of a step is rounded by up to 1e-10 s.
    let mut t = 1e6;
    own.set_start(t).unwrap();
    own.enter_initialization().unwrap();
    own.exit_initialization().unwrap();
    for _ in 0..200 {
        own.do_step(t, 2.0 * h).unwrap();
        t += 2.0 * h;
    }
    assert!(own.time() != t && (own.time() - t).abs() < 1e-3 * h);
    assert!(matches!(own.do_step(t, 2.01 * h), Err(FmuError::Remainder { .. })));
    assert!(matches!(own.do_step(t, 1e12), Err(FmuError::CommunicationStep(_))));
    assert!(own.do_step(t, 0.0).is_ok());
}

#[test]
fn a_state_survives_its_bytes_and_damage_is_noticed() {
    let mut own = cartpole(Interface::CoSimulation);
    let h = Unit::new(&model("cartpole")).unwrap().h().unwrap();
    own.do_step(2.0, 3.0 * h).unwrap();
    let bytes = own.state().to_bytes().unwrap();
    assert_eq!(&State::from_bytes(&bytes).unwrap(), own.state());
    for i in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[i] ^= 0x10;
        assert!(State::from_bytes(&damaged).is_err(), "byte {i}");
        assert!(State::from_bytes(&bytes[..i]).is_err(), "{i} bytes");
    }
    for mut other in [instance("double", Interface::CoSimulation), cartpole(Interface::ModelExchange)] {
        assert!(matches!(other.restore(own.state()), Err(FmuError::OtherState)));
    }
}

#[test]
fn a_model_without_a_step_has_one_as_a_parameter() {
    let h = reference(Kind::Step, 0);
    let mut own = instance("arm", Interface::CoSimulation);
    assert_eq!(Unit::new(&model("arm")).unwrap().h(), None);
    assert_eq!(own.get(&[h]).unwrap(), [Unit::DEFAULT_H]);
    assert!(matches!(own.set(&[h], &[0.0]), Err(FmuError::StepSize(_))));
    own.set(&[h], &[0.002]).unwrap();
    own.enter_initialization().unwrap();
    own.exit_initialization().unwrap();
    assert!(matches!(own.do_step(0.0, 0.001), Err(FmuError::Remainder { .. })));
    own.do_step(0.0, 0.004).unwrap();
    assert_eq!(own.time(), 0.004);
}

#[test]
fn calls_out_of_order_are_refused() {
    let mut own = instance("cartpole", Interface::ModelExchange);
    let order = |error: Result<(), FmuError>, expected| {
        assert!(matches!(error, Err(FmuError::Order { phase, .. }) if phase == expected), "{error:?}");
    };
    order(own.exit_initialization(), Phase::Instantiated);
    order(own.enter_continuous_time_mode(), Phase::Instantiated);
    order(own.set_time(0.0), Phase::Instantiated);
    order(own.terminate(), Phase::Instantiated);
    own.enter_initialization().unwrap();
    order(own.set_start(1.0), Phase::Initialization);
    order(own.enter_initialization(), Phase::Initialization);
    own.exit_initialization().unwrap();
    order(own.completed_integrator_step(), Phase::Event);
    own.enter_continuous_time_mode().unwrap();
    order(own.update_discrete_states(), Phase::ContinuousTime);
    assert!(matches!(own.do_step(0.0, 0.01), Err(FmuError::OtherInterface { .. })));
    own.terminate().unwrap();
    order(own.set_continuous_states(&[0.0; 4]), Phase::Terminated);
    own.reset().unwrap();
    own.enter_initialization().unwrap();
}
