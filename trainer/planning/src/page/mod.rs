//! The page of a plan: facts, the motion drawn over time, charts with limits, margins, and the course of the search.

mod curves;
mod drawing;
mod facts;
mod margins;
mod motion;
mod moving;
mod particles;
mod scene;
mod schematic;
mod skeleton;
mod starts;
mod view;
mod words;

use crate::{Machine, Plan};
use leastaction_plot::{NotDrawn, page as html};
pub use moving::moving_picture;
pub use scene::Scene;
pub use skeleton::Part;
pub use view::View;
use words::Words;

/// Returns a self-contained HTML page that shows a plan.
///
/// A script moves the drawn mechanism; without it the page shows everything else.
///
/// # Errors
/// [`NotDrawn`] if a chart cannot be drawn.
pub fn page(plan: &Plan, machine: &Machine) -> Result<String, NotDrawn> {
    let words = Words::new(machine);
    let title = format!("Plan of {} for {}", words.duration(plan.seconds()), words.model());
    let body = [
        facts::verdict(plan, machine),
        facts::facts(plan, &words),
        html::section("Coordinates", &facts::coordinates(plan, &words)),
        html::section("Motion", &motion::motion(plan, machine)),
        html::section("Course", &curves::course(plan, &words)?),
        html::section("Reach of the feedback", &margins::margins(plan, &words)),
        html::section("Search", &starts::search(plan)?),
    ];
    Ok(html::page(&title, &body.concat()))
}
