//! A policy from anywhere: the shortest motion that is found from wherever the pendulum is.

use super::model::{Believed, failed};
use super::policy::{ControlError, Maker, Policy, Robot, TICK, TORQUE_LIMIT};
use leastaction_planning::policy::{self, Decider};
use leastaction_planning::{Machine, PlanConfig, Task};
use std::path::Path;
use std::sync::Arc;

/// Configuration of the policy; the limits of the torques come with the robot.
const CONFIG: &str = r#"
model = "double_pendulum"
order = 2
ticks_per_node = 5
seconds = 2.0
start.q = [0.0, 0.0]
goal.q = [3.141592653589793, 0.0]
cost.u = [0.01, 0.01]
follow.q = [1.0, 1.0]
follow.v = [3.0, 3.0]
follow.u = [1.0, 1.0]
policy.q = [0.1, 0.2]
policy.v = [0.5, 1.0]
"#;

/// Prepares the policy of a robot.
pub fn prepare<'m>(
    robot: Robot,
    believed: &Believed<'m>,
    note: &(dyn Fn(&str) + Sync),
) -> Result<Maker<'m>, ControlError> {
    let [first, second] = robot.torques(TORQUE_LIMIT);
    let text = format!("tick = {TICK}\nlimits.u = [{first:?}, {second:?}]\n{CONFIG}");
    let config = PlanConfig::parse(&text, Path::new("the policy")).map_err(failed)?;
    let task = Task::new(&config, &Machine::new(believed.bodies.clone())).map_err(failed)?;
    let starts = task.policy.starts;
    let watch = |done: usize| {
        note(&format!("{}: motions from {done} of {starts} starts", robot.name()));
        true
    };
    let policy = policy::Policy::new((believed.replica, believed.bodies), &task, &watch).map_err(failed)?;
    let policy = Arc::new(policy);
    Ok(Box::new(move || {
        let policy = Arc::clone(&policy);
        Box::new(Anywhere { law: policy.begin(), policy, driven: robot.driven() })
    }))
}

/// The policy in one run.
struct Anywhere<'m> {
    policy: Arc<policy::Policy<'m>>,
    law: Decider<'m>,
    /// Driven joint.
    driven: usize,
}

impl Policy for Anywhere<'_> {
    fn reset(&mut self) {
        self.law = self.policy.begin();
    }

    fn torque(&mut self, t: f64, q: [f64; 2], v: [f64; 2]) -> f64 {
        // A state that is not finite has no torque.
        let decision = self.law.decide([&q, &v], Some(t)).ok();
        decision.and_then(|decision| decision.u.get(self.driven).copied()).unwrap_or(0.0)
    }
}
