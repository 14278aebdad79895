//! Robot descriptions with joints that the log does not have and bodies that cannot be: notes and errors.

use crate::support::Bench;
use leastaction_models::urdf::{Inertias, Options, parse, parse_with};
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
    let end =
        trained.stdout.split_once("\nfitted to the torques in ").map(|(_, rest)| rest).unwrap_or_default();
    let (seconds, rest) = end.split_once(" s: training loss ").unwrap_or_default();
    assert!(seconds.parse::<f64>().is_ok() && !rest.is_empty(), "{}", trained.stdout);
}

#[test]
fn points_and_limits_of_zero_are_noted() {
    let zeros = |from: &str, to: &str, text: &str| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    };
    let bench = bench(CONFIG);
    let text = zeros("velocity=\"9\" effort=\"300\"", "velocity=\"0\" effort=\"0\"", ROBOT);
    let text = zeros("ixx=\"0.03\" iyy=\"0.02\" izz=\"0.5\"", "ixx=\"0\" iyy=\"0\" izz=\"0\"", &text);
    let text = zeros("ixx=\"0.02\" iyy=\"0.02\" izz=\"0.01\"", "ixx=\"0\" iyy=\"0\" izz=\"0\"", &text);
    fs::write(bench.at("robot.urdf"), text).unwrap();
    let trained = bench.run("train robot.toml -o run").good();
    for words in [
        "limits of 0 (position, velocity or effort) are taken as not given: yaw, elbow, finger",
        "link upper, moved by joint yaw: it is infinitely thin in some direction, so it was thickened, which changes its moments of \
         inertia by 0.01 %",
    ] {
        assert!(trained.stderr.contains(words), "{words:?} is not in {}", trained.stderr);
    }
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

/// The description with bodies that can be, and without the finger that follows.
fn plain() -> String {
    ROBOT.replace("izz=\"0.5\"", "izz=\"0.01\"").replace("<mimic joint=\"elbow\" multiplier=\"0.01\"/>", "")
}

#[test]
fn what_was_identified_is_written_into_descriptions() {
    let config = CONFIG.replace("[model]\n", "[model]\nfriction = \"learned\"\n");
    let bench = bench(&config);
    fs::write(bench.at("robot.urdf"), plain()).unwrap();
    bench.run("train robot.toml -o run").good();
    let exported = bench.run("export run -o a.postcard --urdf found.urdf --mjcf found.xml").good();
    assert!(
        exported.stdout.contains("found.urdf: ") && exported.stdout.contains("written anew"),
        "{}",
        exported.stdout
    );
    assert!(exported.stderr.contains("URDF has no inertia of a joint's rotor"), "{}", exported.stderr);
    assert!(exported.stderr.contains("no place in a description"), "{}", exported.stderr);
    let [urdf, mjcf] = ["found.urdf", "found.xml"].map(|file| fs::read_to_string(bench.at(file)).unwrap());
    assert!(urdf.contains("<dynamics damping=") && mjcf.contains(" frictionloss="), "{urdf}\n{mjcf}");
    let joints = Some(vec!["yaw".to_owned()]);
    let options = Options { joints, lock: [("elbow".to_owned(), 0.5)].into(), ..Options::default() };
    let held = parse_with(&urdf, &options).unwrap().tree;
    let alone = parse(&mjcf, Inertias::Required).unwrap();
    let with_rotor = |q: f64| held.inverse_dynamics(&[q], &[0.3], &[0.9])[0] + alone.rotors[0] * 0.9;
    for q in [-1.0, 0.2, 2.0] {
        let [found, expected] = [alone.inverse_dynamics(&[q], &[0.3], &[0.9])[0], with_rotor(q)];
        assert!((found - expected).abs() < 1e-11 * expected.abs().max(1.0), "{found} {expected}");
    }
    // The log is that of the description with another inertia, so the description's own torques differ.
    let described = parse_with(&plain(), &options).unwrap().tree.mass_matrix(&[0.2])[0][0];
    assert!((alone.mass_matrix(&[0.2])[0][0] - described).abs() > 1e-2 * described);
    bench.run("export run -o a.postcard --urdf found.urdf --mjcf found.xml").good();
    bench.run("export run -o a.postcard --urdf robot.urdf").bad(2, &["robot.urdf", "would be lost"]);
    bench.run("export run -o a.postcard --urdf a.postcard").bad(2, &["name the same file"]);
    fs::write(bench.at("notes.xml"), "<notes/>").unwrap();
    bench.run("export run -o a.postcard --mjcf notes.xml").bad(2, &["notes.xml", "would be lost"]);
    fs::remove_file(bench.at("robot.urdf")).unwrap();
    bench.run("export run -o a.postcard --urdf found.urdf").bad(2, &["robot.urdf"]);
}

const CONFIG_OF_PENDULUM: &str =
    "[data]\nfile = \"log.csv\"\n[model]\ncoordinates = \"a\"\nhidden = [4]\n[training]\niterations = 2\n";

#[test]
fn a_run_without_a_description_has_none_to_write() {
    let bench = Bench::new();
    bench.run("generate pendulum -o log.csv --seed 1").good();
    fs::write(bench.at("train.toml"), CONFIG_OF_PENDULUM).unwrap();
    bench.run("train train.toml -o run --accept-poor").good();
    bench.run("export run -o a.postcard --urdf a.urdf").bad(2, &["not learned from a robot description"]);
}

#[test]
fn a_model_of_mujoco_is_a_description() {
    let body = "<inertial pos=\"0 0.1 0.2\" mass=\"2\" diaginertia=\"0.03 0.02 0.015\"/>";
    let robot = format!(
        "<mujoco><option gravity=\"0 0 -9.7\"/><worldbody><body name=\"upper\" pos=\"0 0 0.3\">{body}\
         <joint name=\"yaw\" axis=\"0 0.6 0.8\" range=\"-170 170\" armature=\"0.2\" actuatorfrcrange=\"-9 9\"/>\
         </body></worldbody></mujoco>"
    );
    let bench = bench(&CONFIG.replace("robot.urdf", "robot.xml").replace("lock = { elbow = 0.5 }\n", ""));
    fs::write(bench.at("robot.xml"), &robot).unwrap();
    bench.run("train robot.toml -o run").good();
    bench.run("export run -o a.postcard --mjcf found.xml").good();
    let shown = bench.run("inspect a.postcard").good().stdout;
    assert!(shown.contains("-9.7"), "{shown}");
    let found = fs::read_to_string(bench.at("found.xml")).unwrap();
    assert!(found.contains("actuatorfrcrange=\"-9 9\"") && !found.contains("armature=\"0.2\""), "{found}");
    bench.run("excite robot.xml -o e.csv --velocity 2 --starts 1 --trials 2 --period 5 --h 0.01").good();
}
