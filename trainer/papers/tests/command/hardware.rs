mod axis;
mod currents;

use super::robot;
use super::support::Bench;

/// Keys of every row.
const KEYS: [&str; 12] = [
    "machine",
    "model",
    "default",
    "test",
    "calibrated",
    "error_100ms",
    "error_500ms",
    "error_1s",
    "p90_1s",
    "parameters",
    "train_seconds",
    "seed",
];

/// Options that choose a machine's models without training.
const KNOWN: &str = "--only constant --only identified";

fn bench(logs: usize) -> Bench {
    let bench = Bench::new();
    robot::write(bench.folder.path(), logs, 4.0);
    bench
}

fn write(bench: &Bench, name: &str, content: &str) {
    std::fs::write(bench.at(name), content).unwrap();
}

#[test]
fn rows_have_their_keys_and_stand_on_a_page() {
    let bench = bench(3);
    let command = format!("hardware --data . --machine double-pendulum --test 2,1 {KNOWN} -o out --json");
    let found = bench.run(&command).good().json();
    let rows = found["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 3);
    for row in rows {
        KEYS.iter().for_each(|key| assert!(!row[key].is_null(), "{key}: {row}"));
        assert_eq!((&row["machine"], &row["test"]), (&"double-pendulum".into(), &serde_json::json!([1, 2])));
    }
    let of = |row: &serde_json::Value| (row["model"].clone(), row["calibrated"].clone());
    let found: Vec<_> = rows.iter().map(of).collect();
    let expected = [
        ("constant velocity", false),
        ("baseline: identified parameters", false),
        ("baseline: identified parameters", true),
    ];
    assert_eq!(found, expected.map(|(model, calibrated)| (model.into(), calibrated.into())));
    let page = bench.text("out/hardware.html");
    for words in ["double-pendulum, logs 1, 2", "as is", "calibrated", "--test 1,2"] {
        assert!(page.contains(words), "{words}");
    }
    assert_eq!(bench.text("out/hardware.csv").lines().count(), 1 + 3 * 6);
    // The command of a row reproduces it.
    let again = bench.run(
        "hardware --data . --machine double-pendulum --test 1,2 --only constant-velocity-0 --seed 0 --json",
    );
    assert_eq!(again.good().json()["error_1s"], rows[0]["error_1s"]);
}

#[test]
fn without_a_choice_there_are_both_splits_and_a_baseline_of_ones_own() {
    let bench = bench(4);
    let names = bench.run("hardware --data . --list").good().stdout;
    assert_eq!(names.lines().filter(|name| name.contains("identified")).count(), 2, "{names}");
    std::fs::remove_file(bench.at("double-pendulum/model_parameters.yml")).unwrap();
    let names = bench.run("hardware --data . --list").good().stdout;
    assert!(
        !names.contains("identified") && names.contains("double-pendulum-3-constant-velocity-0"),
        "{names}"
    );
    write(&bench, "own.yml", robot::PARAMETERS);
    let names = bench.run("hardware --data . --list --baseline own.yml").good().stdout;
    assert!(names.contains("double-pendulum-1-baseline-identified-parameters-0"), "{names}");
}

#[test]
fn what_cannot_be_used_is_said() {
    let bench = bench(2);
    let run = |words: &str| bench.run(&format!("hardware {words} {KNOWN}"));
    let double = "--data . --machine double-pendulum";
    run("--data nowhere").bad(2, &["nowhere", "double-pendulum, pendulum, panda, multi-arm, ur10e"]);
    run("--data . --machine pendulum").bad(2, &["./pendulum"]);
    run(&format!("{double} --test 0,2")).bad(2, &["--test 2", "there are 2 logs"]);
    run(&format!("{double} --test 0,1")).bad(2, &["--test", "none is left"]);
    run(&format!("{double} --test x")).bad(2, &["--test"]);
    run("--data . --test 0").bad(2, &["--machine"]);
    run("--data . --machine pendulum --baseline own.yml").bad(2, &["--baseline"]);
    run("--data . --machine panda --baseline own.yml").bad(2, &["--baseline"]);
    run("--data . --machine panda --test 0").bad(2, &["--test", "one log"]);
    run("--data . --machine panda").bad(2, &["panda/excitation.csv"]);
    for (content, words) in [
        ("I1: 1\nI2 2\n", &["own.yml, line 2", "name: number"][..]),
        ("I1: 1\n", &["own.yml", "I2", "missing"]),
        (&robot::PARAMETERS.replace("I2: 0.05", "I2: -0.05"), &["own.yml", "not positive"]),
    ] {
        write(&bench, "own.yml", content);
        run(&format!("{double} --baseline own.yml")).bad(2, words);
    }
    run(&format!("{double} --baseline none.yml")).bad(2, &["none.yml"]);
}

#[test]
fn hostile_logs_are_refused_with_their_place() {
    let bench = bench(2);
    let good = bench.text("double-pendulum/01.csv");
    let head = good.lines().next().unwrap().to_owned();
    let run = || bench.run("hardware --data . --machine double-pendulum --only constant");
    let cases = [
        (good.replace("pos_meas2", "other"), &["01.csv", "pos_meas2"][..]),
        (good.replacen('\n', "\n1,2,3\n", 1), &["01.csv, line 2", "3 cells"]),
        (format!("{good}9,1,1,inf,1,1,1,1,1\n"), &["01.csv, line"]),
        (format!("{good}1e13,1,1,1,1,1,1,1,1\n"), &["01.csv", "samples over 1.000e13 s"]),
        (format!("{good}0.5,1,1,1,1,1,1,1,1\n"), &["01.csv, line", "time goes from"]),
        (format!("{head}\n"), &["01.csv", "no samples"]),
    ];
    for (content, words) in cases {
        write(&bench, "double-pendulum/01.csv", &content);
        run().bad(2, words);
    }
    std::fs::remove_file(bench.at("double-pendulum/01.csv")).unwrap();
    run().bad(2, &["double-pendulum", "only one log"]);
    // The errors of logs that are too short for a window are NaN.
    let short = good.lines().take(30).collect::<Vec<_>>().join("\n");
    write(&bench, "double-pendulum/01.csv", &short);
    let found =
        bench.run("hardware --data . --machine double-pendulum --test 1 --only constant --json").good();
    assert!(found.json()["error_1s"].is_null());
}
