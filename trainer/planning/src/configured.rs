//! From a configuration and a machine to numbers that have been checked.

use crate::config::{
    CheckConfig, CostConfig, DEFAULT_NODES, FollowConfig, GoalConfig, PlanConfig, PolicyConfig, Range,
    Seconds,
};
use crate::task::{Check, CostWeights, Follow, Goal, LimitsOf, PolicyNumbers, Search, Task};
use crate::{Machine, PlanError};
use leastaction_core::discrete::Order;
use std::ops::RangeInclusive;

/// Maximum number of nodes.
const MAX_NODES: usize = 100_000;
/// Any number.
const ANY: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
/// Default distances of positions and velocities from the goal within which the regulator of a policy is tried.
const CATCH: [f64; 2] = [0.1, 0.5];
/// Default deviations of positions and velocities for the gains.
const DEVIATIONS: [f64; 2] = [0.1, 1.0];

impl Task {
    /// Completes a configuration by what the machine knows, and checks every number.
    ///
    /// # Errors
    /// [`PlanError::Value`] with the key.
    pub fn new(config: &PlanConfig, machine: &Machine) -> Result<Self, PlanError> {
        let n = machine.n();
        let (tick, order) = step(config, machine)?;
        let (ticks_per_node, nodes) = nodes(config, tick)?;
        let limits = limits(config, machine)?;
        let start = [
            exactly("start.q", n, &config.start.q)?,
            exactly("start.v", n, config.start.v.as_ref().unwrap_or(&vec![0.0; n]))?,
        ]
        .concat();
        let goal = goal(&config.goal, config, machine)?;
        let soft_x = state_limits(["soft.q", "soft.v"], n, [&config.soft.q, &config.soft.v], None)?;
        positive("soft.weight", config.soft.weight)?;
        let task = Self {
            tick,
            order,
            ticks_per_node,
            nodes,
            start,
            goal,
            soft: (soft_x, config.soft.weight),
            cost: cost(&config.cost, &limits)?,
            search: search(config)?,
            follow: follow(&config.follow, &limits)?,
            check: check(&config.check, n)?,
            policy: policy(&config.policy, n)?,
            limits,
        };
        task.check(machine)?;
        Ok(task)
    }

    /// Checks that start and goal lie within the limits, and that something is driven.
    fn check(&self, machine: &Machine) -> Result<(), PlanError> {
        let n = self.n();
        let name = |i: usize| (if i < n { "q" } else { "v" }, &machine.names[i % n]);
        for (i, (x, [least, most])) in self.start.iter().zip(&self.limits.x).enumerate() {
            let (kind, joint) = name(i);
            if x < least || x > most {
                let message = format!("of {joint} is {x}, outside its limits {least} … {most}");
                return Err(PlanError::value(format!("start.{kind}"), message));
            }
        }
        for (i, ([from, to], [least, most])) in self.goal.state.iter().zip(&self.limits.x).enumerate() {
            let (kind, joint) = name(i);
            if from > most || to < least {
                let message = format!("of {joint} is {from} … {to}, outside its limits {least} … {most}");
                return Err(PlanError::value(format!("goal.{kind}"), message));
            }
        }
        for i in (0..n).filter(|i| !self.goal.turns[*i]) {
            let [from, to] = self.goal.state[i];
            let way = (from - self.start[i]).max(self.start[i] - to);
            let speed = self.limits.x[n + i].iter().fold(0.0_f64, |most, v| most.max(v.abs()));
            let seconds = *self.nodes.end() as f64 * self.node_seconds();
            if way > speed * seconds {
                let joint = &machine.names[i];
                let least = way / speed;
                let message = format!(
                    "is {seconds}: {joint} needs at least {least:.3} s for its way of {way:.3} at its largest speed {speed}"
                );
                return Err(PlanError::value("seconds", message));
            }
        }
        if !(0..n).any(|i| self.limits.is_driven(i)) {
            let message = "has no driven coordinate: give the largest |u| of every coordinate, 0 for one that is not driven";
            return Err(PlanError::value("limits.u", message));
        }
        Ok(())
    }
}

fn step(config: &PlanConfig, machine: &Machine) -> Result<(f64, Order), PlanError> {
    let trained = machine.model.facts.trained_step;
    let missing =
        || PlanError::value("tick", "is missing, and the model was trained without a step: give the tick, s");
    let tick = config.tick.or(trained.map(|step| f64::from(step.h))).ok_or_else(missing)?;
    positive("tick", tick)?;
    let own = trained.map_or(Order::Two, |step| step.order);
    let order = match config.order {
        None => own,
        Some(number) => Order::from_number(number)
            .ok_or_else(|| PlanError::value("order", format!("is {number}; it is 2 or 4")))?,
    };
    Ok((tick, order))
}

fn nodes(config: &PlanConfig, tick: f64) -> Result<(u16, RangeInclusive<usize>), PlanError> {
    let [shortest, longest] = match config.seconds {
        Seconds::Fixed(seconds) => [seconds; 2],
        Seconds::Free(range) => range,
    };
    positive("seconds", shortest)?;
    positive("seconds", longest)?;
    if shortest > longest {
        return Err(PlanError::value(
            "seconds",
            format!("is [{shortest}, {longest}]: the shortest time comes first"),
        ));
    }
    let wanted = (longest / tick / DEFAULT_NODES as f64).ceil().clamp(1.0, f64::from(u16::MAX));
    let ticks = config.ticks_per_node.unwrap_or(wanted as u16);
    if ticks == 0 {
        return Err(PlanError::value("ticks_per_node", "is 0; a node lasts at least one tick"));
    }
    let count = |seconds: f64| (seconds / (tick * f64::from(ticks))).round();
    let (few, many) = (count(shortest), count(longest));
    if few < 2.0 {
        return Err(PlanError::value(
            "seconds",
            format!("is {shortest}, less than two nodes of {ticks} ticks"),
        ));
    }
    if many > MAX_NODES as f64 {
        let message =
            format!("is {longest}: more than {MAX_NODES} nodes of {ticks} ticks; raise ticks_per_node");
        return Err(PlanError::value("seconds", message));
    }
    Ok((ticks, few as usize..=many as usize))
}

fn limits(config: &PlanConfig, machine: &Machine) -> Result<LimitsOf, PlanError> {
    let (n, given) = (machine.n(), &config.limits);
    let u = match &given.u {
        Some(ranges) => ranges_of("limits.u", n, ranges, true)?,
        None => default_commands(machine)?,
    };
    if u.iter().flatten().any(|u| !u.is_finite()) {
        return Err(PlanError::value("limits.u", "must be finite: a drive has a largest force"));
    }
    if !(0.0..1.0).contains(&given.reserve) {
        return Err(PlanError::value("limits.reserve", format!("is {}; 0 ≤ reserve < 1", given.reserve)));
    }
    let known = Some(machine);
    let x = state_limits(["limits.q", "limits.v"], n, [&given.q, &given.v], known)?;
    Ok(LimitsOf { u, reserve: given.reserve, x })
}

/// Limits of the commands from the description's efforts, else from the range of the training data.
fn default_commands(machine: &Machine) -> Result<Vec<[f64; 2]>, PlanError> {
    let efforts = machine.limits.iter().map(|of| of.effort);
    if efforts.clone().all(f64::is_finite) {
        return Ok(efforts.map(|most| [-most, most]).collect());
    }
    let range = &machine.model.facts.range;
    if range.len() == machine.n() {
        let largest =
            |i: &leastaction_core::model::CoordinateRange| f64::from(i.u.least.abs().max(i.u.most.abs()));
        return Ok(range.iter().map(largest).map(|most| [-most, most]).collect());
    }
    let message = "is missing, and neither a description nor training data give the largest forces";
    Err(PlanError::value("limits.u", message))
}

/// Intervals of positions and velocities; without any, those of the machine.
fn state_limits(
    keys: [&str; 2],
    n: usize,
    given: [&Option<Vec<Range>>; 2],
    machine: Option<&Machine>,
) -> Result<Vec<[f64; 2]>, PlanError> {
    let [q, v] = given;
    let known = |of: fn(&leastaction_models::tree::Limits) -> [f64; 2]| {
        machine.map_or(vec![ANY; n], |machine| machine.limits.iter().map(of).collect())
    };
    let q = match q {
        Some(ranges) => ranges_of(keys[0], n, ranges, false)?,
        None => known(|limits| limits.position),
    };
    let v = match v {
        Some(ranges) => ranges_of(keys[1], n, ranges, true)?,
        None => known(|limits| [-limits.velocity, limits.velocity]),
    };
    Ok([q, v].concat())
}

fn goal(goal: &GoalConfig, config: &PlanConfig, machine: &Machine) -> Result<Goal, PlanError> {
    let n = machine.n();
    if goal.q.is_none() && goal.v.is_none() && goal.energy.is_none() {
        return Err(PlanError::value("goal", "is empty: give q, v or energy"));
    }
    let points = |key: &str, ranges: &Option<Vec<Range>>, default: [f64; 2]| match ranges {
        Some(ranges) => points_of(key, n, ranges),
        None => Ok(vec![default; n]),
    };
    let rest = if goal.energy.is_some() { ANY } else { [0.0; 2] };
    let state = [points("goal.q", &goal.q, ANY)?, points("goal.v", &goal.v, rest)?].concat();
    if goal.energy.is_some_and(|energy| !energy.is_finite()) {
        return Err(PlanError::value("goal.energy", "must be a finite number of joules"));
    }
    // The turns of a joint with limits differ.
    let free = |i: usize| {
        let limited = config
            .limits
            .q
            .as_ref()
            .is_some_and(|q| matches!(q.get(i), Some(Range::Interval(_) | Range::One(_))));
        !limited && machine.limits[i].position == ANY
    };
    let turns = machine.angles().into_iter().enumerate().map(|(i, angle)| angle && free(i));
    Ok(Goal { state, turns: turns.chain(vec![false; n]).collect(), energy: goal.energy })
}

fn cost(config: &CostConfig, limits: &LimitsOf) -> Result<CostWeights, PlanError> {
    let n = limits.u.len();
    let by_limit = |[least, most]: &[f64; 2]| {
        let largest = least.abs().max(most.abs());
        if largest > 0.0 { 1.0 / (largest * largest) } else { 1.0 }
    };
    let u = match &config.u {
        Some(u) => exactly("cost.u", n, u)?,
        None => limits.u.iter().map(by_limit).collect(),
    };
    for (i, weight) in u.iter().enumerate() {
        if limits.is_driven(i) {
            positive("cost.u", *weight)?;
        }
    }
    let u = u.into_iter().enumerate().map(|(i, weight)| if limits.is_driven(i) { weight } else { 1.0 });
    let zero = vec![0.0; n];
    let x = [
        exactly("cost.q", n, config.q.as_ref().unwrap_or(&zero))?,
        exactly("cost.v", n, config.v.as_ref().unwrap_or(&zero))?,
    ]
    .concat();
    if x.iter().chain([&config.time]).any(|weight| *weight < 0.0 || !weight.is_finite()) {
        return Err(PlanError::value("cost", "has a negative weight"));
    }
    Ok(CostWeights { u: u.collect(), x, time: config.time })
}

fn search(config: &PlanConfig) -> Result<Search, PlanError> {
    let crate::config::SearchConfig { seed, starts, iterations } = config.search;
    if starts == 0 || iterations == 0 {
        return Err(PlanError::value("search", "needs at least one start and one iteration"));
    }
    Ok(Search { seed, starts, iterations })
}

fn follow(config: &FollowConfig, limits: &LimitsOf) -> Result<Follow, PlanError> {
    let n = limits.u.len();
    let [q, v] = DEVIATIONS.map(|deviation| vec![deviation; n]);
    let x = [
        exactly("follow.q", n, config.q.as_ref().unwrap_or(&q))?,
        exactly("follow.v", n, config.v.as_ref().unwrap_or(&v))?,
    ]
    .concat();
    let half = |[least, most]: &[f64; 2]| if least < most { 0.25 * (most - least) } else { 1.0 };
    let u = match &config.u {
        Some(u) => exactly("follow.u", n, u)?,
        None => limits.u.iter().map(half).collect(),
    };
    for (key, x) in x.iter().map(|x| ("follow", *x)).chain(u.iter().map(|u| ("follow.u", *u))) {
        positive(key, x)?;
    }
    Ok(Follow { x, u })
}

fn policy(config: &PolicyConfig, n: usize) -> Result<PolicyNumbers, PlanError> {
    if config.starts == 0 {
        return Err(PlanError::value("policy.starts", "is 0; a policy needs at least one start"));
    }
    let [q, v] = CATCH.map(|distance| vec![distance; n]);
    let catch = [
        exactly("policy.q", n, config.q.as_ref().unwrap_or(&q))?,
        exactly("policy.v", n, config.v.as_ref().unwrap_or(&v))?,
    ]
    .concat();
    let speeds = config.speeds.as_ref().map(|speeds| exactly("policy.speeds", n, speeds)).transpose()?;
    let catches = catch.iter().map(|x| ("policy", *x));
    for (key, x) in catches.chain(speeds.iter().flatten().map(|x| ("policy.speeds", *x))) {
        positive(key, x)?;
    }
    Ok(PolicyNumbers { starts: config.starts, catch, speeds })
}

fn check(config: &CheckConfig, n: usize) -> Result<Check, PlanError> {
    let CheckConfig { starts, q, v, masses } = *config;
    for (key, x) in [("check.q", q), ("check.v", v), ("check.masses", masses)] {
        if !(x >= 0.0 && x.is_finite()) {
            return Err(PlanError::value(key, format!("is {x}; it must not be negative")));
        }
    }
    if masses >= 1.0 {
        return Err(PlanError::value("check.masses", format!("is {masses}; it is a part below 1")));
    }
    Ok(Check { starts, x: [vec![q; n], vec![v; n]].concat(), masses })
}

/// Numbers of a list, which must be n finite ones.
pub(crate) fn exactly(key: &str, n: usize, list: &[f64]) -> Result<Vec<f64>, PlanError> {
    check_length(key, n, list.len())?;
    match list.iter().find(|x| !x.is_finite()) {
        Some(x) => Err(PlanError::value(key, format!("has {x}, which is not a number"))),
        None => Ok(list.to_vec()),
    }
}

fn check_length(key: &str, n: usize, found: usize) -> Result<(), PlanError> {
    if found == n {
        return Ok(());
    }
    Err(PlanError::value(
        key,
        format!("has {found} values, but the model has {n} coordinates: give one for each"),
    ))
}

fn positive(key: &str, x: f64) -> Result<(), PlanError> {
    if x > 0.0 && x.is_finite() {
        Ok(())
    } else {
        Err(PlanError::value(key, format!("is {x}; it must be positive")))
    }
}

/// Intervals; a single number stands for its size to both sides if `symmetric`.
fn ranges_of(key: &str, n: usize, ranges: &[Range], symmetric: bool) -> Result<Vec<[f64; 2]>, PlanError> {
    check_length(key, n, ranges.len())?;
    let interval = |range: &Range| match *range {
        Range::One(x) if symmetric && x >= 0.0 && x.is_finite() => Ok([-x, x]),
        Range::One(x) if symmetric => {
            Err(PlanError::value(key, format!("has {x}; a largest size is not negative")))
        }
        Range::One(x) => {
            Err(PlanError::value(key, format!("has {x}; give [least, most], or [] for no limit")))
        }
        Range::Interval(range) => checked(key, range),
        Range::Any([]) => Ok(ANY),
    };
    ranges.iter().map(interval).collect()
}

/// Intervals; a single number stands for itself.
fn points_of(key: &str, n: usize, ranges: &[Range]) -> Result<Vec<[f64; 2]>, PlanError> {
    check_length(key, n, ranges.len())?;
    let interval = |range: &Range| match *range {
        Range::One(x) => checked(key, [x; 2]),
        Range::Interval(range) => checked(key, range),
        Range::Any([]) => Ok(ANY),
    };
    ranges.iter().map(interval).collect()
}

fn checked(key: &str, [least, most]: [f64; 2]) -> Result<[f64; 2], PlanError> {
    if least.is_nan() || most.is_nan() || least > most || least == f64::INFINITY || most == f64::NEG_INFINITY
    {
        return Err(PlanError::value(
            key,
            format!("has [{least}, {most}]; the least comes first, and neither is nan"),
        ));
    }
    Ok([least, most])
}
