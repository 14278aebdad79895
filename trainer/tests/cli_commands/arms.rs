//! Arms: from a robot description and a log of torques to a model that follows a motion in the loop.

use crate::support::Bench;
use leastaction_models::urdf::{Inertias, parse};
use std::fmt::Write;
use std::fs;

const ROBOT: &str = r#"<robot name="r"><link name="base"/>
<link name="upper"><inertial><origin xyz="0 0 0.2"/><mass value="MASS"/>
<inertia ixx="0.03" iyy="0.03" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="lower"><inertial><origin xyz="0 0 0.15"/><mass value="1.5"/>
<inertia ixx="0.02" iyy="0.02" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="yaw" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0 0 0.3" rpy="0.4 0 0"/><axis xyz="0 0.6 0.8"/>
<limit lower="-3" upper="3" velocity="9" effort="90"/></joint>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0 0 0.4"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" velocity="9" effort="90"/></joint></robot>"#;

const CONFIG: &str = "[data]\nfile = \"log.csv\"\ncontrol = \"linear\"\nvalidation = 0\n[model]\nfamily = \"arm\"\nurdf = \"robot.urdf\"\n\
                      friction = \"learned\"\n";

/// A rich motion, and the torques of a robot whose first link is heavier than described.
fn log() -> String {
    let tree = parse(&ROBOT.replace("MASS", "3.0"), Inertias::Required).unwrap();
    let mut text = "t,q0,q1,v0,v1,u0,u1\n".to_owned();
    for k in 0..600 {
        let t = 0.01 * f64::from(k);
        let (mut q, mut v, mut a) = ([0.0; 2], [0.0; 2], [0.0; 2]);
        for (i, w) in [2.3, 3.1].into_iter().enumerate() {
            for (w, size) in [(w, 0.6), (1.9 * w, 0.3)] {
                let (sine, cosine) = (w * t + i as f64).sin_cos();
                q[i] += size * sine;
                v[i] += size * w * cosine;
                a[i] -= size * w * w * sine;
            }
        }
        let bodies = tree.inverse_dynamics(&q, &v, &a);
        let torque = |i: usize| bodies[i] + 0.2 * v[i] + 0.3 * (v[i] / 0.1).tanh() + 0.05 * a[i];
        let _ = writeln!(text, "{t},{},{},{},{},{},{}", q[0], q[1], v[0], v[1], torque(0), torque(1));
    }
    text
}

/// Speeds up to 2 rad/s.
const MOTION: &str = "frequency = 0.25\ncentre = [0.2, 0.5]\ncosine = [[0.5, 0.2], [0.3]]\nsine = [[], [-0.6, 0.1]]\nlimit = [60.0, 60.0]\n";

fn trained() -> Bench {
    let bench = Bench::new();
    let files = [
        ("robot.urdf", ROBOT.replace("MASS", "2.0")),
        ("log.csv", log()),
        ("robot.toml", CONFIG.to_owned()),
        ("motion.toml", MOTION.to_owned()),
    ];
    files.iter().for_each(|(name, text)| fs::write(bench.at(name), text).unwrap());
    let trained = bench.run("train robot.toml -o run").good();
    assert!(trained.stderr.contains("fitted to the torques of"), "{}", trained.stderr);
    assert!(trained.stdout.contains("torques: squared error over variance"), "{}", trained.stdout);
    bench.run("export run -o m.postcard").good();
    bench
}

/// With a description `look` proposes an arm that trains as it stands, and says if it has other joints than the log.
#[test]
fn look_takes_a_description() {
    let bench = trained();
    let text = fs::read_to_string(bench.at("log.csv")).unwrap();
    fs::write(
        bench.at("named.csv"),
        text.replacen("t,q0,q1,v0,v1,u0,u1", "time,pos1,pos2,vel1,vel2,tau1,tau2", 1),
    )
    .unwrap();
    let looked = bench.run("look named.csv --urdf robot.urdf -o look.toml").good();
    assert!(!looked.stderr.contains("will refuse"), "{}", looked.stderr);
    let done = bench.run("train look.toml -o described").good();
    let count =
        done.stderr.split_once("fitted to the torques of ").and_then(|(_, rest)| rest.split_once(" samples"));
    let (count, _) = count.unwrap();
    assert!(done.stdout.contains(&format!("{count} + 0 samples")), "{}", done.stdout);
    fs::write(bench.at("one.csv"), text.replacen("t,q0,q1,v0,v1,u0,u1", "time,pos1,a,b,c,tau1,d", 1))
        .unwrap();
    let looked = bench.run("look one.csv --urdf robot.urdf -o one.toml").good();
    assert!(looked.stderr.contains("training will refuse"), "{}", looked.stderr);
    let looked = bench.run("look one.csv --urdf none.urdf -o one.toml").good();
    assert!(looked.stderr.contains("none.urdf"), "{}", looked.stderr);
}

#[test]
fn an_arm_is_trained_evaluated_and_follows_a_motion_better_than_pd() {
    let bench = trained();
    let report = bench.run("evaluate m.postcard --config robot.toml --json").good().json();
    assert!(report["torque_nmse"].as_f64().unwrap() < 1e-3, "{report}");
    // The log alone shows the true friction, and every base parameter with its error.
    let numbers = report["torque_numbers"].as_array().unwrap();
    let viscous = numbers.iter().find(|of| of["name"] == "coordinate 0: viscous friction").unwrap();
    let (value, error) = (viscous["by_log"].as_f64().unwrap(), viscous["standard_error"].as_f64().unwrap());
    assert!((value - 0.2).abs() < 0.01 && error < 0.01, "{viscous}");
    assert!(numbers.iter().any(|of| of["plus"].as_array().is_some_and(|plus| !plus.is_empty())), "{report}");
    let page = fs::read_to_string(bench.at("run/report.html")).unwrap();
    assert!(page.contains("by this log alone") && page.contains("in the model"));
    assert!(bench.run("inspect m.postcard").good().stdout.contains("revolute on body 0"));
    // The model follows a motion that was found for its description.
    let excite =
        "excite robot.urdf -o found.csv --motion found.toml --starts 2 --trials 4 --period 5 --h 0.01";
    let found = bench.run(&format!("{excite} --json")).good().json();
    assert!(found["condition"].as_f64().unwrap() < found["condition_before"].as_f64().unwrap(), "{found}");
    let text = fs::read_to_string(bench.at("found.csv")).unwrap();
    assert!(text.contains("q0,q1,v0,v1") && text.lines().count() > 500, "{}", &text[..100]);
    bench.run(excite).good();
    assert_eq!(text, fs::read_to_string(bench.at("found.csv")).unwrap());
    let follow = "simulate m.postcard --scenario track --plant m.postcard --trajectory found.toml --seconds 1 --known-delay 1";
    bench.run(follow).good();
    // The motion as a log; its single period begins and ends at rest.
    let from_log = format!("{} --limit 60 --json", follow.replace("found.toml --seconds 1", "found.csv"));
    let report = bench.run(&from_log).good().json();
    assert_eq!(report["ticks"], 5100, "{report}");
    let both = [follow.to_owned() + " --json", from_log + " --seconds 1"];
    let [series, log] = both.map(|words| bench.run(&words).good().json()["rms_error"][1].as_f64().unwrap());
    assert!((series - log).abs() < 1e-4, "{series} {log}");
    let words = "simulate m.postcard --scenario track --plant m.postcard --trajectory motion.toml --seconds 4 --known-delay 1 \
                 --bandwidth 30 --json -o out";
    let rms = |words: &str| {
        let report = bench.run(words).good().json();
        let all = report["rms_error"].as_array().unwrap();
        let squares: f64 = all.iter().map(|x| x.as_f64().unwrap().powi(2)).sum();
        (squares.sqrt(), report["trace_hash"].clone())
    };
    let ours = rms(words);
    assert_eq!(ours, rms(words));
    let (pd, _) = rms(&words.replace("--seconds", "--law pd-gravity --seconds"));
    assert!(ours.0 < pd / 3.0, "{ours:?} {pd}");
}

#[test]
fn columns_of_other_joints_are_refused_and_a_worthless_fit_fails() {
    let bench = Bench::new();
    let named = log().replacen("t,q0,q1,v0,v1,u0,u1", "t,yaw/pos,elbow/pos,v0,v1,yaw/torque,elbow/torque", 1);
    fs::write(bench.at("log.csv"), named).unwrap();
    fs::write(bench.at("robot.urdf"), ROBOT.replace("MASS", "2.0")).unwrap();
    let with = |q: &str, v: &str, u: &str| {
        let columns = format!("[data.columns]\nt = \"t\"\nq = [{q}]\nv = [{v}]\nu = [{u}]\n");
        CONFIG.replacen("[model]", &(columns + "[model]"), 1)
    };
    let train = |name: &str, text: String, words: &str| {
        fs::write(bench.at(name), text).unwrap();
        bench.run(&format!("train {name} -o run-{name} {words}"))
    };
    let (q, swapped) = ("\"yaw/pos\", \"elbow/pos\"", "\"elbow/pos\", \"yaw/pos\"");
    let u = "\"yaw/torque\", \"elbow/torque\"";
    train("good.toml", with(q, "\"v0\", \"v1\"", u), "").good();
    let right = ["good.toml:7", "elbow/pos", "write q = [\"yaw/pos\", \"elbow/pos\"]"];
    train("swapped.toml", with(swapped, "\"v1\", \"v0\"", u), "")
        .bad(2, &[&right[0].replace("good", "swapped"), right[1], right[2]]);
    // A reversed sign has no name.
    let reversed = u.replace("\"yaw/torque\"", "{ name = \"yaw/torque\", sign = -1 }");
    let reversed = reversed.replace("\"elbow/torque\"", "{ name = \"elbow/torque\", sign = -1 }");
    let reversed = with(q, "\"v0\", \"v1\"", &reversed);
    let known = reversed.replace("friction = \"learned\"", "bodies = \"known\"\nrotors = \"known\"");
    let poor = train("poor.toml", known.clone(), "");
    let says = |text: &str| poor.stderr.contains(text);
    assert!(
        poor.code == Some(1) && says("worse than by their mean") && says("--accept-poor"),
        "{}",
        poor.stderr
    );
    assert!(poor.stdout.contains("torques: squared error over variance"), "{}", poor.stdout);
    let accepted = train("accepted.toml", known, "--accept-poor").good();
    assert!(accepted.stderr.contains("warning: the torques of the training data"), "{}", accepted.stderr);
}

#[test]
#[ignore = "a quarter of a minute"]
fn the_arm_of_the_demo_follows_its_motion_better_than_pd() {
    let bench = Bench::new();
    let report = bench.run("demo arm -q --out demo --json").good().json();
    assert!(report["torque_nmse"].as_f64().unwrap() < 0.01, "{report}");
    let errors = |law: &str| report[law]["rms_error"].as_array().unwrap().clone();
    for (ours, pd) in errors("computed_torque").iter().zip(errors("pd_gravity")) {
        assert!(ours.as_f64().unwrap() < pd.as_f64().unwrap(), "{report}");
    }
    // Torques depend on one base parameter only by rounding.
    let numbers = bench.run("evaluate demo/run --data demo/unseen.npz --json").good().json();
    let numbers = numbers["torque_numbers"].as_array().unwrap().clone();
    let shown: Vec<f64> = numbers.iter().filter_map(|number| number["by_log"].as_f64()).collect();
    assert!(shown.len() == numbers.len() - 1 && shown.iter().all(|x| x.abs() < 100.0), "{numbers:?}");
}

#[test]
fn what_cannot_excite_is_said() {
    let bench = Bench::new();
    let endless = ROBOT.replace("MASS", "2.0").replacen("\"revolute\"", "\"continuous\"", 1);
    let nameless = endless.replace("velocity=\"9\" effort=\"90\"", "");
    for (name, text) in
        [("robot.urdf", endless), ("nameless.urdf", nameless), ("notes.csv", "my notes".to_owned())]
    {
        fs::write(bench.at(name), text).unwrap();
    }
    bench.run("excite robot.urdf -o e.csv").bad(2, &["joint yaw", "--position"]);
    bench.run("excite nameless.urdf -o e.csv --position 2").bad(2, &["nameless.urdf", "velocity"]);
    bench.run("excite robot.urdf -o notes.csv --position 2").bad(2, &["notes.csv", "would be lost"]);
    bench
        .run("excite robot.urdf -o e.csv --motion robot.urdf --position 2")
        .bad(2, &["motion of `leastaction excite`"]);
    bench.run("excite robot.urdf -o e.csv --position 2 --share 1.5").bad(2, &["(0, 1]"]);
    bench.run("excite robot.urdf -o e.csv --position 2 --period 1e9").bad(2, &["rows"]);
    bench.run("excite nowhere.urdf -o e.csv").bad(2, &["nowhere.urdf"]);
    assert!(!bench.at("e.csv").exists());
}

#[test]
fn what_cannot_be_followed_is_said() {
    let bench = trained();
    let words = "simulate m.postcard --scenario track --plant m.postcard";
    bench.run(words).bad(2, &["--trajectory"]);
    bench
        .run("simulate m.postcard --scenario predict --plant m.postcard --law pd-gravity")
        .bad(2, &["--scenario track"]);
    let on_board = format!("{words} --trajectory motion.toml --on cortex-m4 --image nowhere.elf");
    bench.run(&on_board).bad(1, &["nowhere.elf", "run.sh --build"]);
    for (found, other, message) in [
        ("centre = [0.2, 0.5]", "centre = [0.2]", "centre has 1 entries"),
        ("cosine = [[0.5, 0.2]", "cosine = [[1, 1, 1, 1, 1, 1]", "at most 5"),
        ("frequency = 0.25", "frequency = -1", "finite and positive"),
        ("frequency = 0.25", "frequency = nan", "must be finite"),
        ("limit = [60.0, 60.0]", "limit = [60.0, -1.0]", "not negative"),
        ("limit", "limits", "limits"),
        ("sine = [[]", "sine = [[inf]", "finite"),
    ] {
        fs::write(bench.at("wrong.toml"), MOTION.replacen(found, other, 1)).unwrap();
        bench.run(&format!("{words} --trajectory wrong.toml")).bad(2, &[message]);
    }
    fs::write(bench.at("wrong.toml"), "frequency = [").unwrap();
    bench.run(&format!("{words} --trajectory wrong.toml")).bad(2, &["wrong.toml"]);
    bench.run(&format!("{words} --trajectory nowhere.toml")).bad(1, &["nowhere.toml"]);
}

#[test]
fn a_logged_motion_that_cannot_be_followed_is_said() {
    let bench = trained();
    let words = "simulate m.postcard --scenario track --plant m.postcard --trajectory m.csv --seconds 0.2";
    let rows = |row: fn(i32) -> String| (0..20).map(row).collect::<String>();
    let name = |file: &str| file.to_owned();
    let whole = rows(|k| format!("{},{},0.5\n", 0.1 * f64::from(k), 0.01 * f64::from(k)));
    for (text, message) in [
        (name("t,q0\n") + &rows(|k| format!("{k},0.1\n")), "1 coordinates, the model 2"),
        (name("t,q0,q1\n") + &rows(|k| format!("{},0.1,0.5\n", -k)), "m.csv"),
        (
            name("t,q0,q1\n") + &rows(|k| format!("{},0.1,0.5\n", k + 30 * (k / 10))),
            "2 motions, or one with gaps",
        ),
        (whole.replace("0.05,", "nan,"), "m.csv"),
        (name("t,q0,q1\n0,0.1,0.5\n1,0.1,0.5\n"), "m.csv"),
        (name("time,a,b\n") + &whole, "m.csv"),
    ] {
        fs::write(bench.at("m.csv"), &text).unwrap();
        bench.run(words).bad(2, &["m.csv", message]);
    }
    bench.run(&words.replace("m.csv", "nowhere.csv")).bad(2, &["nowhere.csv"]);
    bench.run(&format!("{words} --config nowhere.toml")).bad(2, &["nowhere.toml"]);
    bench.run(&words.replace("m.csv", "motion.toml --config robot.toml")).bad(2, &["--config"]);
    // Uneven stamps are resampled, and a note says so.
    fs::write(bench.at("m.csv"), name("t,q0,q1\n") + &rows(|k| format!("{},0.1,0.5\n", k + k % 2))).unwrap();
    assert!(bench.run(words).good().stderr.contains("resampled"));
    // The log has names and units of its own.
    fs::write(bench.at("m.csv"), name("time,a,b\n") + &whole).unwrap();
    let columns = "[data]\nfile = 'm.csv'\n[data.columns]\nt = 'time'\nq = ['a', 'b']\n";
    fs::write(
        bench.at("m.toml"),
        columns.to_owned() + "[model]\nfamily = 'inertia-network'\ncoordinates = 'aa'\n",
    )
    .unwrap();
    bench.run(&format!("{words} --config m.toml")).good();
}
