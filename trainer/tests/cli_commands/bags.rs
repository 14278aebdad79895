//! Bags of ROS 2 and recordings in several files, from `look` to a model.

use crate::support::Bench;
use leastaction_learning::data::{self, Dataset};
use mcap::records::MessageHeader;
use mcap::{WriteOptions, Writer};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::io::Cursor;

/// A message of one joint in CDR: stamp, frame, name, and position and effort if given.
fn message(stamp: u64, position: Option<f64>, effort: Option<f64>) -> Vec<u8> {
    let mut bytes = vec![0, 1, 0, 0];
    bytes.extend(((stamp / 1_000_000_000) as u32).to_le_bytes());
    bytes.extend(((stamp % 1_000_000_000) as u32).to_le_bytes());
    bytes.extend([1, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 4, 0, 0, 0, b'a', b'r', b'm', 0]);
    for field in [position, None, effort] {
        bytes.extend(u32::from(field.is_some()).to_le_bytes());
        if let Some(value) = field {
            bytes.resize((bytes.len() - 4).next_multiple_of(8) + 4, 0);
            bytes.extend(value.to_le_bytes());
        }
    }
    bytes
}

/// The pendulum's log.
fn pendulum(bench: &Bench) -> Dataset {
    bench.run("generate pendulum -o data.npz --trajectories 4 --samples 60 --control held").good();
    data::read(bench.at("data.npz")).unwrap().0
}

/// A bag of each trajectory: states, and commands 4 µs before them.
fn bags(bench: &Bench, log: &Dataset) {
    for (k, trajectory) in log.trajectories.iter().enumerate() {
        let options = WriteOptions::new().compression(None).profile("ros2");
        let mut writer = Writer::with_options(Cursor::new(Vec::new()), options).unwrap();
        let schema = writer.add_schema("sensor_msgs/msg/JointState", "ros2msg", b"").unwrap();
        let channels = ["/commands", "/joint_states"]
            .map(|topic| writer.add_channel(schema, topic, "cdr", &BTreeMap::new()).unwrap());
        let mut send = |channel_id, stamp: u64, message: Vec<u8>| {
            let header = MessageHeader { channel_id, sequence: 0, log_time: stamp, publish_time: stamp };
            writer.write_to_known_channel(&header, &message).unwrap();
        };
        for (j, t) in log.times(trajectory).enumerate() {
            let now = 1_790_000_000_000_000_000 + (1e9 * t).round() as u64;
            let effort = trajectory.u.as_ref().unwrap()[j][0];
            send(channels[0], now - 4_000, message(now - 4_000, None, Some(effort)));
            send(channels[1], now, message(now, Some(trajectory.q[j][0]), None));
        }
        writer.finish().unwrap();
        std::fs::write(bench.at(&format!("run-{k}.mcap")), writer.into_inner().into_inner()).unwrap();
    }
}

#[test]
fn a_bag_is_looked_at_and_learned_from() {
    let bench = Bench::new();
    let log = pendulum(&bench);
    bags(&bench, &log);
    let done = bench.run("look run-*.mcap -o robot.toml --json").good();
    let report = done.json();
    assert_eq!(
        (&report["files"][0]["topic"], &report["files"][1]["topic"]),
        (&"/commands".into(), &"/joint_states".into())
    );
    let rate = report["files"][1]["rate"].as_f64().unwrap();
    assert!((rate * log.h - 1.0).abs() < 1e-3, "{rate}");
    let text = bench.text("robot.toml");
    assert!(text.contains("q = [\"/joint_states/arm/position\"]\nu = [\"/commands/arm/effort\"]"), "{text}");
    assert!(text.contains("validation = 0.2") && !text.contains("\nt = "), "{text}");
    let trained = bench.run("train robot.toml -o run -q --json");
    assert!(trained.code == Some(0), "{}", trained.stderr);
    let shown = bench.run("look run-0.mcap").good();
    assert!(shown.stdout.contains("run-0.mcap /joint_states"), "{}", shown.stdout);
    let mut cut = std::fs::read(bench.at("run-3.mcap")).unwrap();
    cut.truncate(cut.len() / 2);
    std::fs::write(bench.at("run-3.mcap"), cut).unwrap();
    bench.run("train robot.toml -o other -q").bad(2, &["run-3.mcap, message ", "mcap recover"]);
}

/// Angles and torques of a recording in two files, the latter at another rate; half a second of one run is left out.
#[test]
fn files_of_a_recording_are_joined_and_cut() {
    let bench = Bench::new();
    let log = pendulum(&bench);
    for (k, trajectory) in log.trajectories.iter().enumerate() {
        let (mut angles, mut torques) = ("t,q\n".to_owned(), "ms,tau\n".to_owned());
        for (j, t) in log.times(trajectory).enumerate() {
            writeln!(angles, "{t:?},{:?}", trajectory.q[j][0]).unwrap();
            let effort = trajectory.u.as_ref().unwrap()[j][0];
            for part in 0..4 {
                writeln!(torques, "{:?},{effort:?}", 1e3 * (t + 0.25 * log.h * f64::from(part))).unwrap();
            }
        }
        bench.write(&format!("angles-{k}.csv"), &angles);
        bench.write(&format!("torques-{k}.csv"), &torques);
    }
    bench.write(
        "c.toml",
        "[data]\nfile = \"angles-*.csv\"\nleave_out = [{ file = \"angles-1.csv\", from = 1.0, to = 1.5 }]\n\
         [data.columns]\nq = \"q\"\nu = \"torque:tau\"\n\
         [data.join]\ntorque = { replace = [\"angles\", \"torques\"], t = { name = \"ms\", unit = \"ms\" } }\n\
         [model]\ncoordinates = \"a\"\nhidden = [6]\n[training]\niterations = 3\n",
    );
    let done = bench.run("train c.toml -o run -q").good();
    assert!(done.stderr.contains("angles-1.csv: left out "), "{}", done.stderr);
    bench.run("export run -o m.postcard").good();
    let judged = |log: &str| bench.run(&format!("evaluate m.postcard {log} --json")).good().json();
    let (joined, exact) = (judged("--config run/config.toml --data angles-0.csv"), judged("--data data.npz"));
    assert_eq!((&joined["trajectories"], &exact["trajectories"]), (&1.into(), &4.into()));
    assert_eq!(judged("--config c.toml")["trajectories"], 5);
    let wrong =
        std::fs::read_to_string(bench.at("c.toml")).unwrap().replace("\"angles-1.csv\"", "\"angles-9.csv\"");
    bench.write("wrong.toml", &wrong);
    bench.run("train wrong.toml -o other -q").bad(2, &["angles-9.csv", "leave_out under [data] names it"]);
}
