//! Words of a plan about itself.

use crate::problem::ACCEPTED;
use crate::{Machine, Plan, StartReport};
use leastaction_core::control::{Solution, Status};

impl Plan {
    /// The limit or the part of the goal that the plan misses most; `None` if it meets all.
    pub fn worst(&self, machine: &Machine) -> Option<String> {
        if self.is_feasible() {
            return None;
        }
        let n = self.task.n();
        let off = |x: f64, [least, most]: [f64; 2]| (least - x).max(x - most).max(0.0);
        let near = |i: usize, x: f64| {
            let (turns, goal) = (self.task.goal.turns[i], self.task.goal.middle()[i]);
            if turns { goal + leastaction_core::scalar::Real::short_way(x - goal) } else { x }
        };
        let named = |i: usize| format!("{} of {}", if i < n { "q" } else { "v" }, machine.names[i % n]);
        let at_end = self.end.x.iter().enumerate().map(|(i, x)| {
            let off = off(near(i, *x), self.task.goal.state[i]);
            (off, format!("{} ends {off:.3} from its goal", named(i)))
        });
        let along = self.nodes.iter().skip(1).enumerate().flat_map(|(k, node)| {
            let seconds = (k + 1) as f64 * self.task.node_seconds();
            node.x.iter().enumerate().map(move |(i, x)| {
                let off = off(*x, self.task.limits.x[i]);
                (off, format!("{} is {off:.3} beyond its limit after {seconds:.2} s", named(i)))
            })
        });
        let energy = self.energy.zip(self.task.goal.energy).map(|(energy, wanted)| {
            let off = (energy - wanted).abs();
            (off, format!("the energy ends {off:.3} J from its goal"))
        });
        at_end.chain(along).chain(energy).max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, words)| words)
    }

    /// How the best search ended.
    pub fn ending(&self) -> &'static str {
        ending(&self.solution)
    }
}

impl StartReport {
    /// How the search ended.
    pub fn ending(&self) -> &'static str {
        ending(&self.solution)
    }
}

fn ending(solution: &Solution<f64>) -> &'static str {
    match (solution.status, solution.violation <= ACCEPTED) {
        (Status::Solved, _) => "solved",
        (Status::Infeasible, true) => "solved as far as single precision allows",
        (Status::Infeasible, false) => "out of reach",
        (Status::Stopped, true) => "stopped, within limits and at the goal",
        (Status::Stopped, false) => "stopped before it reached the goal",
    }
}
