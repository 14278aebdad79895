//! `evaluate` in the chip's arithmetic.

use crate::support::Bench;
use serde_json::Value;

/// A chain of `count` pendulums, learned as a tree.
fn chain(count: usize) -> Bench {
    let bench = Bench::new();
    bench.run(&format!("generate n-pendulum --count {count} -o log.npz --trajectories 4 --h 0.01")).good();
    let bobs = vec!["\"bob\""; count].join(", ");
    bench.write(
        "c.toml",
        &format!(
            "[data]\nfile = \"log.npz\"\n[model]\nfamily = \"modular\"\n[[model.types]]\nname = \"bob\"\ntransform = \"angle\"\n\
             position = []\npotential = []\n[model.trees]\nchain = [{bobs}]\n[training]\nloss = \"acceleration\"\n\
             iterations = 10\n"
        ),
    );
    bench.run("train c.toml -o run -q").good();
    bench.model("run");
    bench
}

fn number(report: &Value, key: &str) -> f64 {
    report[key].as_f64().unwrap_or_else(|| panic!("{key} in {report}"))
}

/// The chip's steps of a model that is exact in double precision are off only by rounding, which is visible and small.
#[test]
fn the_steps_of_the_chip_are_measured_beside_those_in_double_precision() {
    let bench = chain(5);
    let report = bench.run("evaluate run.postcard --data log.npz --order 4 --json").good().json();
    let chip = &report["chip"];
    let (ours, chips) = (number(&report, "one_step_mse"), number(chip, "one_step_mse"));
    assert!(chips > ours && chips < ours + 1e-9, "{report}");
    assert_eq!((number(chip, "one_step_unsolved"), number(chip, "rollouts_broken_off")), (0.0, 0.0));
    assert!(number(chip, "rollout_mse_100").is_finite() && number(chip, "rollout_median").is_finite());
    let again = bench.run("evaluate run.postcard --data log.npz --order 4 --json").good().json();
    assert_eq!(report["chip"], again["chip"]);
    let text = bench.run("evaluate run.postcard --data log.npz --order 4").good().stdout;
    assert!(text.contains("on the chip, in single precision"), "{text}");
}

#[test]
fn a_size_that_is_not_compiled_is_said_and_the_rest_measured() {
    let bench = chain(9);
    let done = bench.run("evaluate run.postcard --data log.npz --json").good();
    assert!(done.stderr.contains("steps on the chip are not measured: the model has 9 coordinates"));
    let report = done.json();
    assert!(report.get("chip").is_none() && report["one_step_mse"].is_f64(), "{report}");
}
