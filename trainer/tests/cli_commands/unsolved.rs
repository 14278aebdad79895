//! Models that cannot be evaluated everywhere.

use crate::support::Bench;

/// Fast pendulums at a step of 0.1 s: the discrete step cannot be solved from every state (the first example of docs/book/src/trees.md).
fn fast() -> Bench {
    let bench = Bench::new();
    bench.run("generate n-pendulum -o double.npz --trajectories 40").good();
    bench.write(
        "double.toml",
        "[data]\nfile = \"double.npz\"\n[model]\nfamily = \"modular\"\n[[model.types]]\nname = \"bob\"\ntransform = \"angle\"\n\
         position = []\npotential = []\n[model.trees]\ndouble = [\"bob\", \"bob\"]\n[training]\nloss = \"acceleration\"\niterations = 30\n",
    );
    bench.run("train double.toml -o run -q").good();
    bench.model("run");
    bench
}

#[test]
fn what_cannot_be_solved_is_counted_and_left_out() {
    let bench = fast();
    let report = bench.run("evaluate run.postcard --data double.npz --json").good().json();
    let number = |key: &str| report[key].as_f64().unwrap_or_else(|| panic!("{key} in {report}"));
    assert!(number("acceleration_relative") < 1e-6 && number("acceleration_unsolved") == 0.0, "{report}");
    let (unsolved, broken) = (number("one_step_unsolved"), number("rollouts_broken_off"));
    assert!(unsolved > 0.0 && unsolved < 0.5 * number("samples"), "{report}");
    assert!(broken > 0.0 && broken <= number("trajectories"), "{report}");
    assert!(number("one_step_mse").is_finite());
    assert_eq!(report["rollout_mse"].is_null(), broken == number("trajectories"), "{report}");
    let chip = &report["chip"];
    assert!(chip["one_step_unsolved"].as_f64() > Some(0.0) && chip["one_step_mse"].is_f64(), "{report}");
    let text = bench.run("evaluate run.postcard --data double.npz").good().stdout;
    assert!(!text.contains("inf") && text.contains("steps cannot be solved"), "{text}");
    assert!(text.contains("break off at a step"), "{text}");
}

#[test]
fn a_logged_velocity_is_where_rollouts_begin() {
    let bench = Bench::new();
    bench.log("");
    bench.config("iterations = 20\nloss = \"acceleration\"");
    bench.run("train c.toml -o run -q").good();
    bench.model("run");
    let (with, _) = leastaction_learning::data::read(bench.at("data.npz")).unwrap();
    let mut without = with.clone();
    for trajectory in &mut without.trajectories {
        trajectory.v = None;
    }
    leastaction_learning::data::write(bench.at("without.npz"), &without).unwrap();
    let rollout = |log: &str| {
        let report = bench.run(&format!("evaluate run.postcard --data {log} --json")).good().json();
        report["rollout_mse"].as_f64().unwrap()
    };
    assert_ne!(rollout("data.npz"), rollout("without.npz"));
}
