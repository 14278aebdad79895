//! Reach of the linear feedback, in words and numbers.

use super::words::{Words, count};
use crate::Plan;
use leastaction_plot::page::{cell, escaped, list, number, paragraph, table};

/// Part of a command's range below which its distance from a limit counts as none.
const AT_LIMIT: f64 = 1e-6;

/// Says how far the feedback reaches at the start, in the middle and at the end of a plan.
pub fn margins(plan: &Plan, words: &Words) -> Vec<String> {
    let Some(last) = plan.tube.widths.len().checked_sub(1) else {
        return vec![paragraph("No gains could be computed for this motion.")];
    };
    let about = "Half-widths of the tube: from within it the gains bring the motion back without a drive at its limit, as far as the motion \
                 is linear. It is an ellipsoid, whose full width a number reaches only together with others.";
    let nodes = [0, last / 2, last];
    let rows: Vec<_> = (0..2 * words.n()).map(|k| row(plan, words, nodes, k)).collect();
    let head = ["deviation of", "at the start", "in the middle", "at the end"];
    let mut parts =
        vec![paragraph(about), paragraph(&narrowest(plan, words, nodes)), table(&head, &[0], &rows)];
    let none = plan.tube.widths.iter().filter(|widths| is_none(widths)).count();
    if none > 0 {
        parts.push(without(plan, words, none));
    }
    parts
}

/// Sentence on the narrowest positions of the tube.
fn narrowest(plan: &Plan, words: &Words, nodes: [usize; 3]) -> String {
    let at = |(node, place): (usize, &str)| {
        let widths = plan.tube.widths[node].iter().take(words.n()).enumerate();
        let (i, width) = widths.min_by(|a, b| a.1.total_cmp(b.1))?;
        Some(format!("{} {place} ({})", half_width(*width, words.unit(i)), words.name(i)))
    };
    let places = ["at the start", "in the middle", "at the end"];
    let texts: Vec<_> = nodes.into_iter().zip(places).filter_map(at).collect();
    format!("The position in which it is narrowest may be off by {}.", texts.join(", "))
}

fn half_width(width: f64, unit: &str) -> String {
    match width {
        0.0 => "nothing".to_owned(),
        width if width.is_finite() => format!("{} {unit}", number(width)),
        _ => "any distance".to_owned(),
    }
}

fn is_none(widths: &[f64]) -> bool {
    widths.iter().all(|width| *width == 0.0)
}

fn row(plan: &Plan, words: &Words, nodes: [usize; 3], k: usize) -> Vec<String> {
    let n = words.n();
    let (i, kind) = (k % n, if k < n { "position" } else { "velocity" });
    let unit = if k < n { words.unit(i) } else { words.speed_unit(i) };
    let text = |node: usize| match plan.tube.widths[node].get(k) {
        Some(0.0) => "0".to_owned(),
        Some(width) if width.is_finite() => format!("± {}", number(*width)),
        _ => "any".to_owned(),
    };
    let name = cell(escaped(words.name(i)), &format!("{kind}, {unit}"));
    std::iter::once(name).chain(nodes.map(text)).collect()
}

/// Reasons for a tube without width, and the remedy.
fn without(plan: &Plan, words: &Words, none: usize) -> String {
    let saturated: Vec<_> = (0..words.n()).filter_map(|i| at_limit(plan, words, i)).collect();
    let (nodes, all) = (count(none, "node"), plan.nodes.len());
    if saturated.is_empty() {
        let text =
            format!("The reach is 0 in {nodes} of {all}: the gains there say nothing about deviations.");
        return paragraph(&text);
    }
    let text = format!(
        "The reach is 0 in {nodes} of {all}, up to the last one with a command at its limit: there feedback has no force left in one \
         direction. Set [limits] reserve = 0.1, which keeps a tenth of every range for feedback, and plan again."
    );
    paragraph(&text) + &list(&saturated)
}

/// Sentence on a command that is at its limit; `None` for one that never is.
fn at_limit(plan: &Plan, words: &Words, i: usize) -> Option<String> {
    let [least, most] = plan.task.limits.u[i];
    let close = AT_LIMIT * (most - least);
    let at = |u: f64| (u - least).min(most - u) <= close;
    let nodes: Vec<usize> = (0..plan.nodes.len()).filter(|k| at(plan.nodes[*k].u[i])).collect();
    let last = plan.task.limits.is_driven(i).then(|| nodes.last()).flatten()?;
    let until = number((last + 1) as f64 * plan.task.node_seconds());
    let (name, nodes) = (words.name(i), count(nodes.len(), "node"));
    Some(format!("The command of {name} is at a limit in {nodes}, the last of which ends at {until} s."))
}
