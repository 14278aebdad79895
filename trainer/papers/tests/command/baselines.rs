//! The models that ModLaNet's paper compares with, in `leastaction-papers modlanet`.

use super::support::Bench;
use leastaction_ground_truth::{ManyBody, ModlanetSettings, modlanet_set_of};
use leastaction_learning::data::modlanet;

const MODELS: [&str; 7] = ["trained", "hnn", "light-hnn", "lnn", "light-lnn", "mlp", "light-mlp"];

fn data(bench: &Bench) {
    let published = ModlanetSettings::published(ManyBody::Bodies(3), 1);
    let settings = ModlanetSettings { trajectories: 2, samples: 9, ..published };
    modlanet::write(bench.at("data.npz"), &modlanet_set_of(&settings).unwrap()).unwrap();
}

const RUN: &str = "modlanet --case three-body --data data.npz --iterations 2 --starts 1";

#[test]
fn all_rows_are_there_after_few_epochs() {
    let bench = Bench::new();
    data(&bench);
    let report = bench.run(&format!("{RUN} --baselines --epochs 3 --json")).good().json();
    let rows = report["rows"].as_array().unwrap();
    assert_eq!(rows.iter().map(|row| row["kind"].as_str().unwrap()).collect::<Vec<_>>(), MODELS);
    for row in &rows[1..] {
        let words = row["stopped"].as_str().unwrap_or_default();
        assert!(row["epochs"] == 3 || words.starts_with("diverged at epoch"), "{row}");
    }
    assert!(bench.run(&format!("{RUN} --json")).good().json()["kind"] == "trained");
}

#[test]
fn a_row_out_of_time_says_so() {
    let bench = Bench::new();
    data(&bench);
    // The limit is less than a nanosecond, so training runs out of time at once, even if the clock of a fast machine
    // has not advanced.
    let done = bench.run(&format!("{RUN} --baselines --minutes 1e-12 -o out")).good();
    assert_eq!(done.stdout.matches("out of time at epoch 0").count(), 6, "{}", done.stdout);
    assert_eq!(bench.text("out/modlanet.html").matches("out of time at epoch 0").count(), 6);
    assert!(bench.text("out/modlanet.html").contains("3 bodies, trained: accelerations of the test set"));
    bench.run("modlanet --minutes 0").bad(2, &["--minutes", "above 0"]);
}

/// Runs one epoch of a baseline in `lgnn`; `counts` are the numbers of nodes of the systems on which it is run.
fn lgnn(task: &str, (model, parameters): (&str, u64), counts: &[u64]) {
    let bench = Bench::new();
    let run = format!("lgnn --quick --starts 1 --iterations 1 --epochs 1 --only {task} --json");
    let report = bench.run(&run).good().json();
    let rows = report["rows"].as_array().map_or(vec![report.clone()], Clone::clone);
    let number = |key: &str| rows.iter().map(|row| row[key].as_u64().unwrap()).collect::<Vec<_>>();
    assert_eq!(number("count"), counts);
    for row in rows {
        let words = row["stopped"].as_str().unwrap_or_default();
        assert!(row["epochs"] == 1 || words.starts_with("out of time at epoch"), "{row}");
        assert_eq!((&row["model"], &row["parameters"]), (&model.into(), &parameters.into()), "{row}");
        let error = row["rollout_error"].as_f64().unwrap();
        assert!(error > 1e-3 && error <= 1.0, "{row}");
    }
}

#[test]
fn gns_has_its_rows_after_few_epochs() {
    lgnn("scale-gns", ("GNS", 2_130), &[5, 50, 500]);
}

#[test]
fn lgn_has_its_rows_after_few_epochs() {
    lgnn("scale-lgn", ("LGN", 2_113), &[5, 50]);
}

#[test]
fn lnn_has_its_row_after_few_epochs() {
    lgnn("pendulum-lnn", ("LNN", 67_844), &[3]);
}

#[test]
fn baselines_of_springs_and_pendulums_are_tasks_of_their_own() {
    let bench = Bench::new();
    let list = |options: &str| bench.run(&format!("lgnn --list {options}")).good().stdout;
    let all = list("");
    for task in ["scale-gns-0", "scale-lgn-0", "pendulum-lnn-0", "pendulum-lgn-0"] {
        assert!(all.contains(&format!("{task}\n")), "{all}");
    }
    let ours = list("--ours-alone");
    assert!(!ours.contains("gns") && !ours.contains("lgn") && !ours.contains("lnn"), "{ours}");
}
