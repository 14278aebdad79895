//! Writing of a first configuration.

use super::report::{Column, File, Report};
use super::tables::Tables;
use crate::cli::CONFIGURATION_HEAD;
use leastaction_learning::data::survey::Guess;
use leastaction_learning::data::{MIN_SAMPLES, unit};
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Relative difference below which sampling intervals belong to one clock.
const SAME: f64 = 0.01;

/// Keys of a configuration that say how samples follow each other.
#[derive(Clone, Copy)]
pub struct Layout {
    /// Step onto which all logs are resampled (s).
    pub step: Option<f64>,
    /// Rate of logs without time (Hz).
    pub rate: Option<f64>,
    /// Number of trajectories in logs that state where each ends.
    pub trajectories: Option<usize>,
    /// Whether the logs have leastaction's own names, and need no `[data.columns]`.
    pub is_own: bool,
}

/// The text of a configuration that can be used for training without changes, or the reason why the columns cannot be
/// guessed.
pub fn of(
    (files, at): (&[PathBuf], &Path),
    report: &Report,
    guess: &Guess,
    tables: &Tables<'_>,
    layout: Layout,
) -> Result<String, String> {
    check(report, guess, layout)?;
    let mut text = format!(
        "{CONFIGURATION_HEAD}: check the columns and their units, and what each coordinate is.\n[data]\n"
    );
    let files_seen: BTreeSet<&PathBuf> = report.files.iter().map(|file| &file.file).collect();
    line(&mut text, format_args!("file = {}", list(&relative(files, at))));
    let held_back = if layout.trajectories.unwrap_or(files_seen.len()) >= 3 { 0.2 } else { 0.0 };
    let which = if layout.trajectories.is_some() { "those at the end" } else { "whole files from the end" };
    line(&mut text, format_args!("validation = {held_back} # trajectories held back: {which}"));
    if let Some(step) = layout.step {
        line(&mut text, format_args!("step = {step}"));
    }
    if let Some(rate) = layout.rate {
        line(&mut text, format_args!("rate = {rate:?} # Hz: samples a second"));
    }
    if !layout.is_own {
        named_columns(&mut text, report, guess, tables.description.is_some());
    }
    text.push_str(&tables.text(at));
    Ok(text)
}

/// Writes the table that names the columns, with those of velocities if a loss reads them.
fn named_columns(text: &mut String, report: &Report, guess: &Guess, reads_velocities: bool) {
    line(text, format_args!("\n[data.columns]"));
    guess.questions.iter().for_each(|question| line(text, format_args!("# {question}")));
    stamps(text, report, guess);
    for (letter, names) in [("q", &guess.q), ("v", &guess.v), ("u", &guess.u)] {
        if !names.is_empty() && (letter != "v" || reads_velocities) {
            line(text, format_args!("{letter} = {}", columns(names, report)));
        }
    }
    if !guess.other_u.is_empty() {
        let others: Vec<String> = guess.other_u.iter().map(|names| columns(names, report)).collect();
        line(
            text,
            format_args!(
                "other_u = [{}] # other forces: those that predict held-back logs best are taken",
                others.join(", ")
            ),
        );
    }
}

/// Refuses columns of which the important ones cannot be guessed.
fn check(report: &Report, guess: &Guess, layout: Layout) -> Result<(), String> {
    let by_hand = "write [data.columns] by hand";
    if report.files.iter().all(|file| file.samples < MIN_SAMPLES) {
        return Err(format!("no log has {MIN_SAMPLES} samples, which make a trajectory"));
    }
    if report.is_nameless() && guess.q.is_empty() {
        return Err(nameless(report, guess));
    }
    match (&guess.t, layout.rate) {
        (None, None) if !layout.is_own => Err(format!(
            "no column that rises is named as time is; {by_hand}, or give the rate of the samples in Hz: look --rate 100"
        )),
        (Some(t), Some(_)) => Err(format!("{t} is time; leave out --rate, which is for logs without time")),
        _ if guess.q.is_empty() => {
            Err(format!("no column that changes is named as positions are; {by_hand}"))
        }
        _ => Ok(()),
    }
}

/// Most columns without names whose ranges an error lists.
const MOST_LISTED: usize = 20;

/// Columns of a log without a header, and what to write for them.
fn nameless(report: &Report, guess: &Guess) -> String {
    let rises = guess.t.as_ref().map_or(String::new(), |t| format!("; {t} rises as time does"));
    let range =
        |column: &Column| format!("{} from {:.4} to {:.4}", column.column, column.least, column.greatest);
    let others = report.columns.iter().filter(|column| Some(&column.column) != guess.t.as_ref());
    let ranges: Vec<String> = others.take(MOST_LISTED).map(range).collect();
    format!(
        "there is no header line{rises}, and derivatives do not tell which others are q, v and u ({}): write [data.columns] by hand, \
         by number from 1 to {}, as t = 1, q = [2, 3], u = [4, 5], and units, as q = [{{ name = 2, unit = \"deg\" }}]",
        ranges.join(", "),
        report.columns.len()
    )
}

/// Writes the column of time. Messages have their own time, so that none is named.
fn stamps(text: &mut String, report: &Report, guess: &Guess) {
    let Some(t) = &guess.t else { return };
    if let Some(nanosec) = &guess.nanosec {
        line(
            text,
            format_args!("t = {{ sec = {}, nanosec = {} }}", named(t, report), named(nanosec, report)),
        );
        return;
    }
    let stated = report.columns.iter().find(|column| column.column == *t).and_then(|column| column.unit);
    let stated = stated.filter(|unit| ["s", "ms", "us", "ns"].contains(unit));
    let guessed = report.files.first().filter(|file| file.topic.is_none()).and_then(|file| file.time_unit);
    match guessed.map(|guessed| stated.unwrap_or(guessed)) {
        Some(unit) if unit != "s" && !guess.is_date => {
            line(text, format_args!("t = {{ name = {}, unit = \"{unit}\" }}", named(t, report)));
        }
        Some(_) => line(text, format_args!("t = {}", named(t, report))),
        None => {}
    }
}

/// The longest sampling interval of all files, to two digits, if some files have shorter ones. `None` if all files have
/// the same step, with jitter or without.
pub fn step(report: &Report, guess: &Guess) -> Option<f64> {
    let intervals = intervals(report, guess);
    let (shortest, longest) = (intervals.first()?, intervals.last()?);
    format!("{longest:.1e}").parse().ok().filter(|_| *shortest < (1.0 - SAME) * longest)
}

/// The median of the files' sampling intervals, to two digits.
pub fn common_step(report: &Report, guess: &Guess) -> Option<f64> {
    let intervals = intervals(report, guess);
    format!("{:.1e}", intervals.get(intervals.len() / 2)?).parse().ok()
}

/// Sampling intervals of the files that have the first coordinate (s), in rising order.
fn intervals(report: &Report, guess: &Guess) -> Vec<f64> {
    let has_q = |file: &&File| guess.q.first().is_some_and(|q| file.may_have(q));
    let rates = report.files.iter().filter(has_q).filter_map(|file| file.rate);
    let mut intervals: Vec<f64> = rates.map(|rate| 1.0 / rate).collect();
    intervals.sort_unstable_by(f64::total_cmp);
    intervals
}

/// Paths relative to the configuration.
pub(super) fn relative(files: &[PathBuf], at: &Path) -> Vec<String> {
    let folder = at.parent().filter(|folder| !folder.as_os_str().is_empty());
    let full = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let seen = |file: &PathBuf| match folder {
        None => file.clone(),
        Some(folder) => full(file).strip_prefix(full(folder)).map_or_else(|_| full(file), Path::to_owned),
    };
    files.iter().map(|file| seen(file).display().to_string()).collect()
}

/// A list of texts; a single one needs no brackets.
fn list(names: &[String]) -> String {
    let all: Vec<String> = names.iter().map(|name| quoted(name)).collect();
    if all.len() == 1 { all.concat() } else { format!("[{}]", all.join(", ")) }
}

/// A list of columns, each with its unit where the log has one that is not of the SI.
fn columns(names: &[String], report: &Report) -> String {
    let column = |name: &String| match report.columns.iter().find(|column| column.column == *name) {
        Some(Column { unit: Some(of), .. }) if unit(of) != Some(1.0) => {
            format!("{{ name = {}, unit = \"{of}\" }}", quoted(name))
        }
        _ => named(name, report),
    };
    format!("[{}]", names.iter().map(column).collect::<Vec<_>>().join(", "))
}

/// The name of a column, or its number in a log without a header.
fn named(name: &str, report: &Report) -> String {
    match name.strip_prefix('#') {
        Some(number) if report.is_nameless() => number.to_owned(),
        _ => quoted(name),
    }
}

/// A TOML string; JSON strings are valid TOML.
pub(super) fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

fn line(text: &mut String, line: std::fmt::Arguments<'_>) {
    // Writing to a string does not fail.
    let _ = writeln!(text, "{line}");
}
