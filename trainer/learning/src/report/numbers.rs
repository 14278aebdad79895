//! The learned numbers with their standard errors.

use crate::torque_numbers::TorqueNumbers;
use crate::training::Combination;
use crate::windows::{CalibrationLayout, Certainty, LearnedNumber, Shown};
use leastaction_models::{Architecture, NumberName};
use leastaction_plot::page::{escaped, folded, list, number, paragraph, section, table};
use serde::Serialize;

/// Relative standard error above which a number counts as poorly determined.
const HARDLY: f64 = 0.5;

/// Largest number of numbers that are named in a combination.
const MOST_NAMED: usize = 12;

/// Names of all numbers by position, with the model's values where these differ from the estimates.
pub(super) struct Names {
    /// Names; `None` for a network weight.
    names: Vec<Option<NumberName>>,
    model: Option<Vec<f64>>,
    /// Position of the first encoder zero offset.
    zeros: usize,
}

impl Names {
    /// Names of the numbers that all windows share.
    pub fn of_windows(architecture: &Architecture, layout: &CalibrationLayout) -> Self {
        let (mut names, letters) = (architecture.number_names(), architecture.coordinates());
        let of_calibration = |position: usize| {
            let (name, unit) = layout.name(position, |i| super::unit_of(&letters, i))?;
            Some(NumberName { name, unit })
        };
        names.extend((names.len()..layout.end()).map(of_calibration).collect::<Vec<_>>());
        Self { names, model: None, zeros: layout.zero(0, 0) }
    }

    /// Names of the numbers on which torques depend.
    pub fn of_torques(numbers: &TorqueNumbers) -> Self {
        let names: Vec<_> = numbers.full_names().map(Some).collect();
        Self { zeros: names.len(), names, model: Some(numbers.model.clone()) }
    }

    /// Name and unit; `None` for a network weight.
    fn of(&self, position: usize) -> Option<(String, &'static str)> {
        let name = self.names.get(position)?.as_ref()?;
        Some((name.name.clone(), name.unit))
    }

    fn is_zero(&self, position: usize) -> bool {
        position >= self.zeros
    }
}

/// A named number that was learned over windows.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NamedEstimate {
    /// Name of the number.
    pub name: String,
    /// Unit.
    pub unit: &'static str,
    /// Learned value.
    pub value: f64,
    /// Standard error; `None` if the logs show the number only together with others, or if it is at an end of its range.
    pub standard_error: Option<f64>,
    /// Half-width of the 95% interval around the value.
    pub interval: Option<f64>,
    /// Degrees of freedom of the standard error, by Student's t distribution: the logs, or parts of logs, taken as independent, less one.
    pub degrees_of_freedom: usize,
}

/// The named numbers of a fit, network weights and zero offsets of encoders left out.
pub fn named(
    certainty: &Certainty,
    (architecture, layout): (&Architecture, &CalibrationLayout),
) -> Vec<NamedEstimate> {
    let names = Names::of_windows(architecture, layout);
    let row = |of: &LearnedNumber| {
        let (name, unit) = names.of(of.position).filter(|_| !names.is_zero(of.position))?;
        let standard_error = match of.shown {
            Shown::Within(error) => Some(error),
            Shown::Together | Shown::AtBound => None,
        };
        let interval = standard_error.map(|error| certainty.interval() * error);
        let degrees_of_freedom = certainty.clusters.saturating_sub(1);
        Some(NamedEstimate { name, unit, value: of.value, standard_error, interval, degrees_of_freedom })
    };
    certainty.numbers.iter().filter_map(row).collect()
}

/// The sections on the numbers that a log of torques determines by itself.
pub(super) fn of_torques(numbers: &TorqueNumbers) -> String {
    let about = "Base parameters, the combinations of masses, centres and inertias that torques depend on at all, and friction: by this log \
                 alone, without the prior and without the bounds of bodies, beside what the model has. Intervals cover what a log \
                 shows; where it shows little, the model stays near the description instead.";
    let sum = |(name, parts): (&NumberName, &Vec<(f64, String)>)| {
        let rest: String = parts.iter().map(|(factor, name)| format!(" {factor:+.4} × {name}")).collect();
        format!("{}{rest}", name.name)
    };
    let sums: Vec<String> = numbers.names.iter().zip(&numbers.combinations).map(sum).collect();
    let [learned, hidden] = sections(&numbers.certainty, &Names::of_torques(numbers));
    [paragraph(about), learned, folded("what the base parameters are the sums of", &list(&sums)), hidden]
        .concat()
}

/// The sections on the numbers that the logs determine and on those that they do not.
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
        let shown = if of.shown == Shown::Together && names.model.is_some() { f64::NAN } else { of.value };
        let value = format!("<b>{}</b>", number(shown));
        let mut row = vec![escaped(&name), value, within, escaped(unit), strongest.0, strongest.1];
        row.extend(names.model.iter().filter_map(|model| Some(number(*model.get(of.position)?))));
        Some(row)
    };
    let rows: Vec<Vec<String>> = numbers.iter().filter_map(row).collect();
    let mut head = vec!["number", "value", "", "unit", "strongest correlation", "with"];
    head.extend(names.model.iter().map(|_| "in the model"));
    table(&head, &[0, 3, 5], &rows)
}

/// Sentence on a combination that the logs leave free.
fn of_combination(combination: &Combination, names: &Names) -> String {
    let change = |(position, part): &(usize, f64)| {
        let name = names.of(*position).map_or_else(|| "a weight of a network".to_owned(), |(name, _)| name);
        format!("{part:+.2}% {name}")
    };
    let changes: Vec<String> = combination.iter().take(MOST_NAMED).map(change).collect();
    let rest = match combination.len().saturating_sub(MOST_NAMED) {
        0 => String::new(),
        rest => format!(" and {rest} more"),
    };
    format!("Free together, without a change of what is predicted: {}{rest}.", escaped(&changes.join(", ")))
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
            "Only in combination, {} of which the logs leave free: {}. What is free stays as near to where it began as it can.",
            certainty.hidden,
            together.join("; ")
        ));
    }
    items.extend(certainty.combinations.iter().map(|combination| of_combination(combination, names)));
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
