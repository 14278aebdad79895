//! A made-up axis with friction that differs by direction and sticks.

use crate::support::Bench;
use leastaction_papers::hardware::Axis;
use std::fmt::Write;

/// Numbers of the axis.
const AXIS: Axis =
    Axis { mass: 50.0, viscous: [120.0, 180.0], coulomb: [12.0, 10.0], offset: 0.0, stiffness: [0.0; 3] };
const H: f64 = 2e-3;

/// A log of this many samples, under forces that turn it around; it rests meanwhile.
fn log(samples: usize, phase: f64) -> String {
    let force = |k: usize| {
        let t = k as f64 * H;
        25.0 * (3.0 * t + phase).sin() + 18.0 * (7.3 * t + phase).sin()
    };
    let forces: Vec<f64> = (0..samples).map(force).collect();
    let positions = AXIS.roll_out([0.01, 0.0], &forces[1..], H);
    let mut text = "time,position,force\n".to_owned();
    // The force of a sample is held from it to the next.
    let held = forces[1..].iter().chain(&forces[..1]);
    for ((k, q), u) in positions.iter().enumerate().zip(held) {
        writeln!(text, "{},{q},{u}", k as f64 * H).unwrap();
    }
    text
}

fn bench() -> Bench {
    let bench = Bench::new();
    std::fs::create_dir(bench.at("emps")).unwrap();
    std::fs::write(bench.at("emps/train.csv"), log(2000, 0.0)).unwrap();
    bench
}

/// Number of a model's row.
fn number<'r>(found: &'r serde_json::Value, model: &str, name: &str) -> &'r serde_json::Value {
    let rows = found["rows"].as_array().unwrap();
    &rows.iter().find(|row| row["model"] == model).unwrap_or_else(|| panic!("{model}"))[name]
}

#[test]
fn numbers_are_identified_with_friction_that_sticks_and_differs_by_direction() {
    let bench = bench();
    let command = "hardware --data . --machine emps --only least-squares --only published --json";
    let alone = bench.run(command).good().json();
    std::fs::write(bench.at("emps/test.csv"), log(1500, 1.0)).unwrap();
    let found = bench.run(&format!("{command} -o out")).good().json();
    let true_model = "least squares on motion, friction by direction";
    assert!(number(&alone, true_model, "error_test_mm").is_null());
    for row in alone["rows"].as_array().unwrap() {
        assert_eq!(row["machine"], "emps");
        assert_eq!(row["default"], false);
        assert!(row["error_half_step_mm"].is_null());
    }
    let numbers = number(&found, true_model, "numbers");
    for (name, expected) in [("viscous", AXIS.viscous), ("coulomb", AXIS.coulomb)] {
        for (k, expected) in expected.into_iter().enumerate() {
            let found = numbers[name][k].as_f64().unwrap();
            assert!((found / expected - 1.0).abs() < 1e-3, "{name} {k}: {found}");
        }
    }
    assert!((numbers["mass"].as_f64().unwrap() / AXIS.mass - 1.0).abs() < 1e-3);
    let error = |model: &str, name: &str| number(&found, model, name).as_f64().unwrap();
    let four = "least squares on motion";
    for name in ["error_train_mm", "error_test_mm"] {
        assert!(error(true_model, name) < 1e-2, "{name}: {}", error(true_model, name));
        assert!(error(four, name) > 0.5, "{name}: {}", error(four, name));
    }
    let thirds = number(&found, true_model, "error_thirds_mm").as_array().unwrap();
    assert!(thirds.iter().all(|error| error.as_f64().unwrap() < 0.5), "{thirds:?}");
    let on_forces = error("least squares on forces, friction by direction", "error_train_mm");
    assert!(on_forces < error("least squares on forces", "error_train_mm"), "{on_forces}");
    // The numbers of another axis do not fit.
    assert!(error("published numbers", "error_train_mm") > 10.0 * on_forces);
    assert_eq!(number(&found, true_model, "parameters"), 5);
    let page = bench.text("out/hardware.html");
    for words in ["emps, position along a whole log", "other log, mm", "first third held back, mm"] {
        assert!(page.contains(words), "{words}");
    }
}

/// The smooth law is learned from the log as `look` sees it; the result does not depend on the step.
#[test]
fn our_model_is_the_one_that_look_proposes() {
    let bench = bench();
    let command =
        "hardware --data . --machine emps --only published --only as-look-configures-it --quick --json";
    let found = bench.run(command).good().json();
    let model = "leastaction, as look configures it";
    assert_eq!(number(&found, model, "default"), true);
    let error = |name: &str| number(&found, model, name).as_f64().unwrap();
    let (whole, half) = (error("error_train_mm"), error("error_half_step_mm"));
    assert!(whole > 0.0 && whole < 5.0, "{whole}");
    assert!((half / whole - 1.0).abs() < 0.05, "{whole} {half}");
}

#[test]
fn an_axis_whose_log_cannot_be_used_is_refused() {
    let bench = bench();
    let run = |words: &str| bench.run(&format!("hardware --data . --machine emps --only published {words}"));
    run("--test 0").bad(2, &["--test", "test.csv"]);
    let text = bench.text("emps/train.csv");
    let write = |text: &str| std::fs::write(bench.at("emps/train.csv"), text).unwrap();
    write(&text.replace("position", "angle"));
    run("").bad(2, &["train.csv", "position"]);
    write(&text.lines().take(100).collect::<Vec<_>>().join("\n"));
    run("").bad(2, &["train.csv", "99 samples", "at least 300"]);
    let gap: Vec<&str> = text.lines().take(1000).chain(text.lines().skip(1100)).collect();
    write(&gap.join("\n"));
    run("").bad(2, &["train.csv", "samples 998 and 999", "one step"]);
    std::fs::remove_file(bench.at("emps/train.csv")).unwrap();
    run("").bad(2, &["train.csv"]);
}
