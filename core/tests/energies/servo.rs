//! Position servos: derivatives, inverse dynamics, and the motion of a drive that pulls toward its command.

use crate::common::dual::Dual;
use crate::common::{Random, assert_vectors_close};
use crate::forces::{check_derivatives, check_inverse_under};
use leastaction_core::continuous::{acceleration, inverse_dynamics};
use leastaction_core::discrete::{Control, Del, Midpoint, State};
use leastaction_core::energy::trigonometric::CARTPOLE;
use leastaction_core::forces::{Forces, Servo, System, Viscous};
use leastaction_core::scalar::Scalar;

fn servo<S: Scalar, const N: usize>() -> Servo<S, N> {
    Servo { stiffness: Some(core::array::from_fn(|i| S::constant(7.0 - 1.5 * i as f64))) }
}

#[test]
fn derivatives_are_those_of_dual_numbers() {
    check_derivatives("servo", servo::<f64, 3>(), &servo::<Dual, 3>(), 1);
}

#[test]
fn a_command_is_found_from_an_acceleration() {
    let viscous = Viscous { coefficients: [0.4, 0.9] };
    check_inverse_under(&CARTPOLE, servo());
    check_inverse_under(&CARTPOLE, (viscous, servo()));
    check_inverse_under(&CARTPOLE, (servo(), viscous));
    // Without servos the command is a force, and nothing is added to it.
    check_inverse_under(&CARTPOLE, (viscous, Servo::none()));
    assert_eq!(Servo::none().force(&[0.3, 0.4], &[1.0; 2], &[5.0; 2]), [0.0; 2]);
}

/// k (u − q) − d v as a force gives the same acceleration.
#[test]
fn the_drive_pulls_toward_its_command() {
    let (viscous, servo) = (Viscous { coefficients: [0.4, 0.9] }, servo());
    let stiffness = servo.stiffness.unwrap();
    let system = System { lagrangian: CARTPOLE, forces: (viscous, servo) };
    let mut random = Random(3);
    for _ in 0..20 {
        let [q, v, u] = [random.array::<2>(2.0), random.array(2.0), random.array(2.0)];
        let force = core::array::from_fn(|i| stiffness[i] * (u[i] - q[i]) - viscous.coefficients[i] * v[i]);
        let expected = acceleration(&System::conservative(CARTPOLE), &q, &v, &force).unwrap();
        assert_vectors_close("v̇", &acceleration(&system, &q, &v, &u).unwrap(), &expected, 1e-12);
    }
}

/// A held command, once the motion has died away, is where the drive pulls: q = u where nothing else acts.
#[test]
fn steps_come_to_rest_at_the_command() {
    let system = System { lagrangian: CARTPOLE, forces: (Viscous { coefficients: [3.0, 2.0] }, servo()) };
    let command = [0.4, 0.0];
    let del = Del::<f64, Midpoint>::new(0.01);
    let mut state = State::new(&CARTPOLE, [0.0; 2], [0.0; 2]).unwrap();
    for _ in 0..3_000 {
        del.step(&system, &mut state, &Control::held(command)).unwrap();
    }
    assert_vectors_close("q", &state.q(), &command, 1e-6);
}

#[test]
fn a_drive_without_stiffness_has_no_command() {
    let servo = Servo { stiffness: Some([5.0, 0.0]) };
    let system = System { lagrangian: CARTPOLE, forces: servo };
    assert!(inverse_dynamics(&system, &[0.1, 0.2], &[0.3, 0.4], &[1.0, 2.0]).is_err());
}
