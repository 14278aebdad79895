//! The models that ModLaNet's paper compares with, in `reproduce modlanet`.

use super::support::Bench;

const MODELS: [&str; 7] = ["trained", "hnn", "light-hnn", "lnn", "light-lnn", "mlp", "light-mlp"];

fn data(bench: &Bench) {
    let layout = "--modlanet-layout --trajectories 2 --samples 9 --seed 1";
    bench.run(&format!("generate n-body --count 3 -o data.npz {layout}")).good();
}

const RUN: &str = "reproduce modlanet --case three-body --data data.npz --iterations 2 --starts 1";

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
    let done = bench.run(&format!("{RUN} --baselines --minutes 1e-9 -o out")).good();
    assert_eq!(done.stdout.matches("out of time at epoch 0").count(), 6, "{}", done.stdout);
    assert_eq!(bench.text("out/modlanet.html").matches("out of time at epoch 0").count(), 6);
    bench.run("reproduce modlanet --minutes 0").bad(2, &["--minutes", "above 0"]);
}
