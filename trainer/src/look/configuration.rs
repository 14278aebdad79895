//! Writing of a first configuration.

use super::mechanism::Mechanism;
use super::report::{File, Report};
use crate::cli::CONFIGURATION_HEAD;
use leastaction_learning::data::survey::Guess;
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Relative difference below which sampling intervals belong to one clock.
const SAME: f64 = 0.01;

/// The text of a configuration that can be used for training without changes, or the reason why the columns cannot be
/// guessed. Without a mechanism the model is a network.
pub fn of(
    (files, at): (&[PathBuf], &Path),
    report: &Report,
    guess: &Guess,
    mechanism: Option<&Mechanism>,
) -> Result<String, String> {
    let Some(t) = &guess.t else {
        return Err("no column is named as time is; write [data.columns] by hand".to_owned());
    };
    if guess.q.is_empty() {
        return Err("no column is named as positions are; write [data.columns] by hand".to_owned());
    }
    let mut text = format!(
        "{CONFIGURATION_HEAD}: check the columns and their units, and what each coordinate is.\n[data]\n"
    );
    let files_seen: BTreeSet<&PathBuf> = report.files.iter().map(|file| &file.file).collect();
    line(&mut text, format_args!("file = {}", list(&relative(files, at), true)));
    let held_back = if files_seen.len() >= 3 { 0.2 } else { 0.0 };
    line(
        &mut text,
        format_args!("validation = {held_back} # trajectories held back: whole files from the end"),
    );
    if let Some(step) = step(report, guess) {
        line(&mut text, format_args!("step = {step}"));
    }
    line(&mut text, format_args!("\n[data.columns]"));
    match report.files.first().filter(|file| file.topic.is_none()).and_then(|file| file.time_unit) {
        Some(unit) if unit != "s" => {
            line(&mut text, format_args!("t = {{ name = {}, unit = \"{unit}\" }}", quoted(t)))
        }
        Some(_) => line(&mut text, format_args!("t = {}", quoted(t))),
        // Messages have their own time, so no column is named.
        None => {}
    }
    for (letter, names) in [("q", &guess.q), ("u", &guess.u)] {
        if !names.is_empty() {
            line(&mut text, format_args!("{letter} = {}", list(names, false)));
        }
    }
    if !guess.other_u.is_empty() {
        let others: Vec<String> = guess.other_u.iter().map(|names| list(names, false)).collect();
        line(
            &mut text,
            format_args!(
                "other_u = [{}] # other forces: those that predict held-back logs best are taken",
                others.join(", ")
            ),
        );
    }
    model(&mut text, guess, mechanism);
    Ok(text)
}

/// Writes the tables for rigid bodies or a network, with friction, and for sensors and actuators.
fn model(text: &mut String, guess: &Guess, mechanism: Option<&Mechanism>) {
    let driven = !guess.u.is_empty();
    let [head, bodies] = mechanism.map_or_else(|| [network(guess.q.len()), String::new()], Mechanism::tables);
    text.push_str(&head);
    let load = if driven { ", load = \"learned\"" } else { "" };
    line(text, format_args!("friction = {{ viscous = \"learned\", coulomb = \"learned\"{load} }}"));
    text.push_str(&bodies);
    if driven {
        line(text, format_args!("\n[calibration] # sensors and actuators; a number if it is known"));
        line(text, format_args!("zero = \"learned\"\ngain = \"learned\"\ndelay = \"learned\""));
    }
    line(text, format_args!("\n[training]\nloss = \"windows\""));
}

/// The table of a network with n coordinates.
fn network(n: usize) -> String {
    let angles = vec!["\"angle\""; n].join(", ");
    format!("\n[model]\ncoordinates = [{angles}] # \"translation\", \"angle\" or \"cyclic\"\n")
}

/// The longest sampling interval of all files, to two digits, if some files have shorter ones. `None` if all files have
/// the same step, with jitter or without.
fn step(report: &Report, guess: &Guess) -> Option<f64> {
    let has_q = |file: &&File| guess.q.first().is_some_and(|q| file.may_have(q));
    let rates = || report.files.iter().filter(has_q).filter_map(|file| file.rate);
    let intervals = || rates().map(|rate| 1.0 / rate);
    let (longest, shortest) = (intervals().fold(0.0, f64::max), intervals().fold(f64::INFINITY, f64::min));
    let differ = shortest < (1.0 - SAME) * longest;
    format!("{longest:.1e}").parse().ok().filter(|_| differ)
}

/// Paths relative to the configuration.
fn relative(files: &[PathBuf], at: &Path) -> Vec<String> {
    let folder = at.parent().filter(|folder| !folder.as_os_str().is_empty());
    let full = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let seen = |file: &PathBuf| match folder {
        None => file.clone(),
        Some(folder) => full(file).strip_prefix(full(folder)).map_or_else(|_| full(file), Path::to_owned),
    };
    files.iter().map(|file| seen(file).display().to_string()).collect()
}

fn list(names: &[String], one_alone: bool) -> String {
    let all: Vec<String> = names.iter().map(|name| quoted(name)).collect();
    if one_alone && all.len() == 1 { all.concat() } else { format!("[{}]", all.join(", ")) }
}

/// A TOML string; JSON strings are valid TOML.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

fn line(text: &mut String, line: std::fmt::Arguments<'_>) {
    // Writing to a string does not fail.
    let _ = writeln!(text, "{line}");
}
