//! Facts about a plan, in words and numbers.

use super::words::{Words, count, interval, percent};
use crate::{ACCEPTED, Machine, Plan, PlanNode};
use leastaction_plot::page::{self as html, cell, escaped, list, loud, number, paragraph, table};

/// Says whether the plan can be used; loud if it cannot.
pub fn verdict(plan: &Plan, machine: &Machine) -> String {
    let met = match plan.worst(machine) {
        None => paragraph("Limits and goal are met."),
        Some(worst) => loud(&format!(
            "NOT FEASIBLE: {worst}. Do not run this motion. Give it more seconds, wider [limits], or more [search] starts."
        )),
    };
    let stopped = "The search was stopped before its end; this is the best motion that it had found.";
    met + &if plan.interrupted { loud(stopped) } else { String::new() }
}

/// Table of facts about the whole plan, and the notes on the model.
pub fn facts(plan: &Plan, words: &Words) -> String {
    html::facts(&pairs(plan, words)) + &list(words.notes())
}

fn pairs(plan: &Plan, words: &Words) -> Vec<(&'static str, String)> {
    let (task, nodes) = (&plan.task, plan.nodes.len());
    let (ticks, tick) = (usize::from(task.ticks_per_node), number(1e3 * task.tick));
    let mut pairs = vec![
        ("model", words.model()),
        ("duration", words.duration(plan.seconds())),
        ("steps", format!("{} of {}; a tick lasts {tick} ms", count(nodes, "node"), count(ticks, "tick"))),
        ("cost", cost(plan)),
        ("violation", format!("{}; up to {} is accepted", number(plan.solution.violation), number(ACCEPTED))),
        ("limits and goal", if plan.is_feasible() { "met" } else { "NOT met" }.to_owned()),
        ("end", end(plan).to_owned()),
        ("reserve", reserve(task.limits.reserve)),
    ];
    pairs.extend(task.goal.energy.map(|energy| ("energy of the goal", format!("{} J", number(energy)))));
    pairs.extend(plan.energy.map(|energy| ("energy at the end", format!("{} J", number(energy)))));
    pairs
}

fn cost(plan: &Plan) -> String {
    let time = plan.task.cost.time * plan.seconds();
    let part = if time > 0.0 { format!(", {} of it for the time", number(time)) } else { String::new() };
    number(plan.cost) + &part
}

fn end(plan: &Plan) -> &'static str {
    if plan.holds {
        "a rest that the drives hold"
    } else {
        "NOT held by the drives: the mechanism moves on, or needs forces that they do not have"
    }
}

fn reserve(part: f64) -> String {
    if part > 0.0 {
        format!("{} of the range of every command is kept for feedback", percent(part))
    } else {
        "none: the plan may use the whole range of every command".to_owned()
    }
}

/// Table with start, goal, end and largest values of every coordinate.
pub fn coordinates(plan: &Plan, words: &Words) -> Vec<String> {
    let head =
        ["coordinate", "start q, v", "goal q, v", "end q, v", "largest |q|", "largest |v|", "largest |u|"];
    let rows: Vec<_> = (0..words.n()).map(|i| coordinate(plan, words, i)).collect();
    let about = "Shares are of the way from the middle of a range of limits to its end.";
    vec![table(&head, &[0], &rows), paragraph(about)]
}

fn coordinate(plan: &Plan, words: &Words, i: usize) -> Vec<String> {
    let (task, n) = (&plan.task, words.n());
    let pair = |of: &dyn Fn(usize) -> String| cell(escaped(&of(i)), &of(n + i));
    let states = || plan.nodes.iter().chain([&plan.end]).map(|node: &PlanNode| &node.x);
    let state = |k: usize, unit| largest(states().map(move |x| x[k]), task.limits.x[k], unit);
    let command = if task.limits.is_driven(i) {
        largest(plan.nodes.iter().map(|node| node.u[i]), task.limits.u[i], words.force_unit(i))
    } else {
        cell("–", "not driven")
    };
    vec![
        cell(escaped(words.name(i)), words.unit(i)),
        pair(&|k| number(task.start[k])),
        pair(&|k| interval(task.goal.state[k])),
        pair(&|k| number(plan.end.x[k])),
        state(i, words.unit(i)),
        state(n + i, words.speed_unit(i)),
        command,
    ]
}

/// Cell with the largest size of a quantity, and its share of the limits.
fn largest(values: impl Iterator<Item = f64> + Clone, limits: [f64; 2], unit: &str) -> String {
    let size = values.clone().fold(0.0, |most: f64, x| most.max(x.abs()));
    let share = share(values, limits)
        .map_or("no limit".to_owned(), |share| format!("{} of {}", percent(share), interval(limits)));
    cell(format!("{} {unit}", number(size)), &share)
}

/// Largest distance from the middle of a range, relative to its ends; `None` for a range without one of them.
fn share(values: impl Iterator<Item = f64>, [least, most]: [f64; 2]) -> Option<f64> {
    let (middle, half) = (0.5 * (least + most), 0.5 * (most - least));
    (half.is_finite() && half > 0.0)
        .then(|| values.fold(0.0, |part: f64, x| part.max((x - middle).abs() / half)))
}
