use crate::support::{Bench, Outcome};
use leastaction_learning::config::Config;
use std::io;
use std::process::Stdio;

#[test]
fn from_log_to_model() {
    let bench = Bench::new();
    bench.log("");
    bench.config("iterations = 5");
    let done = bench.run("train c.toml -o run --json").good();
    let report = done.json();
    assert_eq!((report["iterations"].as_u64(), report["ending"].as_str()), (Some(8), Some("iterations")));
    assert_eq!(
        (report["training_samples"].as_u64(), report["validation_samples"].as_u64()),
        (Some(30), Some(10))
    );
    assert!(report["train_loss"].as_f64().unwrap() < 1e-2 && report["validation_loss"].is_f64());
    assert!(done.stderr.contains("warm-up: train"), "{}", done.stderr);
    let history = bench.text("run/history.csv");
    assert_eq!(history.lines().next(), Some("iteration,stage,seconds,train,validation"));
    assert_eq!(history.lines().filter(|line| line.contains(",warm-up,")).count(), 3);
    assert_eq!(history.lines().filter(|line| line.contains(",training,")).count(), 5);
    assert!(bench.text("run/loss.svg").contains("</svg>"));
    assert!(bench.model("run").starts_with(b"LACT"));
}

#[test]
fn quiet_says_nothing_and_losses_fall() {
    let bench = Bench::new();
    bench.log("");
    bench.config("iterations = 4");
    assert_eq!(bench.run("train c.toml -o run --quiet").good().stderr, "");
    let losses: Vec<f64> = bench
        .text("run/history.csv")
        .lines()
        .filter(|line| line.contains(",training,"))
        .map(|line| line.split(',').nth(3).unwrap().parse().unwrap())
        .collect();
    assert!(losses.is_sorted_by(|a, b| a > b), "{losses:?}");
}

#[test]
fn every_loss_and_both_optimisers_train() {
    let bench = Bench::new();
    bench.log("");
    let cases = [
        "loss = \"del-residual\"",
        "loss = \"acceleration\"",
        "optimiser = \"adam\"",
        "loss = \"del-residual\"\noptimiser = \"adam\"\n[training.adam]\nbatch = 7",
    ];
    for (k, case) in cases.iter().enumerate() {
        bench.config(&format!("iterations = 3\n{case}"));
        // Three iterations of Adam are few.
        bench.run(&format!("train c.toml -o run{k} -q --accept-poor")).good();
        assert!(bench.model(&format!("run{k}")).len() > 100);
    }
}

#[test]
fn printed_defaults_are_a_configuration() {
    let bench = Bench::new();
    let printed = bench.run("train --print-defaults").good().stdout;
    bench.write("c.toml", &printed);
    assert_eq!(Config::read(&bench.at("c.toml")).unwrap().data.file, bench.at("data.npz").into());
}

#[test]
fn it_stops_at_the_target_by_patience_and_by_time() {
    let bench = Bench::new();
    bench.log("");
    for (stop, ending) in
        [("target = 1.0", "target"), ("max_seconds = 1e-6", "time"), ("patience = 0", "patience")]
    {
        bench.config(&format!("iterations = 200\n{stop}"));
        let report = bench.run("train c.toml -o run --force -q --json").good().json();
        assert_eq!(report["ending"].as_str(), Some(ending));
        assert!(report["iterations"].as_u64().unwrap() < 203);
    }
}

#[test]
fn configuration_errors_name_file_line_and_key() {
    let bench = Bench::new();
    bench.log("");
    bench.run("train no.toml -o run").bad(2, &["no.toml", "--print-defaults"]);
    bench.config("iteratons = 5");
    bench.run("train c.toml -o run").bad(2, &["c.toml:10", "iteratons", "did you mean `iterations`?"]);
    bench.config("optimiser = \"sgd\"");
    bench.run("train c.toml -o run").bad(2, &["c.toml:10", "sgd", "levenberg-marquardt"]);
    bench.config("threads = 100000");
    bench.run("train c.toml -o run").bad(2, &["c.toml:10", "from 0 to 1024"]);
    bench.run("train c.toml").bad(2, &["--output"]);
    assert!(!bench.at("run").exists());
}

#[test]
fn data_that_does_not_fit_is_refused() {
    let bench = Bench::new();
    bench.config("iterations = 2");
    bench.run("train c.toml -o run").bad(2, &["data.npz"]);
    bench.run("generate cartpole -o data.npz --trajectories 2 --samples 4").good();
    bench.run("train c.toml -o run").bad(2, &["c.toml", "1 coordinates", "data has 2"]);
    bench.write("data.csv", "t,q\n0,0.1\n0.1,nan\n0.2,0.3\n");
    bench.write("c.toml", &bench.text("c.toml").replace("data.npz", "data.csv"));
    bench.run("train c.toml -o run").bad(2, &["data.csv", "line 3", "column q"]);
    bench.write("data.csv", "t,q\n0,0.1\n0.1,0.2\n0.2,0.3\n0.3,0.4\n");
    bench.config("iterations = 1\nloss = \"acceleration\"");
    bench.write("c.toml", &bench.text("c.toml").replace("data.npz", "data.csv"));
    bench.run("train c.toml -o run").bad(2, &["velocities (v)"]);
    assert!(!bench.at("run").exists());
}

#[test]
fn motion_without_force_is_refused_or_noticed() {
    let bench = Bench::new();
    bench.log("--no-control");
    bench.config("iterations = 2\nloss = \"del-residual\"");
    bench.run("train c.toml -o run").bad(2, &["no sample is forced", "L = 0", "next-position"]);
    bench.config("iterations = 2\nloss = \"acceleration\"");
    let done = bench.run("train c.toml -o run -q").good();
    assert!(done.stderr.contains("up to one common factor"), "{}", done.stderr);
}

#[test]
fn an_existing_run_is_kept_unless_forced() {
    let bench = Bench::new();
    bench.log("");
    bench.config("iterations = 1");
    bench.run("train c.toml -o run -q").good();
    let before = bench.read("run/checkpoint.postcard");
    bench.config("iterations = 2\nseed = 9");
    bench.run("train c.toml -o run -q").bad(2, &["run already exists", "--resume", "--force"]);
    assert_eq!(bench.read("run/checkpoint.postcard"), before);
    bench.run("train c.toml -o run -q --resume --force").bad(2, &["--resume"]);
    bench.run("train c.toml -o run -q --force").good();
    assert_ne!(bench.read("run/checkpoint.postcard"), before);
    bench.write("file", "mine");
    bench.run("train c.toml -o file -q").bad(2, &["file already exists"]);
    assert_eq!(bench.text("file"), "mine");
}

#[test]
fn nobody_listening_is_no_panic() {
    let bench = Bench::new();
    let (reader, writer) = io::pipe().unwrap();
    drop(reader);
    let mut command = bench.command("train --print-defaults");
    let child = command.stdout(writer).stderr(Stdio::piped()).spawn().unwrap();
    let outcome = Outcome::new(child.wait_with_output().unwrap());
    assert_eq!((outcome.code, outcome.stderr.as_str()), (Some(0), ""));
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_stdout_is_an_error() {
    let bench = Bench::new();
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let output = bench.command("train --print-defaults").stdout(full).output().unwrap();
    Outcome::new(output).bad(1, &["stdout"]);
}
