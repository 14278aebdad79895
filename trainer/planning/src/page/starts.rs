//! The course of the search from all start guesses.

use crate::{Plan, StartReport};
use leastaction_core::control::Iteration;
use leastaction_plot::page::{escaped, number, paragraph, picture, table};
use leastaction_plot::{NotDrawn, Panel, Series, Vertical, stacked_svg};

/// Chart of the best search and table of all.
///
/// # Errors
/// [`NotDrawn`] if the chart cannot be drawn.
pub fn search(plan: &Plan) -> Result<Vec<String>, NotDrawn> {
    let about = "The first search is that of the plan. Costs are without the cost of the time.";
    let mut parts = vec![paragraph(about), all(&plan.starts)];
    if let Some(best) = plan.starts.first().filter(|best| !best.iterations.is_empty()) {
        parts.push(picture(&convergence(best)?));
    }
    Ok(parts)
}

/// Chart of cost and violation over the iterations of a search.
fn convergence(of: &StartReport) -> Result<String, NotDrawn> {
    let at = |value: fn(&Iteration<f64>) -> f64| {
        of.iterations.iter().map(move |iteration| (f64::from(iteration.count), value(iteration)))
    };
    let cost = [Series::new("cost with the penalties of limits and goal", at(|of| of.cost))];
    let violation = [Series::new("largest violation of limits and goal", at(|of| of.violation))];
    let positive = of.iterations.iter().all(|of| of.cost > 0.0);
    let vertical = if positive { Vertical::Logarithmic } else { Vertical::Linear };
    let panels = [
        Panel::new("cost", &cost).with_vertical(vertical),
        Panel::new("violation", &violation).with_vertical(Vertical::Logarithmic),
    ];
    stacked_svg(&format!("Search from the start guess “{}”", of.guess), "iteration", &panels)
}

fn all(starts: &[StartReport]) -> String {
    let head = ["start guess", "nodes", "cost", "violation", "iterations", "seconds", "end of the search"];
    let row = |start: &StartReport| {
        let solution = &start.solution;
        vec![
            escaped(&start.guess),
            start.nodes.to_string(),
            number(solution.cost),
            number(solution.violation),
            solution.iterations.to_string(),
            number(start.seconds),
            escaped(start.ending()),
        ]
    };
    table(&head, &[0, 6], &starts.iter().map(row).collect::<Vec<_>>())
}
