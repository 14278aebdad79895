//! Control kinds, from the log to the model file.

use crate::support::Bench;
use leastaction_core::forces::ControlKind::{self, Held, Linear};
use leastaction_learning::data::{self, control_name};
use leastaction_models::file::decode;

const KINDS: [ControlKind; 2] = [Held, Linear];

/// A configuration with this control kind.
fn config(bench: &Bench, control: ControlKind) {
    bench.config("iterations = 3");
    let line = format!("validation = 0.25\ncontrol = \"{}\"", control_name(control));
    bench.write("c.toml", &bench.text("c.toml").replace("validation = 0.25", &line));
}

#[test]
fn a_generated_log_says_what_its_control_does() {
    let bench = Bench::new();
    for kind in KINDS {
        for name in ["a.npz", "a.csv"] {
            let control = control_name(kind);
            bench
                .run(&format!("generate acrobot -o {name} --trajectories 2 --samples 5 --control {control}"))
                .good();
            let (log, _) = data::read(bench.at(name)).unwrap();
            assert_eq!(log.control, Some(kind));
            assert!(log.control_changes());
        }
    }
    bench.log("--control constant");
    let (log, _) = data::read(bench.at("data.npz")).unwrap();
    assert_eq!((log.control, log.control_changes(), log.is_forced()), (None, false, true));
    bench.run("generate pendulum -o b.npz --control held --no-control").bad(2, &["--no-control"]);
    bench.run("generate pendulum -o b.npz --control held --symo-layout").bad(2, &["--symo-layout"]);
}

#[test]
fn the_model_file_says_what_the_control_did() {
    let bench = Bench::new();
    bench.log("--control linear");
    bench.config("iterations = 3");
    for (k, (log, asked, expected)) in [
        ("--control linear", None, Linear),
        ("--control held", None, Held),
        ("--control linear", Some(Linear), Linear),
        // A constant control is both held and linear.
        ("--control constant", None, Held),
        ("--control constant", Some(Linear), Linear),
    ]
    .into_iter()
    .enumerate()
    {
        bench.log(log);
        asked.map_or_else(|| bench.config("iterations = 3"), |kind| config(&bench, kind));
        bench.run(&format!("train c.toml -o run{k} -q")).good();
        bench.run(&format!("export run{k} -o m.postcard")).good();
        let step = decode(&bench.read("m.postcard")).unwrap().facts.trained_step.unwrap();
        assert_eq!(step.control, expected, "{log}, {asked:?}");
        let report = bench.run("inspect m.postcard --json").good().json();
        assert_eq!(report["control"].as_str(), Some(control_name(expected)));
    }
}

#[test]
fn what_the_log_says_and_what_is_asked_must_agree() {
    let bench = Bench::new();
    bench.log("--control linear");
    config(&bench, Held);
    let words = ["[data] control = \"held\"", "u is linear between samples", "control = \"linear\""];
    bench.run("train c.toml -o run -q").bad(2, &words);
    bench.write("c.toml", &bench.text("c.toml").replace("\"held\"", "\"hold\""));
    bench.run("train c.toml -o run -q").bad(2, &["hold", "held", "linear", "c.toml:4"]);
    assert!(!bench.at("run").exists());
    config(&bench, Linear);
    bench.run("train c.toml -o run -q").good();
    bench.run("export run -o m.postcard").good();
    bench
        .run("evaluate m.postcard --data data.npz --control held")
        .bad(2, &["--control held", "its u is linear"]);
    bench.run("evaluate m.postcard --data data.npz --control hold").bad(2, &["it must be held or linear"]);
}

#[test]
fn evaluation_follows_the_log_and_tells_of_another_model() {
    let bench = Bench::new();
    bench.log("--control held --seed 3");
    bench.config("iterations = 3");
    bench.run("train c.toml -o run -q").good();
    bench.run("export run -o m.postcard").good();
    let evaluated = |options: &str| {
        let outcome = bench.run(&format!("evaluate m.postcard --json {options}")).good();
        let report = outcome.json();
        let errors = ["one_step_mse", "rollout_mse"].map(|key| report[key].as_f64().unwrap());
        (errors, report["control"].as_str().map(str::to_owned), outcome.stderr)
    };
    let own = evaluated("--data data.npz");
    assert_eq!((own.1.as_deref(), own.2.contains("was trained with a control")), (Some("held"), false));
    // A log without a control kind takes the model's, or the one asked for.
    let (mut log, _) = data::read(bench.at("data.npz")).unwrap();
    log.control = None;
    data::write(bench.at("silent.npz"), &log).unwrap();
    assert_eq!(evaluated("--data silent.npz"), own);
    let (errors, control, said) = evaluated("--data silent.npz --control linear");
    assert!(said.contains("trained with a control that is held") && said.contains("one that is linear"));
    assert_eq!(control.as_deref(), Some("linear"));
    assert!(errors[0] > 2.0 * own.0[0] && errors[1] != own.0[1], "{errors:?} {:?}", own.0);
    // The log contradicts the model.
    log.control = Some(Linear);
    data::write(bench.at("other.npz"), &log).unwrap();
    assert_eq!(evaluated("--data other.npz"), (errors, control, said));
}
