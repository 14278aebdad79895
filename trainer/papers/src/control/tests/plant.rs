use super::check_derivatives;
use crate::baselines::oracle::{Dual, equation};
use crate::control::driven::Driven;
use crate::control::learned::from_simulated;
use crate::control::model::Model;
use crate::control::plant::{DoublePendulum, State};
use crate::control::policy::Robot;
use nalgebra::DVector;
use num_dual::DualNum;

/// A pendulum none of whose numbers is 0 or equals another.
fn full() -> DoublePendulum {
    DoublePendulum {
        rotor: 6.3e-5,
        damping: [0.001, 0.02],
        coulomb: [0.16, 0.12],
        ..DoublePendulum::competition()
    }
}

/// Kinetic less potential energy of the bodies in the plane and of their rotors, from the speeds of their centres. The rotor of joint 2 sits
/// on link 1 and turns against it.
fn lagrangian(p: &DoublePendulum, x: &[Dual]) -> Dual {
    let ([q1, q2], [v1, v2]) = ([x[0], x[1]], [x[2], x[3]]);
    let (angle, turn) = (q1 + q2, v1 + v2);
    // Along x and upwards: position (s, −c), velocity v (c, s).
    let speed = |r: f64, q: Dual, v: Dual| [q.cos() * v * r, q.sin() * v * r];
    let square = |[x, y]: [Dual; 2]| x * x + y * y;
    let [elbow, second] = [speed(p.length[0], q1, v1), speed(p.centre[1], angle, turn)];
    let first = square(speed(p.centre[0], q1, v1)) * p.mass[0];
    let second = square([elbow[0] + second[0], elbow[1] + second[1]]) * p.mass[1];
    let about_centre = |i: usize| p.inertia[i] - p.mass[i] * p.centre[i] * p.centre[i];
    let turning = v1 * v1 * about_centre(0) + turn * turn * about_centre(1);
    let rotors = (v1 * p.gear).powi(2) + (v1 - v2 * p.gear).powi(2);
    let heights = q1.cos() * -(p.mass[0] * p.centre[0] + p.mass[1] * p.length[0])
        - angle.cos() * (p.mass[1] * p.centre[1]);
    (first + second + turning + rotors * p.rotor) * 0.5 - heights * p.gravity
}

const STATES: [State; 3] = [[0.3, -1.2, 2.0, -3.5], [2.9, 0.7, -6.0, 11.0], [-4.0, 2.5, 0.02, -0.01]];

#[test]
fn accelerations_are_those_of_the_lagrangian_and_of_friction() {
    let pendulum = full();
    for (x, tau) in STATES.into_iter().zip([[1.5, -0.4], [0.0, 6.0], [-2.0, 0.3]]) {
        let (mass, force) = equation(|x| lagrangian(&pendulum, x), [&x[..2], &x[2..]]);
        let friction = |i: usize| {
            let v = x[2 + i];
            pendulum.damping[i] * v + pendulum.coulomb[i] * (100.0 * v).atan()
        };
        let force = force + DVector::from_fn(2, |i, _| tau[i] - friction(i));
        let wanted = mass.lu().solve(&force).unwrap();
        for (a, wanted) in pendulum.acceleration(x, tau).into_iter().zip(wanted.iter()) {
            assert!((a - wanted).abs() < 1e-9 * (1.0 + wanted.abs()), "{a} {wanted}");
        }
    }
}

#[test]
fn energy_is_kept_to_order_four() {
    let pendulum = DoublePendulum::competition();
    let start = [1.2, 0.9, -2.0, 3.0];
    let error = |steps: usize| {
        let h = 1.0 / steps as f64;
        let end = (0..steps).fold(start, |x, _| pendulum.step(x, [0.0; 2], h));
        (pendulum.energy(end) - pendulum.energy(start)).abs()
    };
    let slope = (error(250) / error(1000)).log2() / 2.0;
    assert!((3.7..5.3).contains(&slope), "{slope}");
    assert!(error(500) < 1e-6);
}

#[test]
fn steps_have_order_four() {
    let pendulum = full();
    let end = |steps: usize| {
        let h = 0.05 / steps as f64;
        // The joints move all the time: dry friction would not be smooth otherwise.
        (0..steps).fold([0.4, 0.9, -6.0, 5.0], |x, _| pendulum.step(x, [0.5, -0.2], h))
    };
    let fine = end(3200);
    let error = |steps: usize| (0..4).map(|i| (end(steps)[i] - fine[i]).abs()).fold(0.0, f64::max);
    let slope = (error(25) / error(100)).log2() / 2.0;
    assert!((3.8..4.2).contains(&slope), "{slope}");
}

#[test]
fn a_posture_is_held_by_the_torques_of_gravity() {
    let pendulum = DoublePendulum::competition();
    let q = [0.8, -2.1];
    let a = pendulum.acceleration([q[0], q[1], 0.0, 0.0], pendulum.holding_torque(q));
    assert!(a.iter().all(|a| a.abs() < 1e-12), "{a:?}");
}

#[test]
fn the_tip_is_highest_upright() {
    let pendulum = DoublePendulum::competition();
    let pi = std::f64::consts::PI;
    assert!((pendulum.tip([pi, 0.0, 0.0, 0.0]) - 0.5).abs() < 1e-15);
    assert!((pendulum.tip([0.0, pi, 0.0, 0.0]) - 0.1).abs() < 1e-15);
}

#[test]
fn derivatives_of_a_node_are_those_of_differences() {
    for robot in [Robot::Acrobot, Robot::Pendubot] {
        let plant = Driven { pendulum: full(), robot };
        for x in STATES {
            check_derivatives(&plant, &x, 0.7, 1e-6);
        }
    }
}

/// Numbers that are read off the bodies of a model are those of a pendulum that moves as they do.
#[test]
fn a_pendulum_is_read_off_its_bodies() {
    let exact = Model::exact().unwrap();
    let bodies = exact.believed(&exact.replica().unwrap()).bodies.clone();
    let read = Model::of_bodies("read", bodies).unwrap();
    let pendulum = read.believed(&read.replica().unwrap()).pendulum;
    assert_ne!(pendulum.mass, DoublePendulum::competition().mass);
    for x in STATES {
        let [found, expected] =
            [pendulum, DoublePendulum::competition()].map(|p| p.acceleration(x, [0.4, -1.5]));
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() <= 1e-5 * (1.0 + expected.abs()), "{found} {expected}");
        }
    }
}

#[test]
fn a_pendulum_is_learned_from_noisy_logs() {
    let robot = Robot::Acrobot;
    let learned = Model::of_bodies("learned", from_simulated(robot, (3, 301), &|_| ()).unwrap()).unwrap();
    let pendulum = learned.believed(&learned.replica().unwrap()).pendulum;
    for x in STATES {
        let [found, expected] =
            [pendulum, DoublePendulum::competition()].map(|p| p.acceleration(x, robot.torques(3.0)));
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() <= 0.03 * (1.0 + expected.abs()), "{found} {expected}");
        }
    }
}

/// The bodies that a policy believes in move as the pendulum does.
#[test]
fn bodies_accelerate_as_the_pendulum() {
    let model = Model::exact().unwrap();
    let replica = model.replica().unwrap();
    let mut bodies = replica.evaluator().unwrap();
    for x in STATES {
        let tau = [0.4, -1.5];
        let [q, v, u] = [[x[0], x[1]], [x[2], x[3]], tau].map(|pair| pair.map(|x| x as f32));
        let mut found = [0.0_f32; 2];
        bodies.acceleration(&q, &v, &u, &mut found).unwrap();
        let expected = DoublePendulum::competition().acceleration(x, tau);
        for (found, expected) in found.iter().zip(expected) {
            assert!(
                (f64::from(*found) - expected).abs() <= 2e-5 * (1.0 + expected.abs()),
                "{found} {expected}"
            );
        }
    }
}
