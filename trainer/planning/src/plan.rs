use crate::Task;
use leastaction_core::control::{Iteration, Solution};

/// A node of a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanNode {
    /// State (q, v) at the start of the node, 2n numbers.
    pub x: Vec<f64>,
    /// Command of every coordinate, held over the node.
    pub u: Vec<f64>,
    /// Gain of the feedback u − K(x − x̄), n rows of 2n; 0 for coordinates that are not driven.
    pub gain: Vec<Vec<f64>>,
}

/// Reach of the linear feedback around a plan: deviations δxᵀPδx ≤ ρ, within which the feedback stays inside the limits of the drives, as
/// far as the motion is linear.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tube {
    /// Half-widths of the states at every node, 2n numbers.
    pub widths: Vec<Vec<f64>>,
}

/// Course of the search from one start guess.
#[derive(Clone, Debug, PartialEq)]
pub struct StartReport {
    /// Name of the start guess.
    pub guess: String,
    /// Number of nodes.
    pub nodes: usize,
    /// Result.
    pub solution: Solution<f64>,
    /// Every iteration.
    pub iterations: Vec<Iteration<f64>>,
    /// Time of the search, s.
    pub seconds: f64,
}

/// A motion with its gains.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Task that was planned.
    pub task: Task,
    /// Nodes of the motion.
    pub nodes: Vec<PlanNode>,
    /// State at the end, the command that holds it, and the gain there.
    pub end: PlanNode,
    /// Energy T + V at the end, J, if the goal is one.
    pub energy: Option<f64>,
    /// Whether the end is a rest that the drives can hold.
    pub holds: bool,
    /// Cost, the cost of the time included.
    pub cost: f64,
    /// Result of the best search.
    pub solution: Solution<f64>,
    /// All searches; the first one is that of the plan.
    pub starts: Vec<StartReport>,
    /// Start guesses from which no motion could be computed, with the reason.
    pub failed: Vec<(String, String)>,
    /// Reach of the feedback.
    pub tube: Tube,
    /// Whether the search was stopped before its end.
    pub interrupted: bool,
}

impl Plan {
    /// Duration of the motion, s.
    pub fn seconds(&self) -> f64 {
        self.nodes.len() as f64 * self.task.node_seconds()
    }

    /// Whether limits and goal are met.
    pub fn is_feasible(&self) -> bool {
        self.solution.violation <= crate::problem::ACCEPTED
    }
}
