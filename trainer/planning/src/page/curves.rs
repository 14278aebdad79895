//! Charts of positions, velocities and commands with their limits.

use super::words::Words;
use crate::Plan;
use leastaction_plot::page::{paragraph, picture};
use leastaction_plot::{NotDrawn, Panel, Series, Stroke, stacked_svg};

/// Curves of every panel, with the labels of the panels.
type Panels = Vec<(String, Vec<Series>)>;

/// Charts of a plan over time.
///
/// # Errors
/// [`NotDrawn`] if a chart cannot be drawn.
pub fn course(plan: &Plan, words: &Words) -> Result<Vec<String>, NotDrawn> {
    let n = words.n();
    let positions = (0..n).map(|i| labelled(words, i, words.unit(i), state(plan, "q", i))).collect();
    let velocities =
        (0..n).map(|i| labelled(words, i, words.speed_unit(i), state(plan, "v", n + i))).collect();
    let driven = (0..n).filter(|i| plan.task.limits.is_driven(*i));
    let commands = driven.map(|i| labelled(words, i, words.force_unit(i), command(plan, i))).collect();
    let about = "Dashed lines are limits. Thin lines are the edges of the tube in which feedback stays within the limits of the drives; \
                 they are left out where the tube is wider than the motion.";
    Ok(vec![
        paragraph(about),
        drawn("Positions", &positions)?,
        drawn("Velocities", &velocities)?,
        drawn("Commands", &commands)?,
    ])
}

fn labelled(words: &Words, i: usize, unit: &str, curves: Vec<Series>) -> (String, Vec<Series>) {
    (format!("{} ({unit})", words.name(i)), curves)
}

fn drawn(title: &str, panels: &Panels) -> Result<String, NotDrawn> {
    let panels: Vec<_> = panels.iter().map(|(label, curves)| Panel::new(label, curves)).collect();
    Ok(picture(&stacked_svg(title, "time (s)", &panels)?))
}

/// Curves of a number of the state: itself, its tube and its limits.
fn state(plan: &Plan, label: &str, k: usize) -> Vec<Series> {
    let dt = plan.task.node_seconds();
    let nodes = plan.nodes.iter().chain([&plan.end]).zip(0_u32..);
    let path: Vec<(f64, f64)> = nodes.map(|(node, at)| (dt * f64::from(at), node.x[k])).collect();
    let tube = [-1.0, 1.0].map(|side| edge(plan, k, &path, side)).into_iter().flatten();
    let limits = lines(plan, "limit", plan.task.limits.x[k]);
    std::iter::once(Series::new(label, path.clone())).chain(tube).chain(limits).collect()
}

/// Edge of the tube on one side of a path, interrupted where it is wider than the motion; `None` without a tube to be seen.
fn edge(plan: &Plan, k: usize, path: &[(f64, f64)], side: f64) -> Option<Series> {
    let range = path.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], (_, x)| [a.min(*x), b.max(*x)]);
    let most = (range[1] - range[0]).max(0.1);
    let at = |((t, x), widths): (&(f64, f64), &Vec<f64>)| {
        let width = widths.get(k).copied().filter(|width| *width <= most);
        (*t, width.map_or(f64::NAN, |width| x + side * width))
    };
    let points: Vec<_> = path.iter().zip(&plan.tube.widths).map(at).collect();
    let seen = plan
        .tube
        .widths
        .iter()
        .filter_map(|widths| widths.get(k))
        .any(|width| *width > 0.0 && *width <= most);
    seen.then(|| Series::new("tube", points).with_stroke(Stroke::Thin))
}

/// Horizontal dashed lines at the finite ends of a range.
fn lines(plan: &Plan, label: &'static str, range: [f64; 2]) -> impl Iterator<Item = Series> {
    let end = plan.seconds();
    let line = move |x: f64| Series::new(label, [(0.0, x), (end, x)]).with_stroke(Stroke::Dashed);
    range.into_iter().filter(|x| x.is_finite()).map(line)
}

/// Curves of a command: its steps, its limits, and those of the plan if it keeps a reserve.
fn command(plan: &Plan, i: usize) -> Vec<Series> {
    let dt = plan.task.node_seconds();
    let step =
        |(node, at): (&crate::PlanNode, u32)| [at, at + 1].map(|edge| (dt * f64::from(edge), node.u[i]));
    let steps = plan.nodes.iter().zip(0_u32..).flat_map(step);
    let limits = &plan.task.limits;
    let kept = (limits.reserve > 0.0).then(|| lines(plan, "less the reserve", limits.planned(i)));
    let lines = lines(plan, "limit", limits.u[i]).chain(kept.into_iter().flatten());
    std::iter::once(Series::new("u", steps)).chain(lines).collect()
}
