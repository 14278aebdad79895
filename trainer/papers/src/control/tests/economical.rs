use super::{Recorded, check_derivatives};
use crate::control::driven::Driven;
use crate::control::economical::Economy;
use crate::control::observed::Observed;
use crate::control::plant::{DoublePendulum, State};
use crate::control::policy::{Maker, Robot, TICK};
use crate::control::ramped::Ramped;
use crate::control::robustness::{Imperfect, course};
use crate::control::scores::{Slopes, SwingUp};
use rand::SeedableRng;
use rand_pcg::Pcg64;

const ROBOTS: [Robot; 2] = [Robot::Acrobot, Robot::Pendubot];

#[test]
fn derivatives_of_a_ramp_are_those_of_differences() {
    for robot in ROBOTS {
        let plant = Ramped(Driven { pendulum: DoublePendulum::competition(), robot });
        check_derivatives(&plant, &[0.3, -1.2, 2.0, -3.5, 1.7], 40.0, 1e-7);
    }
}

#[test]
fn slopes_are_those_of_the_score() {
    let at =
        SwingUp { time: Some(1.3), energy: 7.7, torque_cost: 2.1, smoothness: 0.004, velocity_cost: 60.0 };
    let Slopes { energy, torque, smoothness, velocity } = at.slopes();
    let d = 1e-6;
    let fall = |more: SwingUp| (at.score() - more.score()) / d;
    for (slope, fall) in [
        (energy, fall(SwingUp { energy: at.energy + d, ..at })),
        (torque, fall(SwingUp { torque_cost: at.torque_cost + d, ..at })),
        (smoothness, fall(SwingUp { smoothness: at.smoothness + d, ..at })),
        (velocity, fall(SwingUp { velocity_cost: at.velocity_cost + d, ..at })),
    ] {
        assert!((slope - fall).abs() < 1e-4 * (1.0 + slope), "{slope} {fall}");
    }
}

#[test]
fn a_plan_of_little_cost_swings_up() {
    let plant = Ramped(Driven { pendulum: DoublePendulum::competition(), robot: Robot::Acrobot });
    let economy = Economy { plant };
    let found: Vec<_> = (0..3).filter_map(|seed| economy.planned(economy.wave(120, seed)?)).collect();
    assert!(found.iter().any(|found| found.score > 0.6), "{} found", found.len());
}

/// A wave of torque, small enough to swing about hanging.
fn wave(t: f64, _: [f64; 2], _: [f64; 2]) -> f64 {
    0.1 * (7.0 * t).cos()
}

/// States of a run, and those with which its law was asked.
fn asked(machine: &Imperfect, robot: Robot) -> (Vec<State>, Vec<State>) {
    let law = Recorded::new(wave);
    let inner = law.clone();
    let maker: Maker = Box::new(move || Box::new(inner.clone()));
    let mut policy = Observed::maker(maker, machine.pendulum, robot)();
    let course = course(machine, robot, &mut *policy, Pcg64::seed_from_u64(3));
    let calls = law.calls().into_iter().map(|(_, q, v)| [q[0], q[1], v[0], v[1]]);
    (course.states, calls.collect())
}

#[test]
fn velocities_come_from_positions() {
    for robot in ROBOTS {
        let (states, asked) = asked(&Imperfect { velocity_noise: 0.5, ..Imperfect::nominal() }, robot);
        for (x, found) in states.iter().zip(&asked).skip(2) {
            assert_eq!(x[..2], found[..2]);
            let fastest = 1.0 + x[2].abs().max(x[3].abs());
            assert!((2..4).all(|i| (x[i] - found[i]).abs() < 1e-3 * fastest), "{x:?} {found:?}");
        }
    }
}

#[test]
fn a_delay_is_told_by_the_first_command_and_made_up_for() {
    for robot in ROBOTS {
        let late = 17;
        let machine = Imperfect { delay: (f64::from(late) + 0.5) * TICK, ..Imperfect::nominal() };
        let (states, asked) = asked(&machine, robot);
        for (x, found) in states.iter().zip(&asked).skip(2 * late as usize) {
            let fastest = 1.0 + x[2].abs().max(x[3].abs());
            assert!((0..2).all(|i| (x[i] - found[i]).abs() < 1e-4 * fastest), "{x:?} {found:?}");
            assert!((2..4).all(|i| (x[i] - found[i]).abs() < 3e-3 * fastest), "{x:?} {found:?}");
        }
    }
}

#[test]
fn a_run_after_a_pause_knows_no_velocity_but_the_measured_one() {
    let law = Recorded::new(|_, _, _| 0.0);
    let inner = law.clone();
    let pendulum = DoublePendulum::competition();
    let mut policy = Observed::maker(Box::new(move || Box::new(inner.clone())), pendulum, Robot::Acrobot)();
    policy.reset();
    policy.torque(0.0, [0.0; 2], [0.0; 2]);
    policy.torque(0.2, [1.0, 2.0], [3.0, 4.0]);
    assert_eq!(law.calls().last(), Some(&(0.2, [1.0, 2.0], [3.0, 4.0])));
}
