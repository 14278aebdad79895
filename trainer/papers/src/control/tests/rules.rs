use super::Recorded;
use crate::control::disturbance::{Disturber, Pid, Schedule};
use crate::control::plant::DoublePendulum;
use crate::control::policy::{Robot, TICK};
use crate::control::scores::{SwingUp, policy_course, swing_up_course, time_up};
use crate::control::simulation::Course;
use std::f64::consts::PI;

const PENDULUM: DoublePendulum = DoublePendulum::competition();

#[test]
fn the_pid_has_the_peculiarities_of_the_competition() {
    let mut pid = Pid::default();
    let close = |found: [f64; 2], wanted: [f64; 2]| {
        assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?} {wanted:?}");
    };
    // No D in the first two calls, although the error changes: P + I alone, I = 0.1 Σe 0.001.
    close(pid.torques([0.3, -0.2], [0.0, 0.0]), [3.0 + 3e-5, -2.0 - 2e-5]);
    close(pid.torques([0.3, -0.2], [0.1, 0.0]), [2.0 + 5e-5, -2.0 - 4e-5]);
    // From the third on D = Δe/0.001.
    close(pid.torques([0.3, -0.2], [0.101, 0.001]), [1.99 - 1.0 + 6.99e-5, -2.01 - 1.0 - 6.01e-5]);
    // A new posture is a jump that saturates; the call after it has no jump, but the sum of all errors. Angles are not wrapped.
    close(pid.torques([0.4, -0.3], [0.101, 0.001]), [6.0, -6.0]);
    close(pid.torques([0.4, -0.3], [0.101, 0.001]), [2.99 + 1.297e-4, -3.01 - 1.203e-4]);
    close(pid.torques([0.4 + 2.0 * PI, -0.3], [0.101, 0.001]), [6.0, -3.01 - 1.504e-4]);
}

#[test]
fn schedules_are_drawn_within_their_bounds() {
    for seed in 0..50 {
        let disturbances = Schedule::draw(seed).disturbances;
        assert_eq!(disturbances.len(), 15);
        for (k, (time, posture)) in disturbances.iter().enumerate() {
            assert!((time - 3.75 * (k + 1) as f64).abs() <= 1.0, "{time}");
            assert!(posture.iter().all(|q| q.abs() <= PI));
        }
    }
    assert_eq!(Schedule::draw(3), Schedule::draw(3));
    assert_ne!(Schedule::draw(3), Schedule::draw(4));
}

#[test]
fn a_disturbance_lasts_100_or_101_ticks() {
    let schedule = Schedule::draw(0);
    let times: Vec<f64> = schedule.disturbances.iter().map(|(time, _)| *time).collect();
    let mut disturber = Disturber::new(schedule);
    let (mut t, mut lengths, mut starts) = (0.0, Vec::new(), Vec::new());
    let mut before = false;
    for _ in 0..30_000 {
        let now = disturber.torques(t, [0.1, 0.2], &PENDULUM).is_some();
        if now && !before {
            starts.push(t);
            lengths.push(0);
        }
        if now {
            *lengths.last_mut().unwrap() += 1;
        }
        (before, t) = (now, t + TICK);
    }
    assert!(lengths.len() == 15 && lengths.iter().all(|length| [100, 101].contains(length)), "{lengths:?}");
    assert!(starts.iter().zip(&times).all(|(start, time)| (0.0..TICK).contains(&(start - time))));
}

#[test]
fn a_disturbance_holds_its_posture_against_gravity() {
    let q = [0.5, -0.4];
    let mut disturber = Disturber::new(Schedule { disturbances: vec![(0.0, q)] });
    assert_eq!(disturber.torques(0.0, q, &PENDULUM), Some(PENDULUM.holding_torque(q)));
    // The sum with gravity is limited, too.
    let mut disturber = Disturber::new(Schedule { disturbances: vec![(0.0, [1.2, 0.0])] });
    let [first, _] = disturber.torques(0.0, [0.6, 0.0], &PENDULUM).unwrap();
    assert_eq!(first, 6.0);
}

#[test]
fn the_policy_is_not_asked_during_a_disturbance() {
    let mut policy = Recorded::new(|t, _, _| if t < 1.0 { 40.0 } else { 1.0 });
    let course = policy_course(&PENDULUM, Robot::Acrobot, &mut policy, 1, 12.0);
    let calls = policy.calls();
    let gaps = calls.windows(2).filter(|two| two[1].0 - two[0].0 > 1.5 * TICK).count();
    let disturbed = course.torques.len() - calls.len();
    assert!((2..=4).contains(&gaps) && (100 * gaps..=101 * gaps).contains(&disturbed), "{gaps} {disturbed}");
    // Before the first disturbance the limited torque drives joint 2 alone; a disturbance drives joint 1, too.
    assert_eq!((calls[0].0, course.torques[0]), (0.0, [0.0, 6.0]));
    assert_eq!(course.torques.iter().filter(|tau| tau[0] != 0.0).count(), disturbed);
    // It sees the exact state.
    assert!((0..1000).all(|k| calls[k].1 == course.states[k][..2] && calls[k].2 == course.states[k][2..]));
    assert_eq!(course, policy_course(&PENDULUM, Robot::Acrobot, &mut policy, 1, 12.0));
    assert_ne!(course, policy_course(&PENDULUM, Robot::Acrobot, &mut policy, 2, 12.0));
}

/// A course whose tip is up as given, with these torques and states at rest.
fn course(up: &[bool], torques: &[[f64; 2]]) -> Course {
    Course { states: vec![[PI, 0.0, 0.0, 0.0]; up.len()], torques: torques.to_vec(), up: up.to_vec() }
}

#[test]
fn the_score_is_the_time_up() {
    let stands = course(&[true; 501], &[[0.0; 2]; 500]);
    assert!((time_up(&stands, 1.0) - 1.0).abs() < 1e-12);
    let half = course(&[true, true, false, true, false], &[[0.0; 2]; 4]);
    assert!((time_up(&half, 4.0 * TICK) - 0.5).abs() < 1e-12);
}

#[test]
fn without_torque_nothing_is_scored() {
    let course = swing_up_course(&PENDULUM, Robot::Pendubot, &mut Recorded::new(|_, _, _| 0.0));
    assert_eq!((course.states.len(), course.torques.len()), (5001, 5000));
    let found = SwingUp::of(&course);
    let nothing = SwingUp { time: None, energy: 0.0, torque_cost: 0.0, smoothness: 0.0, velocity_cost: 0.0 };
    assert_eq!((found, found.score(), time_up(&course, 10.0)), (nothing, 0.0, 0.0));
}

#[test]
fn the_terms_of_a_swing_up_are_those_of_small_courses() {
    let course = Course {
        states: vec![[0.0; 4], [0.1, 0.0, 3.0, 0.0], [0.3, -0.2, 0.0, 4.0], [0.3, -0.3, 1.0, 1.0]],
        torques: vec![[0.0, 1.0], [0.0, -2.0], [0.0, 1.0]],
        up: vec![false, true, true, true],
    };
    let found = SwingUp::of(&course);
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
    assert_eq!(found.time, Some(TICK));
    // |0 · 1| + |−0.2 · −2| + |−0.1 · 1|.
    close(found.energy, 0.5);
    close(found.torque_cost, 6.0 * TICK);
    // The differences −3 and 3 deviate by 3 from their mean; joint 1 has none.
    close(found.smoothness, 3.0);
    close(found.velocity_cost, (9.0 + 16.0) * TICK);
    let terms = [TICK / 20.0, 0.5 / 60.0, 6.0 * TICK / 20.0, 30.0, 25.0 * TICK / 400.0];
    close(found.score(), 1.0 - terms.map(|c| (PI * c).tanh()).iter().sum::<f64>() / 5.0);
    let falls = Course { up: vec![false, true, true, false], ..course };
    assert_eq!((SwingUp::of(&falls).time, SwingUp::of(&falls).score()), (None, 0.0));
}
