//! New logs for a run: read as its own were, or by leastaction's names; and what is written of them for other programs.

use crate::support::Bench;
use leastaction_learning::data::survey::RawLog;
use leastaction_learning::data::{self, Dataset};
use std::fmt::Write;

/// A run that learned from logs in degrees with a linear control, a further log of this kind, and data.npz with the same motions.
fn learned(bench: &Bench) -> Dataset {
    bench.run("generate pendulum -o data.npz --trajectories 4 --samples 60 --control linear").good();
    let (log, _) = data::read(bench.at("data.npz")).unwrap();
    for (k, trajectory) in log.trajectories.iter().enumerate() {
        let mut text = "stamp,angle,torque\n".to_owned();
        for (j, t) in log.times(trajectory).enumerate() {
            let torque = trajectory.u.as_ref().unwrap()[j][0];
            writeln!(text, "{t:?},{:?},{torque:?}", trajectory.q[j][0].to_degrees()).unwrap();
        }
        bench.write(&format!("{}-{k}.csv", if k == 3 { "new" } else { "robot" }), &text);
    }
    bench.write(
        "c.toml",
        "[data]\nfile = \"robot-*.csv\"\ncontrol = \"linear\"\n[data.columns]\nt = \"stamp\"\n\
         q = { name = \"angle\", unit = \"deg\" }\nu = \"torque\"\n\
         [model]\ncoordinates = \"a\"\nhidden = [6]\n[training]\niterations = 20\n",
    );
    bench.run("train c.toml -o run -q").good();
    log
}

#[test]
fn new_logs_are_read_as_the_runs_own_or_by_their_own_names() {
    let bench = Bench::new();
    learned(&bench);
    let judged = |options: &str| {
        let done = bench.run(&format!("evaluate run {options} --json")).good();
        (done.json(), done.stderr)
    };
    let (by_run, said) = judged("--data new-3.csv");
    assert!(
        said.contains("note: new-3.csv is read as the logs of the run were, by [data] of run/config.toml"),
        "{said}"
    );
    let (configured, said) = judged("--data new-3.csv --config c.toml");
    assert!(!said.contains("by [data]"), "{said}");
    assert_eq!(by_run, configured);
    assert_eq!((&by_run["control"], &by_run["trajectories"]), (&"linear".into(), &1.into()));
    let (native, said) = judged("--data data.npz");
    assert!(said.contains("data.npz has the names of leastaction's own logs and is read by them"), "{said}");
    assert_eq!(native["trajectories"], 4);
    let done = bench.run("export run -o m.postcard --data new-3.csv --json").good();
    assert_eq!(done.json()["accuracy"]["data"], "new-3.csv");
    bench.write("other.csv", "time,phi\n0,1\n1,2\n2,3\n");
    bench.run("evaluate run --data other.csv").bad(
        2,
        &[
            "there is no column",
            "read by [data] of run/config.toml; if this log is laid out otherwise, give a configuration",
        ],
    );
    bench.run("evaluate m.postcard --data new-3.csv").bad(2, &["new-3.csv"]);
}

#[test]
fn measured_and_predicted_motion_is_written_as_a_bag() {
    let bench = Bench::new();
    let log = learned(&bench);
    let done = bench.run("evaluate run --data new-3.csv --mcap out.mcap").good();
    assert!(done.stderr.contains("bag in out.mcap"), "{}", done.stderr);
    let topics = RawLog::read(&bench.at("out.mcap")).unwrap();
    let [measured, predicted, residual] = &topics[..] else { panic!("three topics") };
    let column = |log: &'_ RawLog, name: &str| log.column(name).unwrap().to_vec();
    let q: Vec<f64> = log.trajectories[3].q.column(0).collect();
    let found = column(measured, "/measured/angle/position");
    assert!(found.len() == q.len() && found.iter().zip(&q).all(|(a, b)| (a - b).abs() < 1e-12));
    let u: Vec<f64> = log.trajectories[3].u.as_ref().unwrap().column(0).collect();
    assert_eq!(column(measured, "/measured/angle/effort"), u);
    // Three samples before the first start have no prediction, the start itself has none either.
    let (predicted, residual) =
        (column(predicted, "/predicted/angle/position"), column(residual, "/residual/angle/position"));
    assert_eq!(predicted.len(), q.len() - 4);
    let sum = predicted.iter().zip(&residual).zip(&q[4..]);
    assert!(sum.clone().all(|((a, b), q)| (a + b - q).abs() < 1e-12));
    let rms = (residual.iter().map(|x| x * x).sum::<f64>() / residual.len() as f64).sqrt();
    assert!(rms > 0.0 && rms < 0.5, "{rms}");
    bench.run("evaluate run --data new-3.csv --mcap c.toml").bad(2, &["no bag (MCAP)"]);
    // Trajectories that begin at the same time follow each other.
    let done = bench.run("evaluate run --data data.npz --mcap all.mcap").good();
    assert!(done.stderr.contains("trajectories whose stamps overlap are 1 s apart"), "{}", done.stderr);
    assert_eq!(RawLog::read(&bench.at("all.mcap")).unwrap()[0].samples(), 240);
}
