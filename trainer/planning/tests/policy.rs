//! Policies from anywhere.

use leastaction_planning::policy::{Decider, Policy, State};
use leastaction_planning::{Machine, PlanConfig, PlanError, Task};
use leastaction_replica::{ModelFile, Replica, Step};
use std::f64::consts::{PI, TAU};
use std::path::Path;

const H: f64 = 0.01;

/// A rod of 1 m and 1 kg on a pivot, which hangs at 0; holding it level takes 4.9 N m.
const PENDULUM: &str = r#"<robot name="pendulum"><link name="base"/>
<link name="rod"><inertial><origin xyz="0 0 -0.5"/><mass value="1"/>
<inertia ixx="0.083" iyy="0.083" izz="0.083" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="pivot" type="continuous"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/></joint></robot>"#;

fn config(keys: &str) -> PlanConfig {
    let text = format!("model = \"pendulum\"\ntick = {H}\nstart.q = [0.0]\n{keys}");
    PlanConfig::parse(&text, Path::new("test")).unwrap()
}

const SWING_UP: &str =
    "ticks_per_node = 4\nseconds = 2.0\ngoal.q = [3.141592653589793]\nlimits.u = [3.5]\npolicy.starts = 8";

/// Calls `work` with the policy of a configuration.
fn with_policy<T>(keys: &str, work: impl FnOnce(&Replica, Result<Policy, PlanError>) -> T) -> T {
    let machine = Machine::of_text(PENDULUM).unwrap();
    let task = Task::new(&config(keys), &machine).unwrap();
    let file = ModelFile::new(&machine.model.to_bytes().unwrap()).unwrap();
    let replica = file.replica(None).unwrap();
    work(&replica, Policy::new((&replica, &machine.model), &task, &|_| true))
}

/// Runs a law from a state for some seconds; returns the last state and what the law did.
fn run(replica: &Replica, law: &mut Decider, [q, v]: [f64; 2], seconds: f64) -> ([f64; 2], State) {
    let step = Step { order: leastaction_core::discrete::Order::Two, h: H as f32 };
    let mut motion = replica.motion_at(step, &[q as f32], &[v as f32]).unwrap();
    let (mut x, mut state) = ([q, v], State::Hold);
    for _ in 0..(seconds / H) as usize {
        let decision = law.decide([&x[..1], &x[1..]], None).unwrap();
        assert!(decision.u[0].abs() <= 3.5);
        state = decision.state;
        let u = [decision.u[0] as f32];
        motion.step(leastaction_replica::Control { start: &u, end: &u }).unwrap();
        let mut v = [0.0];
        motion.velocity(&mut v).unwrap();
        x = [motion.q()[0].into(), v[0].into()];
    }
    (x, state)
}

#[test]
fn a_weak_drive_swings_up_from_anywhere() {
    with_policy(SWING_UP, |replica, policy| {
        let policy = policy.unwrap();
        for start in [[0.0, 0.0], [2.0, -3.0], [-1.0, 5.0], [3.0, 8.0], [PI + TAU, 0.5]] {
            let mut law = policy.begin();
            let (end, state) = run(replica, &mut law, start, 8.0);
            let off = end[0] - PI - TAU * ((end[0] - PI) / TAU).round();
            assert!(off.abs() < 0.01 && end[1].abs() < 0.05, "from {start:?} to {end:?}");
            // After its motion a law holds the goal; only a push makes it search again.
            assert!(matches!(state, State::Follow | State::Hold));
            let (end, _) = run(replica, &mut law, [end[0] + 1.5, end[1] - 4.0], 8.0);
            let off = end[0] - PI - TAU * ((end[0] - PI) / TAU).round();
            assert!(off.abs() < 0.01, "after a push from {start:?} to {end:?}");
        }
    });
}

#[test]
fn a_library_is_the_same_on_any_number_of_threads() {
    let seconds = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| with_policy(SWING_UP, |_, policy| policy.unwrap().seconds()))
    };
    let one = seconds(1);
    assert!(!one.is_empty());
    assert_eq!(one, seconds(3));
}

#[test]
fn goals_that_are_no_posture_are_refused() {
    for goal in
        ["goal.energy = 1.0", "goal.q = [3.1]\ngoal.v = [1.0]", "goal.q = [[3.0, 3.2]]", "goal.q = [1.5]"]
    {
        let keys = format!("seconds = 4.0\nlimits.u = [2.0]\npolicy.starts = 1\n{goal}");
        let error = with_policy(&keys, |_, policy| policy.err().map(|error| error.to_string()));
        assert!(error.as_ref().is_some_and(|error| error.contains("`goal")), "{goal}: {error:?}");
    }
}

#[test]
fn states_that_are_none_of_the_model_are_refused() {
    with_policy(SWING_UP, |_, policy| {
        let mut law = policy.unwrap().begin();
        assert!(law.decide([&[0.0, 1.0], &[0.0]], None).unwrap_err().to_string().contains("has 2 values"));
        assert!(law.decide([&[f64::NAN], &[0.0]], None).unwrap_err().to_string().contains("NaN"));
    });
}
