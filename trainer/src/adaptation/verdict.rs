//! Findings along a log in a few sentences.

use super::Report;
use leastaction_adaptation::Course;
use leastaction_plot::page::{list, loud, number, paragraph, with_error};

/// Largest number of changes that are named.
const NAMED: usize = 8;

/// Sentences on what was found; loud where the findings are not to be used.
pub fn sentences(report: &Report, course: &Course) -> String {
    let quiet = [attached(report, course), torques(report), changes(report)];
    let quiet: Vec<String> = quiet.into_iter().flatten().collect();
    warnings(report).iter().map(|text| loud(text)).collect::<String>() + &list(&quiet)
}

fn warnings(report: &Report) -> Vec<&'static str> {
    let mut warnings = Vec::new();
    if report.unlike {
        warnings.push(
            "NOT THE MACHINE THAT WAS LEARNED: changes follow each other, and no choice of these numbers explains the log. Do not use them.",
        );
    }
    if !report.numbers.iter().any(|number| number.is_found()) {
        warnings.push(
            "THE LOG SHOWS NOTHING: every standard error is still more than half of what it was before the log. The machine moves too little, \
             or the model is too uncertain in itself.",
        );
    } else if report.attached().is_some_and(|mass| !mass.is_found()) {
        warnings.push(
            "THE LOG DOES NOT SHOW WHETHER SOMETHING IS ATTACHED: the standard error of the mass is still more than half of what it was before \
             the log. The machine moves too little, or such a mechanism shows the mass only together with moments.",
        );
    }
    warnings
}

fn attached(report: &Report, course: &Course) -> Option<String> {
    let mass = with_error(report.mass?, report.standard_error?);
    let of = report.attached().map_or("", |mass| &mass.name);
    let of = of.strip_prefix("m of ").unwrap_or(of);
    let mass = format!("Mass attached to {of} at the end of the log: {mass} kg (estimate ± standard error).");
    let announced = match (course.announced, report.seconds_to_announce) {
        (Some((t, then)), Some(moving)) => format!(
            "Announced after {} s of motion, {} s from the beginning of the log; then {} kg.",
            number(moving),
            number(t),
            with_error(then.estimate.into(), then.error.into())
        ),
        _ => "Nothing was announced as attached.".to_owned(),
    };
    Some(format!("{mass} {announced}"))
}

fn torques(report: &Report) -> Option<String> {
    let (before, after) = (report.nmse_before?, report.nmse_after?);
    let worse = if after > before {
        " These numbers come from the time that is remembered; they explain the log as a whole worse than those of the model."
    } else {
        ""
    };
    Some(format!(
        "Squared error of the torques over their variance, mean over coordinates: {} by the model, {} with the numbers at the end of the \
         log.{worse}",
        number(before),
        number(after)
    ))
}

fn changes(report: &Report) -> Option<String> {
    let changes = &report.changes;
    let named: Vec<String> = changes.iter().take(NAMED).map(|t| number(*t)).collect();
    let rest = match changes.len().saturating_sub(NAMED) {
        0 => String::new(),
        rest => format!(" and {rest} times more"),
    };
    (!changes.is_empty()).then(|| format!("Something changed at once at {} s{rest}.", named.join(", ")))
}

/// Paragraph on bands, cuts and marks of the charts.
pub fn about_charts() -> String {
    paragraph(
        "Thin lines are the edges of estimate ± 2 standard errors, dashed lines the numbers in use: they follow the estimate within half a \
         window and stay within limits. Curves are cut where they leave the charts, as before anything was seen. Vertical lines mark the \
         announcement and times at which something changed at once.",
    )
}
