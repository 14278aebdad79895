//! The learned numbers with what the logs say of them.

use super::page::{escaped, folded, list, number, paragraph, section, table};
use crate::architecture::{Architecture, NumberName};
use crate::windows::{CalibrationLayout, Certainty, LearnedNumber, Shown};

/// A number whose standard error is more than this part of it is hardly shown.
const HARDLY: f64 = 0.5;

/// Names of all numbers that windows share.
pub(super) struct Names<'a> {
    weights: Vec<Option<NumberName>>,
    layout: &'a CalibrationLayout,
    letters: String,
}

impl<'a> Names<'a> {
    pub fn new(architecture: &Architecture, layout: &'a CalibrationLayout) -> Self {
        Self { weights: architecture.number_names(), layout, letters: architecture.coordinates() }
    }

    /// Name and unit; none of a weight of a network.
    fn of(&self, position: usize) -> Option<(String, &'static str)> {
        match self.weights.get(position) {
            Some(name) => name.as_ref().map(|name| (name.name.clone(), name.unit)),
            None => self.layout.name(position, |i| super::unit_of(&self.letters, i)),
        }
    }

    fn is_zero(&self, position: usize) -> bool {
        position >= self.layout.zero(0, 0)
    }
}

/// The sections on numbers, and on what was not shown.
pub(super) fn sections(certainty: &Certainty, names: &Names) -> [String; 2] {
    let named = |of: &&LearnedNumber| names.of(of.position).is_some();
    let (zeros, others): (Vec<_>, Vec<_>) =
        certainty.numbers.iter().filter(named).partition(|of| names.is_zero(of.position));
    let unnamed = certainty.numbers.iter().filter(|of| !named(of)).count();
    let networks = if unnamed > 0 {
        paragraph(&format!("Beside them {unnamed} weights of networks."))
    } else {
        String::new()
    };
    let mut parts = vec![paragraph(&about(certainty))];
    if !others.is_empty() {
        parts.push(rows(&others, names));
    }
    if !zeros.is_empty() {
        parts.push(folded("zero offsets of encoders, log by log", &rows(&zeros, names)));
    }
    parts.push(networks);
    [section("What was learned", &parts), not_shown(certainty, names)]
}

fn about(certainty: &Certainty) -> String {
    let of = if certainty.whole_logs { "logs" } else { "parts of logs" };
    format!(
        "± is a standard error: in two of three cases a number is no further off, in 95 of 100 no further than {:.2} times as much, if the \
         model is right. The residuals of {} {of} were taken to be independent of one another, those within one not. A correlation \
         near 1 or -1 says that two numbers are known together better than each.",
        certainty.interval(),
        certainty.clusters
    )
}

fn rows(numbers: &[&LearnedNumber], names: &Names) -> String {
    let row = |of: &&LearnedNumber| -> Option<Vec<String>> {
        let (name, unit) = names.of(of.position)?;
        let within = match of.shown {
            Shown::Within(error) => format!("± {}", number(error)),
            Shown::Together => "not shown alone".to_owned(),
            Shown::AtBound => "at the end of its range".to_owned(),
        };
        let strongest = of.strongest.map_or((String::new(), String::new()), |(position, part)| {
            let name =
                names.of(position).map_or_else(|| "a weight of a network".to_owned(), |(name, _)| name);
            (format!("{part:.2}"), escaped(&name))
        });
        let value = format!("<b>{}</b>", number(of.value));
        Some(vec![escaped(&name), value, within, escaped(unit), strongest.0, strongest.1])
    };
    let rows: Vec<Vec<String>> = numbers.iter().filter_map(row).collect();
    table(&["number", "value", "", "unit", "strongest correlation", "with"], &[0, 3, 5], &rows)
}

fn not_shown(certainty: &Certainty, names: &Names) -> String {
    let of = |shown: &dyn Fn(&LearnedNumber) -> bool| -> Vec<String> {
        let numbers = certainty.numbers.iter().filter(|of| shown(of));
        numbers.filter_map(|of| names.of(of.position)).map(|(name, _)| name).collect()
    };
    let mut items = Vec::new();
    let together = of(&|of| of.shown == Shown::Together);
    if !together.is_empty() {
        items.push(format!(
            "Only in combination, {} of which the logs leave free: {}. What is free stays near where it began.",
            certainty.hidden,
            together.join("; ")
        ));
    }
    let bounds = of(&|of| of.shown == Shown::AtBound);
    if !bounds.is_empty() {
        items.push(format!("At the end of its range: {}.", bounds.join("; ")));
    }
    let hardly = of(&|of| {
        matches!(of.shown, Shown::Within(error) if error > HARDLY * of.value.abs())
            && !names.is_zero(of.position)
    });
    if !hardly.is_empty() {
        items.push(format!(
            "Hardly, the standard error being more than half of the number: {}.",
            hardly.join("; ")
        ));
    }
    if items.is_empty() {
        items.push("Nothing: every number is shown.".to_owned());
    }
    section("What the logs do not show", &[list(&items)])
}
