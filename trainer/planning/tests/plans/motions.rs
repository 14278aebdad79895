//! Motions that are found.

use crate::{problem, solved};
use leastaction_core::control::Status;
use leastaction_core::plan::PlanFile;
use leastaction_models::{GroupLaws, Number};
use leastaction_planning::{Plan, plan};
use std::sync::atomic::AtomicBool;

/// Limits of commands and states hold at every node, and the goal at the end.
fn assert_kept(plan: &Plan) {
    let task = &plan.task;
    for node in &plan.nodes {
        assert!(node.u.iter().zip(&task.limits.u).all(|(u, [least, most])| (least..=most).contains(&u)));
        assert!(
            node.x.iter().zip(&task.limits.x).all(|(x, [least, most])| *x > least - 1e-4 && *x < most + 1e-4)
        );
    }
    for ((x, [least, most]), turns) in plan.end.x.iter().zip(&task.goal.state).zip(&task.goal.turns) {
        let turn =
            if *turns { ((x - least) / std::f64::consts::TAU).round() * std::f64::consts::TAU } else { 0.0 };
        assert!(x - turn > least - 1e-4 && x - turn < most + 1e-4, "{x} instead of {least} … {most}");
    }
}

#[test]
fn a_pendulum_swings_up_and_is_followed_from_other_starts() {
    let (machine, task) = problem("pendulum", |text| format!("{text}\n[search]\nstarts = 2\n")).unwrap();
    let found = solved(&machine, &task);
    assert!(found.is_feasible() && found.holds && found.worst(&machine).is_none());
    assert_eq!((found.seconds(), found.starts.len()), (4.0, 2));
    assert_kept(&found);
    // IPOPT finds 2.0286 (tests/peers/control_casadi.py).
    assert!((found.cost - 2.0286).abs() < 1e-3 * 2.0286, "{}", found.cost);
    let trials = found.trials(&machine, &task.check).unwrap();
    assert_eq!((trials.starts, trials.exact, trials.off), (20, 20, 20));
}

#[test]
fn an_arm_moves_within_its_limits_without_a_swing() {
    let (machine, task) = problem("arm", |text| format!("{text}\n[search]\nstarts = 1\n")).unwrap();
    let found = solved(&machine, &task);
    assert_kept(&found);
    // IPOPT finds 20.602 (tests/peers/control_casadi.py).
    assert!((found.cost - 20.602).abs() < 1e-3 * 20.602, "{}", found.cost);
    let starts: Vec<_> = found.starts.iter().map(|start| start.guess.as_str()).collect();
    assert_eq!(starts, ["straight line"]);
    let used = |i: usize| found.nodes.iter().map(|node| node.x[7 + i].abs()).fold(0.0, f64::max);
    assert!(used(0) > 2.17, "the speed is used: {}", used(0));
}

#[test]
fn free_states_and_rollouts_lead_to_one_motion() {
    let starting = |seconds: &str| {
        let seconds = format!("seconds = {seconds}");
        let changed = |text: &str| text.replace("seconds = 4.0", &seconds) + "\n[search]\nstarts = 1\n";
        let (machine, task) = problem("pendulum", changed).unwrap();
        solved(&machine, &task)
    };
    let free = starting("[3.95, 4.0]");
    let near = free.starts.iter().find(|start| start.guess == "near the best").unwrap();
    let rolled = starting(&format!("{:?}", near.nodes as f64 * 0.01));
    assert_eq!((rolled.starts[0].guess.as_str(), rolled.nodes.len()), ("straight line", near.nodes));
    assert!((near.solution.cost - rolled.cost).abs() < 1e-3 * rolled.cost, "{near:?} {}", rolled.cost);
}

#[test]
fn a_cart_keeps_to_its_track() {
    let (machine, task) = problem("cartpole", |text| format!("{text}\n[search]\nstarts = 1\n")).unwrap();
    let found = solved(&machine, &task);
    assert_eq!(found.solution.status, Status::Solved);
    assert_kept(&found);
    let farthest = found.nodes.iter().map(|node| node.x[0].abs()).fold(0.0, f64::max);
    assert!(farthest > 0.79, "the track is used: {farthest}");
}

#[test]
fn nodes_of_several_ticks_and_order_4_work_alike() {
    let coarse =
        |text: &str| text.replace("order = 2", "order = 4\nticks_per_node = 4") + "\n[search]\nstarts = 2\n";
    let (machine, task) = problem("pendulum", coarse).unwrap();
    let found = solved(&machine, &task);
    assert_eq!(found.nodes.len(), 100);
    assert!(found.is_feasible());
    assert_kept(&found);
    let trials = found.trials(&machine, &task.check).unwrap();
    assert_eq!((trials.exact, trials.off), (20, 20), "the law interpolates between nodes");
}

#[test]
fn a_free_time_is_chosen_by_its_cost() {
    let free = |text: &str| {
        let text = text.replace("seconds = 4.0", "seconds = [3.6, 4.4]\nticks_per_node = 2");
        text.replace("[cost]", "[search]\nstarts = 2\n\n[cost]\ntime = 0.5")
    };
    let (machine, task) = problem("pendulum", free).unwrap();
    let found = solved(&machine, &task);
    assert!(found.is_feasible());
    assert!(found.seconds() > 3.6 && found.seconds() < 4.4, "{}", found.seconds());
    for fixed in [0.85, 1.15] {
        let seconds = format!("seconds = {:.2}\nticks_per_node = 2", fixed * found.seconds());
        let (machine, task) = problem("pendulum", |text| {
            let text = text.replace("seconds = 4.0", &seconds);
            text.replace("[cost]", "[search]\nstarts = 2\n\n[cost]\ntime = 0.5")
        })
        .unwrap();
        let other = solved(&machine, &task);
        assert!(!other.is_feasible() || other.cost > found.cost - 1e-3, "{} at {fixed}", other.cost);
    }
}

#[test]
fn a_reserve_leaves_room_for_feedback() {
    let reserved =
        |text: &str| text.replace("u = [1.5]", "u = [1.5]\nreserve = 0.2") + "\n[search]\nstarts = 1\n";
    let (machine, task) = problem("pendulum", reserved).unwrap();
    let found = solved(&machine, &task);
    let largest = found.nodes.iter().map(|node| node.u[0].abs()).fold(0.0, f64::max);
    assert!(largest <= 1.2 + 1e-9, "{largest}");
    assert!(found.tube.widths.iter().all(|widths| widths.iter().all(|width| *width > 0.0)));
}

/// At rest dry friction of 0.05 N m has the slope of a damper of 2.5 N m s/rad if it changes its sign within 0.02 rad/s, and of one ten times
/// weaker within 0.2 rad/s. Feedback, which corrects velocities of about 1 rad/s, meets neither.
#[test]
fn gains_meet_dry_friction_at_the_deviations() {
    let gain = |width: f64| {
        let (mut machine, task) =
            problem("pendulum", |text| format!("{text}\n[search]\nstarts = 1\n")).unwrap();
        let dry = [0.05, 0.0, 1.0, width];
        machine.model.architecture.group_laws = GroupLaws::of_friction(vec![], vec![dry.map(Number::known)]);
        machine.model.weights.extend(dry);
        let found = solved(&machine, &task);
        assert!(found.is_feasible() && found.holds, "{}", found.solution.violation);
        found.end.gain[0].clone()
    };
    let (narrow, wide) = (gain(0.02), gain(0.2));
    for (narrow, wide) in narrow.iter().zip(&wide) {
        assert!(*wide > 0.5 && (narrow - wide).abs() < 0.01 * wide, "{narrow} and {wide}");
    }
}

#[test]
fn a_plan_is_a_file_for_the_model_alone() {
    let (machine, task) = problem("pendulum", |text| format!("{text}\n[search]\nstarts = 1\n")).unwrap();
    let found = solved(&machine, &task);
    let bytes = found.to_bytes(&machine).unwrap();
    let mut words = vec![0_u32; bytes.len().div_ceil(4)];
    let memory: &mut [u8] = bytemuck::cast_slice_mut(&mut words);
    memory[..bytes.len()].copy_from_slice(&bytes);
    let file = PlanFile::parse(&memory[..bytes.len()]).unwrap();
    let own = leastaction_core::model::fingerprint(&machine.shipped().unwrap()).unwrap();
    assert!(file.check_model(own).is_ok() && file.check_model(own ^ 1).is_err());
    assert_eq!((file.header().nodes, file.header().driven), (400, &[0][..]));
}

/// Too little torque for the time: the search says what is missing.
#[test]
fn an_energy_is_a_goal() {
    let of = |goal: &str| {
        let goal = format!("energy = {goal}");
        let changed = |text: &str| {
            let text = text.replace("q = [0.0]", &goal).replace("seconds = 4.0", "seconds = 2.0");
            text + "\n[search]\nstarts = 2\n"
        };
        let (machine, task) = problem("pendulum", changed).unwrap();
        let found = solved(&machine, &task);
        let worst = found.worst(&machine);
        (found, worst)
    };
    let (reached, none) = of("-1.0");
    assert!(reached.is_feasible() && none.is_none(), "{none:?}");
    // The rod hangs at −4.9 J.
    assert!((reached.energy.unwrap() + 1.0).abs() < 4e-4, "{:?}", reached.energy);
    let (far, missed) = of("60.0");
    assert!(!far.is_feasible());
    assert!(missed.as_ref().is_some_and(|words| words.contains("J from its goal")), "{missed:?}");
}

#[test]
fn a_goal_out_of_reach_is_named() {
    let weak = |text: &str| {
        text.replace("u = [1.5]", "u = [0.3]").replace("seconds = 4.0", "seconds = 1.0")
            + "\n[search]\nstarts = 2\n"
    };
    let (machine, task) = problem("pendulum", weak).unwrap();
    let found = solved(&machine, &task);
    assert!(!found.is_feasible());
    let worst = found.worst(&machine).unwrap();
    assert!(worst.contains("from its goal"), "{worst}");
}

#[test]
fn a_search_that_is_stopped_keeps_its_motion() {
    let (machine, task) = problem("pendulum", |text| format!("{text}\n[search]\nstarts = 1\n")).unwrap();
    let found = plan(&machine, &task, None, (&AtomicBool::new(true), &())).unwrap();
    assert!(found.interrupted);
    assert_eq!((found.solution.status, found.solution.iterations), (Status::Stopped, 1));
    assert_eq!(found.nodes.len(), 400);
}

/// Commands of a plan as the start of the next one: solved at once.
#[test]
fn a_plan_begins_with_given_commands() {
    let (machine, task) = problem("pendulum", |text| format!("{text}\n[search]\nstarts = 1\n")).unwrap();
    let first = solved(&machine, &task);
    let commands = first.nodes.iter().map(|node| node.u.clone()).collect();
    let again = plan(&machine, &task, Some(commands), (&AtomicBool::new(false), &())).unwrap();
    assert!(again.solution.iterations < first.solution.iterations);
    assert!((again.cost - first.cost).abs() < 1e-3 * first.cost);
    assert_eq!(again.starts[0].guess, "given");
}

#[test]
fn searches_give_the_same_bits_again() {
    let (machine, task) =
        problem("cartpole", |text| format!("{text}\n[search]\nstarts = 3\niterations = 40\n")).unwrap();
    let (first, second) = (solved(&machine, &task), solved(&machine, &task));
    assert_eq!((first.nodes, first.end), (second.nodes, second.end));
}
