//! Currents of a made-up arm with six joints.

use crate::support::Bench;
use leastaction_models::tree::Tree;
use leastaction_models::urdf::{Inertias, parse};
use std::fmt::Write;

/// Torques of the drives for 1 A, N m.
const GAINS: [f64; 6] = [10.0, 10.7, 8.46, 9.0, 9.48, 10.12];
/// Viscous (A s/rad) and dry friction, and offset of every current (A).
const FRICTION: [f64; 3] = [0.3, 0.2, 0.1];
/// Velocity over which dry friction changes its sign, rad/s.
const WIDTH: f64 = 0.02;

/// Description of a chain whose axes are z and y in turn, and whose links have this mass, kg.
fn urdf(mass: f64) -> String {
    let mut text = "<robot name=\"made-up\"><link name=\"l0\"/>\n".to_owned();
    for k in 1..=6 {
        let (before, axis, inertia) = (k - 1, ["0 1 0", "0 0 1"][k % 2], 0.02 * mass);
        write!(
            text,
            "<link name=\"l{k}\"><inertial><origin xyz=\"0.02 0.03 0.1\"/><mass value=\"{mass}\"/>\
             <inertia ixx=\"{inertia}\" ixy=\"0\" ixz=\"0\" iyy=\"{inertia}\" iyz=\"0\" izz=\"{inertia}\"/></inertial></link>\n\
             <joint name=\"j{k}\" type=\"continuous\"><parent link=\"l{before}\"/><child link=\"l{k}\"/>\
             <origin xyz=\"0 0.05 0.2\"/><axis xyz=\"{axis}\"/></joint>\n"
        )
        .unwrap();
    }
    text + "</robot>\n"
}

/// A log without a header: time, positions, velocities, currents, and columns that nobody reads.
fn log(arm: &Tree, seconds: f64, phase: f64) -> String {
    let mut text = String::new();
    for sample in 0..(seconds / 0.01) as usize {
        // Stamps jitter by a tenth of the step.
        let t = 100.0 + 0.01 * sample as f64 + 0.001 * (sample % 2) as f64;
        let wave = |k: usize, order: i32| -> f64 {
            let waves = [(0.5, 1.0 + 0.3 * k as f64), (0.2, 3.1 + 0.2 * k as f64)];
            let of = |(size, rate): (f64, f64)| {
                let turned = rate * t + phase * k as f64 + f64::from(order) * std::f64::consts::FRAC_PI_2;
                size * rate.powi(order) * turned.sin()
            };
            waves.into_iter().map(of).sum()
        };
        let [q, v, a] = [0, 1, 2].map(|order| (0..6).map(|k| wave(k, order)).collect::<Vec<f64>>());
        let torques = arm.inverse_dynamics(&q, &v, &a);
        let [viscous, dry, offset] = FRICTION;
        let current =
            |k: usize| torques[k] / GAINS[k] + viscous * v[k] + dry * (v[k] / WIDTH).tanh() + offset;
        let cells = q.iter().chain(&v).copied().chain((0..6).map(current)).chain([0.0; 12]);
        let cells: Vec<String> = cells.map(|cell| format!("{cell:.6}")).collect();
        writeln!(text, "{t:.6},{}", cells.join(",")).unwrap();
    }
    text
}

/// A folder with a description that is a third too light, a log to learn from and another.
fn bench() -> Bench {
    let bench = Bench::new();
    std::fs::create_dir(bench.at("ur10e")).unwrap();
    let arm = parse(&urdf(3.0), Inertias::Required).unwrap();
    std::fs::write(bench.at("ur10e/ur10e.urdf"), urdf(2.0)).unwrap();
    std::fs::write(bench.at("ur10e/a-50sec_12harm.csv"), log(&arm, 12.0, 1.0)).unwrap();
    std::fs::write(bench.at("ur10e/b-other.csv"), log(&arm, 6.0, 2.0)).unwrap();
    bench
}

#[test]
fn currents_are_learned_from_one_log_and_judged_on_all() {
    let bench = bench();
    let command = "hardware --data . --machine ur10e -o out --json";
    let found = bench.run(command).good().json();
    let rows = found["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 7 * 2);
    let error = |model: &str, log: &str| {
        let is_it = |row: &&serde_json::Value| row["model"] == model && row["log"] == log;
        rows.iter().find(is_it).unwrap()["mean_nmse"].as_f64().unwrap()
    };
    let (own, other) = ("a-50sec_12harm", "b-other");
    assert!((error("constant: the mean", own) - 1.0).abs() < 1e-9);
    // A linear model of currents without gains describes no arm whose drives differ.
    let [free, known] = ["linear least squares", "linear least squares, gains of the drives known"];
    assert!(error(known, own) < 0.5 * error(free, own), "{} {}", error(known, own), error(free, own));
    let ours = "leastaction, one TOML";
    for (model, log) in [(known, own), (known, other), (ours, own), (ours, other)] {
        assert!(error(model, log) < 0.01, "{model}, {log}: {}", error(model, log));
    }
    let without = error("… offsets of the drives not learned", other);
    assert!(without > 1.5 * error(ours, other), "{without} {}", error(ours, other));
    let page = bench.text("out/hardware.html");
    for words in ["ur10e, currents of the drives", "a-50sec_12harm, learned from", "b-other", "joint 6, A"] {
        assert!(page.contains(words), "{words}");
    }
}

#[test]
fn an_arm_that_cannot_be_judged_by_currents_is_refused() {
    let bench = bench();
    let run = |words: &str| bench.run(&format!("hardware --data . --machine ur10e {words}"));
    run("--test 0").bad(2, &["--test", "all are tested"]);
    run("--baseline own.yml").bad(2, &["--baseline"]);
    let log = bench.text("ur10e/a-50sec_12harm.csv");
    std::fs::write(bench.at("ur10e/a-50sec_12harm.csv"), &log[..200]).unwrap();
    run("--only constant").bad(2, &["a-50sec_12harm.csv"]);
    std::fs::remove_file(bench.at("ur10e/a-50sec_12harm.csv")).unwrap();
    run("--only constant").bad(2, &["ur10e", "no log to learn from", "50sec_12harm"]);
    let five = urdf(2.0).replacen("continuous", "fixed", 1);
    std::fs::write(bench.at("ur10e/ur10e.urdf"), five).unwrap();
    run("--only constant").bad(2, &["ur10e.urdf", "5 moving joints", "the logs have 6"]);
    std::fs::remove_file(bench.at("ur10e/ur10e.urdf")).unwrap();
    run("--only constant").bad(2, &["ur10e.urdf"]);
}
