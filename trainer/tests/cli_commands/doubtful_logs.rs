//! Logs that raise doubts.

use crate::support::Bench;
use leastaction_learning::data::{self, Dataset};
use std::f64::consts::{PI, TAU};

/// The pendulum about its upper rest, and the same motion with angles in [−π, π).
fn upright_and_wrapped(bench: &Bench) -> [Dataset; 2] {
    bench.run("generate pendulum -o data.npz --trajectories 8 --samples 30").good();
    let (mut data, _) = data::read(bench.at("data.npz")).unwrap();
    for trajectory in &mut data.trajectories {
        trajectory.q = trajectory.q.map(|q| q + PI);
    }
    let mut wrapped = data.clone();
    for trajectory in &mut wrapped.trajectories {
        trajectory.q = trajectory.q.map(|q| (q + PI).rem_euclid(TAU) - PI);
    }
    [data, wrapped]
}

#[test]
fn wrapped_angles_are_learned_from_and_judged_by_as_straight_ones() {
    let bench = Bench::new();
    let [straight, wrapped] = upright_and_wrapped(&bench);
    data::write(bench.at("straight.csv"), &straight).unwrap();
    data::write(bench.at("data.npz"), &wrapped).unwrap();
    bench.config("iterations = 3");
    let done = bench.run("train c.toml -o run -q").good();
    assert!(done.stderr.contains("note: q0 jumps by 2π "), "{}", done.stderr);
    bench.model("run");
    let judged = |log: &str| {
        let done = bench.run(&format!("evaluate run.postcard --data {log} --json")).good();
        let report = done.json();
        (report["one_step_mse"].as_f64().unwrap(), report["rollout_mse"].as_f64().unwrap(), done.stderr)
    };
    let (expected, found) = (judged("straight.csv"), judged("data.npz"));
    assert!((found.0 / expected.0 - 1.0).abs() < 1e-3, "{} {}", found.0, expected.0);
    assert!((found.1 / expected.1 - 1.0).abs() < 1e-3, "{} {}", found.1, expected.1);
    assert!(expected.2.is_empty() && found.2.contains("note: q0 jumps by 2π "), "{}", found.2);
    let half = bench.run("export run -o half.postcard --weights f16 --json").good().json();
    let of_export = half["accuracy"]["trained"]["one_step"].as_f64().unwrap();
    assert!((of_export.powi(2) / expected.0 - 1.0).abs() < 1e-2, "{of_export} {}", expected.0);
}

#[test]
fn milliseconds_taken_for_seconds_are_noticed() {
    let bench = Bench::new();
    bench.log("");
    let (mut log, _) = data::read(bench.at("data.npz")).unwrap();
    log.h *= 1000.0;
    data::write(bench.at("data.npz"), &log).unwrap();
    bench.config("iterations = 2");
    let done = bench.run("train c.toml -o run -q");
    for words in
        ["note: the step is 100 s, long for a mechanism", "note: v0 is 10", "is t or h in milliseconds?"]
    {
        assert!(done.stderr.contains(words), "{}", done.stderr);
    }
    assert!(!done.stderr.contains("warm_up"), "{}", done.stderr);
}

#[test]
fn a_number_that_stands_for_none_is_refused_with_its_place() {
    let bench = Bench::new();
    bench.config("iterations = 2");
    bench.write("c.toml", &bench.text("c.toml").replace("data.npz", "data.csv"));
    bench.write("data.csv", "t;q;u\n0;0,1;1\n0,1;0,2;1\n0,2;1e308;1\n0,3;0,4;1\n");
    bench
        .run("train c.toml -o run")
        .bad(2, &["data.csv: q0 is 1e308 at sample 2 of trajectory 0", "stands for none"]);
    assert!(!bench.at("run").exists());
}
