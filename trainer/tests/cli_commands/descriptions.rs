//! Robot descriptions with joints that the log does not have and bodies that cannot be: notes and errors.

use crate::support::Bench;
use leastaction_models::urdf::{Options, parse_with};
use std::fmt::Write;
use std::fs;

/// An elbow on a yaw, and a finger that follows the elbow; the upper link has a moment that is ten times too large.
const ROBOT: &str = r#"<robot name="r"><link name="base"/>
<link name="upper"><inertial><origin xyz="0 0.1 0.2"/><mass value="2"/>
<inertia ixx="0.03" iyy="0.02" izz="0.5" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="lower"><inertial><origin xyz="0 0.05 0.15"/><mass value="1.5"/>
<inertia ixx="0.02" iyy="0.02" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="tip"><inertial><origin xyz="0 0 0.02"/><mass value="0.1"/>
<inertia ixx="1e-5" iyy="1e-5" izz="1e-5" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="yaw" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0 0 0.3" rpy="0.4 0 0"/><axis xyz="0 0.6 0.8"/>
<limit lower="-3" upper="3" velocity="9" effort="300"/></joint>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0 0 0.4"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" velocity="9" effort="300"/></joint>
<joint name="finger" type="prismatic"><parent link="lower"/><child link="tip"/><axis xyz="1 0 0"/>
<limit lower="0" upper="0.04" velocity="9" effort="300"/><mimic joint="elbow" multiplier="0.01"/></joint></robot>"#;

const CONFIG: &str = "[data]\nfile = \"log.csv\"\ncontrol = \"linear\"\nvalidation = 0\n[model]\nfamily = \"arm\"\nurdf = \"robot.urdf\"\n\
     joints = [\"yaw\"]\nlock = { elbow = 0.5 }\n";

/// A motion of the yaw alone, and its torques.
fn log() -> String {
    let joints = Some(vec!["yaw".to_owned()]);
    let options = Options { joints, lock: [("elbow".to_owned(), 0.5)].into(), ..Options::default() };
    let tree = parse_with(ROBOT, &options).unwrap().tree;
    let mut text = "t,q0,v0,u0\n".to_owned();
    for k in 0..500 {
        let t = 0.01 * f64::from(k);
        let (mut q, mut v, mut a) = (0.0, 0.0, 0.0);
        for (w, size) in [(2.3, 0.6), (4.4, 0.3)] {
            let (sine, cosine) = f64::sin_cos(w * t);
            (q, v, a) = (q + size * sine, v + size * w * cosine, a - size * w * w * sine);
        }
        let torque = tree.inverse_dynamics(&[q], &[v], &[a])[0];
        let _ = writeln!(text, "{t},{q},{v},{torque}");
    }
    text
}

fn bench(config: &str) -> Bench {
    let bench = Bench::new();
    let files = [("robot.urdf", ROBOT), ("log.csv", &log()), ("robot.toml", config)];
    files.iter().for_each(|(name, text)| fs::write(bench.at(name), text).unwrap());
    bench
}

#[test]
fn training_notes_once_what_was_changed() {
    let trained = bench(CONFIG).run("train robot.toml -o run").good();
    let note = "note: link upper, moved by joint yaw: GROSSLY WRONG INERTIA";
    assert_eq!(trained.stderr.matches(note).count(), 1, "{}", trained.stderr);
    assert!(!trained.stderr.contains("finger"), "{}", trained.stderr);
    assert!(trained.stdout.contains("torques: squared error over variance"), "{}", trained.stdout);
}

#[test]
fn joints_that_the_log_lacks_are_named_with_the_keys() {
    let all = CONFIG.replace("joints = [\"yaw\"]\nlock = { elbow = 0.5 }\n", "");
    bench(&all).run("train robot.toml -o run").bad(2, &["yaw, elbow", "[model] joints"]);
    let finger = CONFIG.replace("\"yaw\"", "\"finger\"");
    bench(&finger).run("train robot.toml -o run").bad(2, &["robot.toml:8", "finger follows elbow (<mimic>)"]);
    let wrist = CONFIG.replace("elbow =", "wrist =");
    bench(&wrist).run("train robot.toml -o run").bad(2, &["robot.toml:9", "wrist", "yaw, elbow, finger"]);
}

#[test]
fn a_motion_is_found_for_some_joints() {
    let bench = bench(CONFIG);
    let excite = "excite robot.urdf -o found.csv --starts 1 --trials 4 --period 10 --h 0.01 --joints yaw --lock elbow=0.5";
    let found = bench.run(excite).good();
    assert!(found.stderr.contains("link upper"), "{}", found.stderr);
    let text = fs::read_to_string(bench.at("found.csv")).unwrap();
    assert!(text.contains("trajectory,t,q0,v0\n"), "{text:.60}");
    bench.run("excite robot.urdf -o e.csv --joints wrist").bad(2, &["wrist", "yaw, elbow, finger"]);
    bench.run("excite robot.urdf -o e.csv --lock elbow").bad(2, &["joint=0.5"]);
}
