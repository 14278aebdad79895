//! Logs with names, units and time stamps of their own, from training to firmware.

use crate::support::Bench;
use leastaction_learning::config::Config;
use leastaction_learning::data;
use std::fmt::Write;

/// The pendulum's log in degrees and milliseconds, with an extra column and jittering stamps, in two files.
fn robot_logs(bench: &Bench) {
    bench.run("generate pendulum -o data.npz --trajectories 6 --samples 40 --control held").good();
    let (log, _) = data::read(bench.at("data.npz")).unwrap();
    for (k, trajectory) in log.trajectories.iter().enumerate() {
        let mut text = "stamp;angle;mode;torque\n".to_owned();
        for (j, (t, q)) in log.times(trajectory).zip(trajectory.q.column(0)).enumerate() {
            let late = 1e-4 * log.h * ((j * 7 % 5) as f64);
            let torque = trajectory.u.as_ref().unwrap()[j][0];
            writeln!(text, "{:?};{:?};3;{torque:?}", 1e3 * (t + late), -q.to_degrees()).unwrap();
        }
        bench.write(&format!("robot-{k}.csv"), &text);
    }
}

/// The configuration of the page, for a step.
fn configuration(step: f64) -> String {
    const PAGE: &str = include_str!("../../../docs/book/src/logs.md");
    let block = PAGE.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    let changed = block.replace("step = 0.1 ", &format!("step = {step:?} "));
    assert!(changed != block || step == 0.1);
    changed
}

#[test]
fn a_robots_own_files_are_learned_from() {
    let bench = Bench::new();
    robot_logs(&bench);
    let (exact, _) = data::read(bench.at("data.npz")).unwrap();
    bench.write("c.toml", &configuration(exact.h));
    let done = bench.run("train c.toml -o run -q").good();
    assert!(done.stderr.contains("note: 6 files were resampled onto a step of"), "{}", done.stderr);
    bench.run("export run -o m.postcard").good();
    let evaluated = bench.run("evaluate m.postcard --config c.toml --json").good().json();
    assert_eq!(evaluated["trajectories"], 6);
    let by_run = bench.run("evaluate m.postcard --config run/config.toml --json").good().json();
    assert_eq!(by_run["one_step_mse"], evaluated["one_step_mse"]);
    let one = bench.run("evaluate m.postcard --config c.toml --data robot-1.csv --json").good().json();
    assert_eq!(one["trajectories"], 1);
    let of_exact = bench.run("evaluate m.postcard --data data.npz --json").good().json();
    let [found, expected] = [&evaluated, &of_exact].map(|report| report["one_step_mse"].as_f64().unwrap());
    assert!(found > 0.0 && expected < 1e-4, "{found:e} {expected:e}");
    let kept = Config::read(&bench.at("run/config.toml")).unwrap();
    assert_eq!(kept.data.columns, Config::read(&bench.at("c.toml")).unwrap().data.columns);
    bench.run("train c.toml -o run -q --resume").good();
}

#[test]
fn what_cannot_be_read_is_named() {
    let bench = Bench::new();
    robot_logs(&bench);
    let with = |from: &str, to: &str| bench.write("c.toml", &configuration(0.1).replace(from, to));
    let refused = |words: &[&str]| drop(bench.run("train c.toml -o run -q").bad(2, words));
    with("\"torque\"", "\"tau\"");
    refused(&["robot-0.csv, line 1: there is no column \"tau\"; the file has stamp, angle, mode, torque"]);
    with("unit = \"deg\"", "unit = \"grad\"");
    refused(&["c.toml", "\"grad\" is no unit that is known here", "deg"]);
    with("unit = \"deg\"", "unit = \"counts\"");
    refused(&["counts need per_turn"]);
    with("sign = -1", "sign = 0");
    refused(&["sign is 0; it is 1 or -1"]);
    with("robot-*", "machine-*");
    refused(&["machine-*.csv: no file is called so"]);
    with("t = {", "actuation = [[1.0, 0.0]]\nt = {");
    refused(&["actuation has 2 columns where 1 are needed"]);
    bench.run("evaluate m.postcard").bad(2, &["--data"]);
}

#[test]
fn a_look_at_unknown_logs_writes_a_configuration_that_trains() {
    let bench = Bench::new();
    robot_logs(&bench);
    let done = bench.run("look robot-*.csv -o robot.toml --json").good();
    let report = done.json();
    assert_eq!(report["files"].as_array().unwrap().len(), 6);
    assert_eq!(report["files"][0]["time_unit"], "ms");
    assert!((report["files"][0]["rate"].as_f64().unwrap() - 10.0).abs() < 0.1, "{report}");
    let of = |name: &str| {
        report["columns"].as_array().unwrap().iter().find(|column| column["column"] == name).cloned().unwrap()
    };
    assert_eq!((&of("stamp")["taken_for"], &of("angle")["taken_for"]), (&"t".into(), &"q0".into()));
    assert_eq!(
        (&of("torque")["taken_for"], &of("mode")["taken_for"]),
        (&"u0".into(), &serde_json::Value::Null)
    );
    assert!(
        done.stderr.contains("note: angle reaches") && done.stderr.contains("degrees"),
        "{}",
        done.stderr
    );
    let config = Config::read(&bench.at("robot.toml")).unwrap();
    assert_eq!(config.data.validation, 0.2);
    let trained = bench.run("train robot.toml -o run -q --json");
    assert!(trained.code == Some(0), "{}", trained.stderr);
    assert_eq!(trained.json()["report"].as_str(), Some("run/report.html"));
    assert!(bench.text("run/report.html").contains("Coulomb friction"));
    // The configuration may be overwritten, but no other file.
    bench.run("look robot-*.csv -o robot.toml").good();
    bench.write("mine.toml", "[data]\nfile = \"a.csv\"\n");
    bench.run("look robot-*.csv -o mine.toml").bad(2, &["mine.toml"]);
}

#[test]
fn a_page_says_what_a_model_is_worth_on_a_log() {
    let bench = Bench::new();
    robot_logs(&bench);
    bench.run("look robot-*.csv -o robot.toml").good();
    bench.run("train robot.toml -o run -q").good();
    bench.run("export run -o m.postcard").good();
    for model in ["run", "m.postcard"] {
        let done = bench.run(&format!("evaluate {model} --config robot.toml -o page.html")).good();
        assert!(done.stderr.contains("page in page.html"), "{}", done.stderr);
        let page = bench.text("page.html");
        assert!(page.contains("<h2>Errors of predictions</h2>") && page.contains("<h2>Residuals</h2>"));
    }
    bench.run("evaluate m.postcard --config robot.toml -o folder").bad(2, &["folder", "page.html"]);
    bench.write("notes.html", "mine");
    bench.run("evaluate m.postcard --config robot.toml -o notes.html").bad(2, &["notes.html"]);
}

#[test]
fn logs_without_known_names_are_looked_at_and_nothing_is_written() {
    let bench = Bench::new();
    bench.write("a.csv", "alpha,beta,note\n1,2,x\n2,3,y\n3,5,z\n");
    let done = bench.run("look a.csv").good();
    assert!(done.stdout.contains("no numbers: note") && done.stdout.contains("beta"), "{}", done.stdout);
    bench.run("look a.csv -o c.toml").bad(2, &["no configuration is written", "[data.columns]"]);
    assert!(!bench.at("c.toml").exists());
    bench.write("empty.csv", "");
    bench.run("look empty.csv").bad(2, &["empty.csv: no samples"]);
    bench.run("look b.txt").bad(2, &["b.txt"]);
}

/// Columns of a double pendulum as a laboratory names them.
const LABORATORY: &str = "time,pos_meas1,pos_meas2,pos_filt1,pos_filt2,vel_meas1,vel_meas2,tau_meas1,tau_meas2,tau_con1,tau_con2\n";

#[test]
fn a_first_configuration_is_short() {
    let bench = Bench::new();
    for k in 0..3 {
        let mut text = LABORATORY.to_owned();
        for j in 0..120 {
            let t = 0.002 * f64::from(j) + 1e-5 * f64::from(j * 7 % 5);
            let [q0, q1] = [0.3 * (3.0 * t + f64::from(k)).sin(), 0.2 * (5.0 * t).cos()];
            let [v0, v1] = [0.9 * (3.0 * t + f64::from(k)).cos(), -(5.0 * t).sin()];
            let [u0, u1] = [0.1 * (4.0 * t).sin(), 0.2 * (2.0 * t).cos()];
            writeln!(text, "{t},{q0},{q1},{q0},{q1},{v0},{v1},{u0},{u1},{u0},{u1}").unwrap();
        }
        bench.write(&format!("run-{k}.csv"), &text);
    }
    bench.run("look run-*.csv -o robot.toml").good();
    let text = bench.text("robot.toml");
    assert!(text.lines().count() <= 25, "{text}");
    let config = Config::read(&bench.at("robot.toml")).unwrap();
    let columns = config.data.columns.as_ref().unwrap();
    assert_eq!(
        (columns.columns.u[0].name.as_str(), columns.other_u[0][1].name.as_str()),
        ("tau_con1", "tau_meas2")
    );
    assert_eq!((config.data.step, config.data.validation), (None, 0.2));
}

#[test]
fn a_look_says_what_was_excited_and_what_is_apart() {
    let bench = Bench::new();
    let mut text = "time,pos1,pos2,tau1,tau2\n".to_owned();
    for j in 0..1500 {
        let t = 0.002 * f64::from(j);
        let (mut q0, q1) = (0.5 * (6.0 * t).sin(), 0.1 * t);
        if j == 700 {
            q0 += 0.3;
        }
        let stamp = if j == 40 { t - 0.002 } else { t };
        writeln!(text, "{stamp},{q0},{q1},{},{}", (3.0 * t).sin(), (2.0 * t).cos()).unwrap();
    }
    bench.write("a.csv", &text);
    let done = bench.run("look a.csv --json").good();
    let report = done.json();
    let coordinate = |i: usize| report["coordinates"][i].clone();
    assert_eq!(
        (&coordinate(0)["reversals"], &coordinate(1)["reversals"]),
        (&6.into(), &0.into()),
        "{report}"
    );
    assert_eq!(
        (&coordinate(0)["outliers"], &coordinate(0)["first_outlier"]["sample"]),
        (&1.into(), &700.into())
    );
    let speed = coordinate(0)["speed"].as_f64().unwrap();
    assert!((speed / (3.0 / 2f64.sqrt()) - 1.0).abs() < 0.05, "{speed}");
    for words in [
        "pos1 has 1 single sample apart from the neighbours, the first by 0.300 at 1.4000 s (sample 700) of a.csv",
        "pos2 never turns back",
        "a.csv: 1 stamp repeated",
    ] {
        assert!(done.stderr.contains(words), "{words:?} is not in {}", done.stderr);
    }
    let table = bench.run("look a.csv").good().stdout;
    assert!(table.contains("reversals  turns  outliers"), "{table}");
}
