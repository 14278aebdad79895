use super::Recorded;
use crate::control::model::Model;
use crate::control::plant::DoublePendulum;
use crate::control::policy::{Controller, Robot, TICK};
use crate::control::robustness::{Column, Imperfect, course, is_upright, machines, pushes, share};
use crate::control::scores::{POLICY_SECONDS, policy_course, time_up};
use crate::control::simulation::Course;
use leastaction_models::parallel;
use rand::SeedableRng;
use rand_pcg::Pcg64;
use std::f64::consts::PI;

fn random() -> Pcg64 {
    Pcg64::seed_from_u64(5)
}

#[test]
fn the_table_has_722_runs() {
    let runs = Column::ALL.map(|column| {
        let (machines, repetitions) = machines(column);
        machines.len() * repetitions
    });
    assert_eq!(runs, [210, 210, 210, 21, 21, 50]);
}

#[test]
fn the_varied_numbers_are_those_of_the_rule() {
    let nominal = DoublePendulum::competition();
    let (all, _) = machines(Column::Model);
    let ends = |k: usize, of: fn(&DoublePendulum) -> f64| {
        [&all[21 * k], &all[21 * k + 20]].map(|machine| of(&machine.pendulum))
    };
    assert_eq!(ends(0, |p| p.rotor), [0.0, 1e-4]);
    assert_eq!(ends(1, |p| p.mass[0] * p.centre[0]), [0.75, 1.25].map(|x| nominal.mass[0] * (0.2 * x)));
    assert_eq!(ends(2, |p| p.inertia[0]), [0.75, 1.25].map(|x| nominal.inertia[0] * x));
    assert_eq!(ends(3, |p| p.damping[0]), [-0.1, 0.1]);
    assert_eq!(ends(4, |p| p.coulomb[0]), [-0.2, 0.2]);
    assert_eq!(ends(5, |p| p.centre[1]), [0.75, 1.25].map(|x| nominal.centre[1] * x));
    assert_eq!(ends(6, |p| p.mass[1]), [0.75, 1.25].map(|x| nominal.mass[1] * x));
    assert_eq!(ends(7, |p| p.inertia[1]), [0.75, 1.25].map(|x| nominal.inertia[1] * x));
    assert_eq!(ends(8, |p| p.damping[1]), [-0.1, 0.1]);
    assert_eq!(ends(9, |p| p.coulomb[1]), [-0.2, 0.2]);
    // Each machine differs from the nominal one in one number at most.
    let varied = all.iter().filter(|machine| **machine != Imperfect::nominal());
    assert!((200..210).contains(&varied.count()));
    let (late, _) = machines(Column::Delay);
    assert!((late[20].delay, late[1].delay) == (0.04, 0.002));
    let (slow, _) = machines(Column::SlowDrive);
    assert!((slow[0].response, slow[20].response) == (0.1, 2.0));
}

#[test]
fn a_late_measurement_is_that_of_ticks_before() {
    let seen = |delay: f64| {
        let mut policy = Recorded::new(|t, _, _| if t < 0.5 { 2.0 } else { -3.0 });
        let machine = Imperfect { delay, ..Imperfect::nominal() };
        let course = course(&machine, Robot::Acrobot, &mut policy, random());
        (policy.calls(), course.states)
    };
    for late in [0, 1, 7, 20] {
        let (calls, states) = seen(late as f64 * TICK);
        assert_eq!(calls.len(), 5000);
        for (k, (_, q, v)) in calls.iter().enumerate().take(300) {
            let state = states[k.saturating_sub(late)];
            assert_eq!([q[0], q[1], v[0], v[1]], state, "{late} {k}");
        }
    }
}

#[test]
fn a_slow_drive_carries_out_a_part_of_each_change() {
    let torques = |response: f64| {
        let machine = Imperfect { response, ..Imperfect::nominal() };
        course(&machine, Robot::Pendubot, &mut Recorded::new(|_, _, _| 4.0), random()).torques
    };
    let slow = torques(0.5);
    assert_eq!(slow[..3], [[2.0, 0.0], [3.0, 0.0], [3.5, 0.0]]);
    // 8 N m are limited before they become the last torque.
    let fast = torques(2.0);
    assert_eq!(fast[..3], [[6.0, 0.0], [2.0, 0.0], [6.0, 0.0]]);
}

#[test]
fn noise_has_its_standard_deviation() {
    let machine = Imperfect { velocity_noise: 0.3, torque_noise: 0.8, ..Imperfect::nominal() };
    let mut policy = Recorded::new(|_, _, _| 0.0);
    let course = course(&machine, Robot::Acrobot, &mut policy, random());
    let spread = |x: &[f64]| (x.iter().map(|x| x * x).sum::<f64>() / x.len() as f64).sqrt();
    let calls = policy.calls();
    let velocity: Vec<f64> =
        calls.iter().zip(&course.states).flat_map(|((_, _, v), x)| [v[0] - x[2], v[1] - x[3]]).collect();
    let torque: Vec<f64> = course.torques.iter().map(|tau| tau[1]).collect();
    assert!((spread(&velocity) / 0.3 - 1.0).abs() < 0.03 && (spread(&torque) / 0.8 - 1.0).abs() < 0.05);
    assert!(calls.iter().zip(&course.states).all(|((_, q, _), x)| q[..] == x[..2]));
    assert!(course.torques.iter().all(|tau| tau[0] == 0.0));
}

#[test]
fn pushes_keep_their_distance_and_their_sizes() {
    for seed in 0..100 {
        let both = pushes(&mut Pcg64::seed_from_u64(seed));
        let mut times: Vec<f64> = both.iter().flatten().map(|push| push.time).collect();
        times.sort_by(f64::total_cmp);
        assert!(times[0] >= 1.0 && times[5] <= 9.0 && times.windows(2).all(|two| two[1] - two[0] >= 1.0));
        for push in both.iter().flatten() {
            assert!((0.05..0.1).contains(&push.width) && (0.5..=5.0).contains(&push.size.abs()), "{push:?}");
        }
    }
}

#[test]
fn a_push_comes_on_top_of_the_limited_torque() {
    let machine = Imperfect { pushed: true, ..Imperfect::nominal() };
    let course = course(&machine, Robot::Acrobot, &mut Recorded::new(|_, _, _| 0.0), random());
    let [_, of_joint] = pushes(&mut random());
    for push in of_joint {
        let tick = (push.time / TICK).round() as usize;
        // The torque before is carried out wholly: nothing of it is left.
        assert!((course.torques[tick][1] - push.size).abs() < 0.01 * push.size.abs(), "{push:?}");
    }
    assert!(course.torques.iter().all(|tau| tau[0] == 0.0));
}

#[test]
fn the_end_is_upright_within_its_bounds() {
    let at = |x| is_upright(&Course { states: vec![x], torques: Vec::new(), up: Vec::new() });
    assert!(at([PI, 0.0, 0.0, 0.0]) && at([-PI + 0.34, 2.0 * PI - 0.34, 0.99, -0.99]));
    assert!(!at([PI + 0.36, 0.0, 0.0, 0.0]) && !at([PI, 0.0, 0.0, 1.01]) && !at([f64::NAN, 0.0, 0.0, 0.0]));
}

#[test]
fn a_swing_up_succeeds_and_is_the_same_on_any_number_of_threads() {
    let pendulum = DoublePendulum::competition();
    let model = Model::exact().unwrap();
    let replica = model.replica().unwrap();
    let maker = Controller::Tvlqr.prepare(Robot::Acrobot, &model.believed(&replica), &|_| ()).unwrap();
    let found = |threads: usize| {
        parallel::threads(threads).unwrap().install(|| {
            let nominal = course(&Imperfect::nominal(), Robot::Acrobot, &mut *maker(), random());
            let disturbed = policy_course(&pendulum, Robot::Acrobot, &mut *maker(), 0, POLICY_SECONDS);
            (nominal, disturbed, share(Column::SlowDrive, Robot::Acrobot, &maker, 0))
        })
    };
    let (nominal, disturbed, share) = found(1);
    assert!(is_upright(&nominal) && share > 0.5, "{share}");
    assert!(time_up(&disturbed, POLICY_SECONDS) > 0.0);
    assert!((nominal, disturbed, share) == found(2));
}

#[test]
fn noise_is_repeated_by_its_seed() {
    let machine = Imperfect { velocity_noise: 0.1, ..Imperfect::nominal() };
    let law = |_, _, v: [f64; 2]| -v[1];
    let run =
        |seed: u64| course(&machine, Robot::Acrobot, &mut Recorded::new(law), Pcg64::seed_from_u64(seed));
    assert!(run(1) == run(1) && run(1) != run(2));
    let maker = Recorded::maker(law);
    assert_eq!(share(Column::Pushes, Robot::Acrobot, &maker, 0), 0.0);
}
