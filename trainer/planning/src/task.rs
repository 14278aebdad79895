use leastaction_core::discrete::Order;
use std::ops::RangeInclusive;

/// Numbers of what is to be planned, which fit a model of n coordinates. States have 2n numbers, q and then v.
#[derive(Clone, Debug, PartialEq)]
pub struct Task {
    /// Tick h, s.
    pub tick: f64,
    /// Order of the step.
    pub order: Order,
    /// Number of ticks in a node.
    pub ticks_per_node: u16,
    /// Numbers of nodes from which the search chooses.
    pub nodes: RangeInclusive<usize>,
    /// Start of the motion, a state.
    pub start: Vec<f64>,
    /// End of the motion.
    pub goal: Goal,
    /// Limits of commands and states.
    pub limits: LimitsOf,
    /// Limits of states that only cost, and the weight of an excess per second.
    pub soft: (Vec<[f64; 2]>, f64),
    /// Cost.
    pub cost: CostWeights,
    /// Search.
    pub search: Search,
    /// Gains that follow the plan.
    pub follow: Follow,
    /// Trial of the plan.
    pub check: Check,
    /// Policy from anywhere.
    pub policy: PolicyNumbers,
}

/// End of a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Goal {
    /// Least and most of every number of the state; equal for a number that is to be reached.
    pub state: Vec<[f64; 2]>,
    /// Flags of the numbers that are angles of which any whole turn will do.
    pub turns: Vec<bool>,
    /// Energy T + V, J.
    pub energy: Option<f64>,
}

impl Goal {
    /// Middle of the goal; 0 for a number that may be any.
    pub fn middle(&self) -> Vec<f64> {
        let middle = |[least, most]: &[f64; 2]| 0.5 * (least + most);
        self.state.iter().map(middle).map(|x| if x.is_finite() { x } else { 0.0 }).collect()
    }
}

/// Limits that hold.
#[derive(Clone, Debug, PartialEq)]
pub struct LimitsOf {
    /// Least and most of every command; `[0, 0]` for a coordinate that is not driven.
    pub u: Vec<[f64; 2]>,
    /// Part of the range of every command that the plan leaves to feedback.
    pub reserve: f64,
    /// Least and most of every number of the state.
    pub x: Vec<[f64; 2]>,
}

impl LimitsOf {
    /// Whether a coordinate is driven.
    pub fn is_driven(&self, i: usize) -> bool {
        self.u.get(i).is_some_and(|[least, most]| least < most)
    }

    /// Range of a command that the plan may use.
    pub fn planned(&self, i: usize) -> [f64; 2] {
        let [least, most] = self.u[i];
        let kept = 0.5 * self.reserve * (most - least);
        [least + kept, most - kept]
    }
}

/// Cost per second: ½ Σ weight x².
#[derive(Clone, Debug, PartialEq)]
pub struct CostWeights {
    /// Weights of the commands, positive.
    pub u: Vec<f64>,
    /// Weights of the deviations from the goal's middle.
    pub x: Vec<f64>,
    /// Cost of a second.
    pub time: f64,
}

/// Bounds of the search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search {
    /// Seed of the random start guesses.
    pub seed: u64,
    /// Number of start guesses.
    pub starts: usize,
    /// Maximum number of iterations of each.
    pub iterations: u16,
}

/// Deviations of equal weight for the gains.
#[derive(Clone, Debug, PartialEq)]
pub struct Follow {
    /// Deviations of the state.
    pub x: Vec<f64>,
    /// Deviations of the commands.
    pub u: Vec<f64>,
}

/// Trial of a plan from other starts.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// Number of starts.
    pub starts: usize,
    /// Largest deviations of the starts, a state.
    pub x: Vec<f64>,
    /// Part by which masses are off.
    pub masses: f64,
}

/// Numbers of a policy from anywhere.
#[derive(Clone, Debug, PartialEq)]
pub struct PolicyNumbers {
    /// Number of starts from which motions are searched.
    pub starts: usize,
    /// Distances from the goal within which the regulator is tried, a state.
    pub catch: Vec<f64>,
    /// Velocities of the starts, if they are given.
    pub speeds: Option<Vec<f64>>,
}

impl Task {
    /// Number of coordinates n.
    pub fn n(&self) -> usize {
        self.limits.u.len()
    }

    /// Cost of the time that a node takes.
    pub fn time_per_node(&self) -> f64 {
        self.cost.time * self.node_seconds()
    }

    /// Whether every coordinate is driven.
    pub fn is_fully_driven(&self) -> bool {
        (0..self.n()).all(|i| self.limits.is_driven(i))
    }

    /// Duration of a node, s.
    pub fn node_seconds(&self) -> f64 {
        self.tick * f64::from(self.ticks_per_node)
    }
}
