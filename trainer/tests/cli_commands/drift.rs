//! Drift of a machine: a log of today replayed and compared with one of the machine as it was.

use crate::changes::{MOTION, tree, write_arm};
use crate::support::{Bench, Outcome};
use serde_json::Value;
use std::fs;

const COLUMNS: &str = "[data]\nfile = \"before/trace.csv\"\n[data.columns]\nt = \"time\"\nq = [\"measured0\", \"measured1\"]\n\
                       u = [\"commanded0\", \"commanded1\"]\n[model]\ncoordinates = \"aa\"\n";

/// An arm with a log of it.
fn arm() -> Bench {
    let bench = Bench::new();
    write_arm(&bench, "arm.postcard", &tree(), [0.5, 0.4]);
    fs::write(bench.at("motion.toml"), MOTION).unwrap();
    fs::write(bench.at("robot.toml"), COLUMNS).unwrap();
    move_arm(&bench, "before", "--seed 1");
    bench
}

fn move_arm(bench: &Bench, name: &str, options: &str) {
    let words = "simulate arm.postcard --scenario track --plant arm.postcard --trajectory motion.toml --tick 0.005 --seconds 30";
    let outcome = bench.run(&format!("{words} {options} --noise 0.0005 -o {name}"));
    assert!(matches!(outcome.code, Some(0 | 1)), "{}", outcome.stderr);
}

/// Replays a day of the arm.
fn replay(bench: &Bench, options: &str) -> Outcome {
    bench.run(&format!("simulate arm.postcard --replay day/trace.csv -o out {options}")).good()
}

fn drift(bench: &Bench, options: &str) -> Value {
    replay(bench, &format!("--config robot.toml --json {options}")).json()["drift"].clone()
}

fn number(of: &Value) -> f64 {
    of.as_f64().unwrap_or_else(|| panic!("{of}"))
}

#[test]
fn days_are_compared_with_the_log_of_the_configuration() {
    let bench = arm();
    move_arm(&bench, "day", "--seed 2");
    let same = drift(&bench, "");
    assert_eq!(
        (&same["drifted"], same["reference"].as_str()),
        (&Value::Bool(false), Some("before/trace.csv"))
    );
    assert!((0.9..1.1).contains(&number(&same["errors"])), "{same}");
    assert_eq!(
        (same["false_alarms"].as_f64(), same["coordinates"].as_array().unwrap().len()),
        (Some(1e-3), 2)
    );
    let often = drift(&bench, "--false-alarms 0.1");
    assert_eq!(often["value"], same["value"]);
    assert!(number(&often["threshold"]) < number(&same["threshold"]));
    assert_eq!(drift(&bench, ""), same);
    // A reference by name is read in the same way.
    assert_eq!(drift(&bench, "--reference before/trace.csv"), same);
}

/// Each change is seen, and its sign says what it is: more friction brakes, a load falls.
#[test]
fn changes_are_seen_and_said_aloud() {
    let bench = arm();
    for (options, sign) in [
        ("--friction-drift 1.2@0.001", "direction"),
        ("--payload 0.1", "command"),
        ("--zeros 0,0.06", "mean"),
        ("--offset 0,0.5 --known-delay 5", "mean"),
    ] {
        move_arm(&bench, "day", &format!("--seed 2 {options}"));
        let found = drift(&bench, "");
        assert_eq!(found["drifted"], true, "{options}: {found}");
        let z = |sign: &str| number(&found["coordinates"][1][sign]);
        assert!(z(sign).abs() > 4.0, "{options}: {found}");
        assert!(sign != "direction" || z(sign) < 0.0, "{options}: {found}");
    }
    let words = replay(&bench, "--config robot.toml").stdout;
    assert!(
        words.contains("THE MACHINE HAS DRIFTED: errors are") && words.contains("leastaction adapt"),
        "{words}"
    );
}

#[test]
fn without_a_reference_there_is_no_number_and_a_reason() {
    let bench = arm();
    move_arm(&bench, "day", "--seed 2");
    let says = |options: &str, why: &str| {
        let outcome = replay(&bench, &format!("--json {options}"));
        assert!(outcome.json()["drift"].is_null(), "{}", outcome.stdout);
        let notes: Vec<&str> = outcome.stderr.lines().filter(|line| line.contains("drift")).collect();
        assert!(notes.len() == 1 && notes[0].contains(why), "{why:?} is not in {}", outcome.stderr);
    };
    fs::write(bench.at("gone.toml"), COLUMNS.replace("before", "gone")).unwrap();
    says("--config gone.toml", "gone/trace.csv");
    fs::write(bench.at("self.toml"), COLUMNS.replace("before", "day")).unwrap();
    says("--config self.toml", "this log is the reference itself");
    let text = bench.text("before/trace.csv");
    let beginning: Vec<&str> = text.lines().take(300).collect();
    fs::write(bench.at("short.csv"), beginning.join("\n")).unwrap();
    says("--config robot.toml --reference short.csv", "too short");
    // Logs that were named must exist; other commands know no drift.
    let refused =
        |options: &str, words: &str| bench.run(&format!("simulate arm.postcard {options}")).bad(2, &[words]);
    refused("--replay day/trace.csv --config robot.toml --reference gone.csv", "gone.csv");
    refused("--scenario gravity --reference before/trace.csv", "--scenario");
    refused("--replay day/trace.csv --false-alarms 1", "between 0 and 1");
}

/// The folder of a run says what the model learned from, and how logs are read; a network has drift, too.
#[test]
fn the_folder_of_a_run_is_enough() {
    let bench = Bench::new();
    let robot = "generate pendulum --robot logs --trajectories 2 --samples 1201 --h 0.05 --amplitude 0.2,0.6 --noise 0.002";
    bench.run(robot).good();
    let columns =
        "[data]\nfile = \"logs/00.csv\"\n[data.columns]\nt = \"time\"\nq = \"pos_meas1\"\nu = \"tau_con1\"\n";
    let rest = "[model]\ncoordinates = \"a\"\nhidden = [4]\n[training]\niterations = 10\n";
    bench.write("robot.toml", &format!("{columns}{rest}"));
    bench.run("train robot.toml -o run -q").good();
    let report = bench.run("simulate run --replay logs/01.csv --json -o out").good().json();
    let found = &report["drift"];
    assert!(found["reference"].as_str().unwrap().ends_with("00.csv"), "{found}");
    assert!(number(&found["value"]) > 0.0 && number(&found["threshold"]) > 1.0, "{found}");
    bench.model("run");
    let words = "simulate run.postcard --replay logs/01.csv --config robot.toml --json -o out";
    assert_eq!(bench.run(words).good().json()["drift"]["coordinates"], found["coordinates"]);
}
