use crate::support::Bench;
use serde_json::Value;

/// A pendulum learned well enough to be controlled.
fn learned() -> Bench {
    let bench = Bench::new();
    bench.run("generate pendulum -o data.npz --trajectories 8 --samples 24 --h 0.05").good();
    bench.write(
        "c.toml",
        "[data]\nfile = \"data.npz\"\n[model]\ncoordinates = \"a\"\nhidden = [8]\n[training]\niterations = 25\n",
    );
    bench.run("train c.toml -o run -q").good();
    bench.model("run");
    bench
}

fn simulate(bench: &Bench, options: &str) -> Value {
    bench.run(&format!("simulate run.postcard --json {options}")).good().json()
}

#[test]
fn a_learned_model_predicts_tracks_and_swings_up() {
    let bench = learned();
    for scenario in ["predict --seconds 2", "track", "swing-up", "mpc"] {
        let report = simulate(&bench, &format!("--scenario {scenario} -o out"));
        assert_eq!((report["success"].as_bool(), report["system"].as_str()), (Some(true), Some("pendulum")));
        assert_eq!(report["model_errors"].as_u64(), Some(0));
        let trace = bench.text("out/trace.csv");
        assert_eq!(trace.lines().count() as u64, 1 + report["ticks"].as_u64().unwrap());
        let columns = trace.lines().next().unwrap().split(',').count();
        assert!(trace.lines().all(|line| line.split(',').count() == columns));
        assert!(bench.text("out/run.svg").contains("</svg>"));
    }
}

#[test]
fn decisions_are_counted() {
    let bench = learned();
    let report = simulate(&bench, "--scenario mpc --seed 2");
    let count = |name: &str| report["decided"][name].as_u64().unwrap();
    assert!(count("decided") > 90 && count("followed") + count("floated") == 0, "{report}");
}

#[test]
fn decisions_bring_another_file_s_mechanism_to_a_goal() {
    let bench = learned();
    let options = "--scenario mpc --plant run.postcard --at 3.1 --goal 0 --limit 2.5";
    let report = simulate(&bench, options);
    assert_eq!((report["success"].as_bool(), report["system"].as_str()), (Some(true), Some("run.postcard")));
    let refused = |options: &str, words: &str| {
        bench.run(&format!("simulate run.postcard --scenario {options}")).bad(2, &[words])
    };
    refused("mpc --plant run.postcard --goal 0", "--limit");
    refused("mpc --plant run.postcard --limit 2", "--goal");
    refused("mpc --goal 1,2", "--goal has 2 values");
    refused("mpc --goal 1.5", "command that holds the goal");
    refused("track --goal 1", "--goal is of --scenario mpc");
    let plans = " --plan run.postcard".repeat(9);
    refused(&format!("mpc{plans}"), "at most 8 plans, but --plan names 9");
    refused("mpc --plan run.postcard", "run.postcard");
    refused("follow --plan a --plan b", "follow takes one plan");
}

#[test]
fn another_step_than_the_models_is_said_aloud() {
    let bench = learned();
    let said = |tick: &str| {
        bench.run(&format!("simulate run.postcard --scenario predict --seconds 1{tick} --json")).stderr
    };
    assert!(said("").contains("tick is 0.01, but must be 0.05, which the model was trained for"));
    assert!(!said(" --tick 0.05").contains("warning"));
}

#[test]
fn a_seed_is_a_trace() {
    let bench = learned();
    let hash = |seed: u32| simulate(&bench, &format!("--scenario track --seed {seed}"))["trace_hash"].clone();
    assert_eq!(hash(1), hash(1));
    assert_ne!(hash(1), hash(2));
}

#[test]
fn an_untrained_model_fails_but_is_reported() {
    let bench = Bench::new();
    bench.log("");
    bench.config("iterations = 0\nloss = \"del-residual\"");
    bench.run("train c.toml -o run -q").good();
    bench.model("run");
    let outcome = bench.run("simulate run.postcard --scenario predict --json");
    assert_eq!(outcome.code, Some(1), "{}", outcome.stderr);
    assert_eq!(outcome.json()["success"].as_bool(), Some(false));
    assert!(outcome.stderr.contains("did not reach its goal") && outcome.stderr.contains("run.svg"));
}

/// A triple pendulum, for which there is no exact mechanism, against itself as a plant: as a tree, and its smaller parts.
#[test]
fn a_model_file_can_be_the_plant() {
    let bench = Bench::new();
    bench.run("generate n-pendulum --count 3 -o triple.npz --trajectories 6 --h 0.01").good();
    bench.write(
        "triple.toml",
        "[data]\nfile = \"triple.npz\"\n[model]\nfamily = \"modular\"\n[[model.types]]\nname = \"bob\"\ntransform = \"angle\"\n\
         position = []\npotential = []\n[model.trees]\ntriple = [\"bob\", \"bob\", \"bob\"]\n[training]\n\
         loss = \"acceleration\"\niterations = 20\n",
    );
    bench.run("train triple.toml -o run -q").good();
    bench.model("run");
    let words = "--scenario predict --seconds 0.5 --tick 0.01 --json -o out";
    bench.run(&format!("simulate run.postcard {words}")).bad(2, &["no mechanism", "\"aaa\"", "--plant"]);
    let report = bench.run(&format!("simulate run.postcard --plant run.postcard {words}")).good().json();
    assert_eq!((report["system"].as_str(), report["success"].as_bool()), (Some("run.postcard"), Some(true)));
    assert_eq!(report["max_error"].as_array().map(Vec::len), Some(3));
    let moved = report["max_q"].as_array().unwrap().iter().any(|q| q.as_f64().unwrap() > 0.1);
    assert!(moved && bench.text("out/trace.csv").starts_with("index,time,q0,q1,q2,v0"), "{report}");
    let refused = |words: &str, said: &[&str]| {
        bench.run(&format!("simulate run.postcard --plant {words}")).bad(2, said);
    };
    refused("run.postcard --scenario track", &["track", "leave out --plant"]);
    refused("run.postcard --scenario predict --system pendulum", &["--system"]);
    refused("no.postcard --scenario predict", &["no.postcard"]);
    bench.log("");
    bench.config("iterations = 1");
    bench.run("train c.toml -o run --force -q").good();
    bench.run("export run -o other.postcard").good();
    refused("other.postcard --scenario predict", &["--plant", "\"aaa\"", "must be the same"]);
}

#[test]
fn what_cannot_be_simulated_is_refused() {
    let bench = learned();
    bench.run("simulate no.postcard --scenario track").bad(2, &["no.postcard"]);
    bench.run("simulate run.postcard --scenario juggle").bad(2, &["juggle", "swing-up"]);
    bench
        .run("simulate run.postcard --scenario track --system cartpole")
        .bad(2, &["1 coordinates", "--system"]);
    bench.run("simulate run.postcard --scenario track --seconds -1").bad(2, &["--seconds", "above 0"]);
    bench.run("simulate run.postcard --scenario track --seconds 1e-9").bad(2, &["length of the run"]);
    bench.run("simulate run.postcard --scenario track --seed -1").bad(2, &["--seed", "whole number"]);
    bench
        .run("simulate run.postcard --scenario track -o run.postcard")
        .bad(2, &["run.postcard", "name a folder"]);
    bench.run("simulate run.postcard --scenario track --tick nan").bad(2, &["tick"]);
}

#[test]
fn evaluation_compares_energy_only_where_no_force_acts() {
    let bench = learned();
    let measures = |log: &str| {
        let words = format!("evaluate run.postcard --data {log}.npz --system pendulum --json");
        let done = bench.run(&words).good();
        let report = done.json();
        assert!(report["one_step_mse"].as_f64().unwrap() < 1e-6 && report["inertia_mse"].is_f64());
        (report["energy_mse"].as_f64(), done.stderr.contains("energy is not compared"))
    };
    assert_eq!(measures("data"), (None, true));
    bench.run("generate pendulum -o free.npz --h 0.05 --trajectories 2 --no-control").good();
    assert!(matches!(measures("free"), (Some(error), false) if error < 1.0));
    bench.run("evaluate run.postcard --data data.npz --order 3").bad(2, &["--order", "2 or 4"]);
}

#[test]
fn a_log_is_replayed_with_the_same_bits_and_its_errors_are_told() {
    let bench = learned();
    let robot = "generate pendulum --robot logs --trajectories 2 --samples 101 --h 0.05 --amplitude 0.2,0.6 --noise 0.002";
    bench.run(robot).good();
    let columns =
        "[data]\nfile = \"logs/00.csv\"\n[data.columns]\nt = \"time\"\nq = \"pos_meas1\"\nu = \"tau_con1\"\n";
    bench.write("robot.toml", &format!("{columns}[model]\ncoordinates = \"a\"\nhidden = [4]\n"));
    let replay = || simulate(&bench, "--replay logs/01.csv --config robot.toml -o out");
    let report = replay();
    let number = |name: &str| report[name][0].as_f64().unwrap();
    assert_eq!((report["ticks"].as_u64(), report["model_errors"].as_u64()), (Some(101), Some(0)));
    assert!(number("innovation_rms") < 0.6 * number("constant_velocity_rms"), "{report}");
    assert!(number("innovation_rms") > 0.002 && number("innovation_mean").abs() < 0.002, "{report}");
    assert_eq!(bench.text("out/trace.csv").lines().count(), 102);
    assert_eq!(replay()["trace_hash"], report["trace_hash"]);
}

#[test]
fn options_that_mean_nothing_are_refused() {
    let bench = learned();
    let refused = |options: &str, word: &str| {
        drop(bench.run(&format!("simulate run.postcard {options}")).bad(2, &[word]))
    };
    refused("--scenario predict --delay 8", "predict");
    refused("--scenario track --delay 500", "8 ticks");
    refused("--scenario track --jitter 50", "from 0 to 1");
    refused("--scenario track --coulomb 0.1,0.2", "2 values");
    refused("--scenario track --coulomb -0.1", "0 or above");
    refused("--replay data.npz --delay 8", "--learn-zeros");
    refused("", "--scenario");
    refused("--replay nothing.csv", "nothing.csv");
}

#[test]
fn friction_and_devices_of_the_plant_change_the_run() {
    let bench = learned();
    let run = |options: &str| simulate(&bench, &format!("--scenario track {options} -o out"));
    let plain = run("");
    for options in
        ["--coulomb 0.05", "--viscous 0.1", "--zeros 0.02", "--noise 0.004", "--delay 8", "--jitter 2"]
    {
        assert_ne!(run(options)["trace_hash"], plain["trace_hash"], "{options}");
    }
    assert_eq!(run("--coulomb 0 --zeros 0 --delay 10 --jitter 0")["trace_hash"], plain["trace_hash"]);
}
