//! Logs as loggers lay them out, from `look` to `train`.

use crate::support::Bench;
use std::fmt::Write as _;

/// A pendulum's log of two seconds, with this text before the samples.
fn log(head: &str, row: impl Fn(f64, f64, f64) -> String) -> String {
    let mut text = head.to_owned();
    for k in 0..200 {
        let t = 0.01 * f64::from(k);
        writeln!(text, "{}", row(t, 0.5 * (3.0 * t).sin(), (5.0 * t).cos())).unwrap();
    }
    text
}

/// Looks at a log, and trains for an iteration with the configuration that is written.
fn trains(bench: &Bench, name: &str, text: &str, options: &str) -> String {
    std::fs::write(bench.at(name), text).unwrap();
    let done = bench.run(&format!("look {name} -o {name}.toml {options}")).good();
    assert!(!done.stderr.contains("training will refuse"), "{name}: {}", done.stderr);
    let written = bench.text(&format!("{name}.toml"));
    std::fs::write(bench.at(&format!("{name}.toml")), written.clone() + "iterations = 1\n").unwrap();
    bench.run(&format!("train {name}.toml -o {name}-run")).good();
    written
}

#[test]
fn logs_of_many_layouts_are_looked_at_and_learned_from() {
    let bench = Bench::new();
    trains(&bench, "comma.csv", &log("time,pos,tau\n", |t, q, u| format!("{t:.2},{q},{u},")), "");
    trains(&bench, "blank.csv", &log("time pos tau\n", |t, q, u| format!("{t:.2}  {q} {u}")), "");
    let rate = trains(&bench, "rate.csv", &log("pos,tau\n", |_, q, u| format!("{q},{u}")), "--rate 100");
    assert!(rate.contains("\nrate = 100.0"), "{rate}");
    let two = log("sec,nanosec,pos,tau\n", |t, q, u| {
        format!("{},{:.0},{q},{u}", 1_700_000_000 + t as u64, 1e9 * t.fract())
    });
    let two = trains(&bench, "two.csv", &two, "");
    assert!(two.contains("t = { sec = \"sec\", nanosec = \"nanosec\" }"), "{two}");
    let several = |t: f64, q: f64, u: f64| format!("{t:.3},{q},\n{:.3},,{u}", t + 0.003);
    let several = log("time,pos,tau\n", several);
    trains(&bench, "several.csv", &several, "");
    trains(&bench, "again.csv", &several.repeat(2), "");
    let shown = bench.run("look again.csv").good();
    assert!(!shown.stderr.contains("time goes back"), "{}", shown.stderr);
}

/// A force tells of an axis that slides, a torque of a joint that turns.
#[test]
fn a_force_acts_on_what_slides() {
    let bench = Bench::new();
    let axis = |head: &str| log(head, |t, q, u| format!("{t:.2},{q},{u}"));
    let slides = trains(&bench, "axis.csv", &axis("time,position,force\n"), "");
    assert!(
        slides.contains("joint = \"prismatic\"") && slides.contains("\noffset = \"learned\""),
        "{slides}"
    );
    let turns = trains(&bench, "joint.csv", &axis("time,position,torque\n"), "");
    assert!(turns.contains("chain = 1") && turns.contains("\nzero = \"learned\""), "{turns}");
    // The gain of a slide's drive is a factor of all that is learned; that of a joint tells its direction.
    assert!(!slides.contains("\ngain = ") && turns.contains("\ngain = \"learned\""), "{slides} {turns}");
}

#[test]
fn a_log_without_a_header_is_read_by_numbers() {
    let bench = Bench::new();
    std::fs::write(bench.at("a.csv"), log("", |t, q, u| format!("{t:.2},{q},{u}"))).unwrap();
    let report = bench.run("look a.csv").good().stdout;
    assert!(report.contains("#1          t ") && report.contains("#3"), "{report}");
    let words = [
        "there is no header line; #1 rises as time does",
        "#2 from -0.",
        "#3 from -1.0000 to 1.0000",
        "u = [4, 5]",
    ];
    bench.run("look a.csv -o a.toml").bad(2, &words);
    std::fs::write(
        bench.at("a.toml"),
        "[data]\nfile = \"a.csv\"\nvalidation = 0.0\n[data.columns]\nt = 1\nq = 2\nu = 3\n[model]\ncoordinates = \"a\"\nhidden = [4]\n[training]\niterations = 1\n",
    )
    .unwrap();
    bench.run("train a.toml -o run").good();
}

#[test]
fn positions_without_names_are_known_by_their_velocities() {
    let bench = Bench::new();
    let row = |t: f64, q: f64, u: f64| format!("{},{u},{},{q}", 1e3 * t, 1.5 * (3.0 * t).cos());
    std::fs::write(bench.at("a.csv"), log("", row)).unwrap();
    let done = bench.run("look a.csv -o a.toml").good();
    let note = "q are columns of which others are the derivatives, u are the others";
    assert!(done.stderr.contains(note), "{}", done.stderr);
    let written = bench.text("a.toml");
    assert!(written.contains("t = { name = 1, unit = \"ms\" }\nq = [4]\nu = [2]\n"), "{written}");
    std::fs::write(bench.at("a.toml"), written + "iterations = 1\n").unwrap();
    bench.run("train a.toml -o run").good();
}

#[test]
fn trajectories_of_our_own_logs_need_no_sorting() {
    let bench = Bench::new();
    for (file, u) in [("data.npz", "u"), ("data.csv", "u0")] {
        bench
            .run(&format!("generate pendulum -o {file} --trajectories 5 --samples 60 --control held"))
            .good();
        let done = bench.run(&format!("look {file} -o {file}.toml --json")).good();
        assert!(!done.stderr.contains("time goes back"), "{}", done.stderr);
        let report = done.json();
        assert_eq!((&report["files"][0]["backwards"], &report["files"][0]["gaps"]), (&0.into(), &0.into()));
        assert_eq!(report["coordinates"][0]["column"], if u == "u" { "q" } else { "q0" }, "{report}");
        let written = bench.text(&format!("{file}.toml"));
        assert!(!written.contains("[data.columns]") && written.contains("validation = 0.2"), "{written}");
        std::fs::write(bench.at(&format!("{file}.toml")), written + "iterations = 1\n").unwrap();
        bench.run(&format!("train {file}.toml -o {file}-run")).good();
    }
}

#[test]
fn steps_that_differ_a_little_become_one() {
    let bench = Bench::new();
    for (name, h) in [("a.csv", 2.03e-3), ("b.csv", 2.05e-3)] {
        let row = |t: f64, q: f64, u: f64| format!("{:.6},{q},{u}", t / 0.01 * h);
        std::fs::write(bench.at(name), log("time,pos,tau\n", row)).unwrap();
    }
    bench.run("look a.csv b.csv -o c.toml").good();
    let written = bench.text("c.toml");
    assert!(written.contains("\nstep = 0.00"), "{written}");
    std::fs::write(bench.at("c.toml"), written + "iterations = 1\n").unwrap();
    bench.run("train c.toml -o run").good();
}

/// A pendulum in degrees and milliseconds, as a line under the header says, over most of a turn.
#[test]
fn units_of_the_log_are_those_of_the_configuration() {
    let bench = Bench::new();
    bench.run("generate pendulum -o data.npz --trajectories 3 --samples 80 --control held").good();
    let (log, _) = leastaction_learning::data::read(bench.at("data.npz")).unwrap();
    for (k, trajectory) in log.trajectories.iter().enumerate() {
        let mut text = "time,pos,tau\nms,[°],N*m\n".to_owned();
        for (j, t) in log.times(trajectory).enumerate() {
            let torque = trajectory.u.as_ref().unwrap()[j][0];
            text += &format!("{:?},{:?},{torque:?}\n", 1e3 * t, trajectory.q[j][0].to_degrees());
        }
        bench.write(&format!("log-{k}.csv"), &text);
    }
    let done = bench.run("look log-*.csv -o robot.toml --json").good();
    let text = bench.text("robot.toml");
    assert!(text.contains("t = { name = \"time\", unit = \"ms\" }"), "{text}");
    assert!(text.contains("q = [{ name = \"pos\", unit = \"deg\" }]\nu = [\"tau\"]"), "{text}");
    assert!(!done.stderr.contains("if it is in degrees"), "{}", done.stderr);
    assert_eq!(done.json()["columns"][1]["unit"], "deg");
    bench.run("train robot.toml -o run -q").good();
}
