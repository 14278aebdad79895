//! Numbers of a model that follow a log: what the report says, and what its page shows.

use crate::changes::write_arm;
use crate::support::Bench;
use leastaction_core::adapt::StoredSettings;
use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_core::model::fingerprint;
use leastaction_core::network::Activation;
use leastaction_models::change::PointMass;
use leastaction_models::file::decode;
use leastaction_models::inertia_network::InertiaNetworkArchitecture;
use leastaction_models::urdf::{Inertias, parse};
use leastaction_models::{
    Architecture, CorrectionNetwork, Corrections, DissipationNetwork, GroupLaws, Model, Number,
};
use std::fmt::Write;
use std::fs;

/// A column that turns, and two links that swing on it.
const ROBOT: &str = r#"<robot name="r"><link name="base"/>
<link name="column"><inertial><origin xyz="0 0 0.2"/><mass value="3"/>
<inertia ixx="0.03" iyy="0.03" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="upper"><inertial><origin xyz="0.2 0 0"/><mass value="2"/>
<inertia ixx="0.01" iyy="0.03" izz="0.03" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="lower"><inertial><origin xyz="0.15 0 0"/><mass value="1"/>
<inertia ixx="0.01" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="yaw" type="revolute"><parent link="base"/><child link="column"/><axis xyz="0 0 1"/>
<limit lower="-3" upper="3" velocity="9" effort="90"/></joint>
<joint name="shoulder" type="revolute"><parent link="column"/><child link="upper"/><origin xyz="0 0 0.4"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" velocity="9" effort="90"/></joint>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0.5 0 0"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" velocity="9" effort="90"/></joint></robot>"#;

/// Step of the logs, s.
const H: f64 = 0.01;

/// Names the log on which the arm is right.
const CONFIG: &str =
    "[data]\nfile = \"right.csv\"\ncontrol = \"linear\"\n[model]\ncoordinates = \"aaa\"\nhidden = [4]\n";

/// Position, velocity and acceleration of a coordinate at a time.
type Motion = fn(usize, f64) -> [f64; 3];

/// Sum of three waves.
fn motion(i: usize, t: f64) -> [f64; 3] {
    let wave = |rate: f64| {
        let (sin, cos) = (rate * t + 1.3 * rate * i as f64).sin_cos();
        [sin / rate, cos, -rate * sin]
    };
    let [a, b, c] = [1.1, 2.3, 3.7].map(wave);
    [0, 1, 2].map(|k| 0.6 * (a[k] + b[k] + c[k]))
}

fn rest(_: usize, _: f64) -> [f64; 3] {
    [0.3, 0.0, 0.0]
}

/// Writes a log of some motion of a machine, with noise of its forces; `factor` of time turns the forces into others.
fn write_log(
    bench: &Bench,
    name: &str,
    machine: &Model,
    (motion, seconds): (Motion, f64),
    factor: fn(f64) -> f64,
) {
    let (n, count) = (machine.n(), (seconds / H) as usize);
    let states: Vec<[f64; 3]> = (0..count * n).map(|at| motion(at % n, (at / n) as f64 * H)).collect();
    let [q, v, a] = [0, 1, 2].map(|k| states.iter().map(|state| state[k]).collect::<Vec<f64>>());
    let u = machine.inverse_dynamics([&q, &v, &a]).unwrap();
    let mut random = 1_u64;
    let mut noise = || {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        0.1 * ((random >> 40) as f64 / f64::from(1 << 24) - 0.5)
    };
    let head = |name: &str| (0..n).map(|i| format!(",{name}{i}")).collect::<String>();
    let mut text = format!("t{}{}{}\n", head("q"), head("v"), head("u"));
    for k in 0..count {
        let _ = write!(text, "{}", k as f64 * H);
        let row = k * n..(k + 1) * n;
        let forces = u[row.clone()].iter().map(|u| u * factor(k as f64 * H) + noise());
        for x in q[row.clone()].iter().chain(&v[row]).copied().chain(forces) {
            let _ = write!(text, ",{x}");
        }
        text.push('\n');
    }
    fs::write(bench.at(name), text).unwrap();
}

fn arm(bench: &Bench) -> Model {
    decode(&bench.read("arm.postcard")).unwrap()
}

fn loaded(bench: &Bench) -> Model {
    let load = PointMass { body: None, mass: 2.0, place: Some([0.3, 0.05, 0.1]) };
    arm(bench).with_load(&load).unwrap()
}

/// An arm, a log on which it is right, and one with a load of 2 kg.
fn arms() -> Bench {
    let bench = Bench::new();
    write_arm(&bench, "arm.postcard", &parse(ROBOT, Inertias::Required).unwrap(), [0.5, 0.4]);
    write_log(&bench, "right.csv", &arm(&bench), (motion, 20.0), |_| 1.0);
    write_log(&bench, "load.csv", &loaded(&bench), (motion, 20.0), |_| 1.0);
    fs::write(bench.at("arm.toml"), CONFIG).unwrap();
    bench
}

#[test]
fn a_load_is_announced_and_its_page_shows_when() {
    let bench = arms();
    let words = "adapt arm.postcard --data load.csv --config arm.toml -o page.html --json";
    let report = bench.run(words).good().json();
    let number = |name: &str| report[name].as_f64().unwrap();
    let (mass, error) = (number("mass"), number("standard_error"));
    assert!((mass - 2.0).abs() < 4.0 * error && error < 0.05, "{mass} ± {error}");
    assert!(report["announced"].as_bool().unwrap() && number("seconds_to_announce") < 5.0, "{report}");
    assert!(number("nmse_after") < 0.1 * number("nmse_before"), "{report}");
    let first = &report["numbers"][0];
    assert_eq!((first["name"].as_str(), first["unit"].as_str()), (Some("m of body 2"), Some("kg")));
    assert!(first["prior"].as_f64().unwrap() > 10.0 * error, "{first}");
    let page = bench.text("page.html");
    let parts = [
        "arm.postcard along load.csv",
        "Mass attached to body 2 at the end of the log: ",
        "Announced after",
        "measured on the log that it learned from",
        "What is attached",
        "moments and products of inertia",
        "Friction, % of the model",
        "with the numbers in use",
        "Standard errors, as shares of what they were",
        "</html>",
    ];
    for part in parts {
        assert!(page.contains(part), "{part:?} is not on the page");
    }
    assert!(!page.contains("THE LOG") && !page.contains("NOT THE MACHINE"));
    assert_eq!(page.matches("<svg").count(), 5);
    // The numbers in use explain most of the balance that the model lacks.
    for i in 0..3 {
        let row = page.split(&format!("<b>q{i}</b>")).nth(1).unwrap();
        let cells: Vec<f64> =
            row.split("<td>").skip(1).take(2).map(|x| x[..x.find('<').unwrap()].parse().unwrap()).collect();
        assert!(cells[1] < 0.5 * cells[0], "{cells:?}");
    }
}

#[test]
fn without_the_log_of_the_training_the_uncertainty_comes_from_the_log_itself() {
    let bench = arms();
    let outcome = bench.run("adapt arm.postcard --data right.csv -o page.html").good();
    assert!(outcome.stderr.contains("taken from this log") && outcome.stderr.contains("page in page.html"));
    assert!(outcome.stdout.contains("nothing announced"), "{}", outcome.stdout);
    let page = bench.text("page.html");
    assert!(page.contains("Nothing was announced as attached.") && page.contains("taken from this log"));
}

/// A column that turns about a vertical axis shows its inertia about it, if it moves, and nothing else of its mass.
#[test]
fn what_is_not_excited_is_said() {
    let bench = arms();
    let words = "adapt arm.postcard --config arm.toml --body 0 -o page.html --data";
    let said = bench.run(&format!("{words} right.csv")).good().stdout;
    assert!(said.contains("nothing announced") && !said.contains("the log shows 0 "), "{said}");
    let page = bench.text("page.html");
    assert!(page.contains("THE LOG DOES NOT SHOW WHETHER SOMETHING IS ATTACHED"));
    assert!(!page.contains("THE LOG SHOWS NOTHING"));
    write_log(&bench, "rest.csv", &arm(&bench), (rest, 5.0), |_| 1.0);
    let said = bench.run(&format!("{words} rest.csv")).good().stdout;
    assert!(said.contains("the log shows 0 of 16 numbers"), "{said}");
    let page = bench.text("page.html");
    assert!(page.contains("THE LOG SHOWS NOTHING") && !page.contains("THE LOG DOES NOT SHOW WHETHER"));
}

#[test]
fn another_machine_is_not_taken_for_a_load() {
    let bench = arms();
    let turns = |t: f64| if (t / 0.7).fract() < 0.5 { 8.0 } else { -8.0 };
    write_log(&bench, "other.csv", &arm(&bench), (motion, 20.0), turns);
    let words = "adapt arm.postcard --data other.csv --config arm.toml -o page.html --json";
    let report = bench.run(words).good().json();
    assert!(
        report["unlike"].as_bool().unwrap() && report["changes"].as_array().unwrap().len() > 8,
        "{report}"
    );
    let page = bench.text("page.html");
    assert!(page.contains("NOT THE MACHINE THAT WAS LEARNED") && page.contains("times more."), "changed");
}

/// A network with friction has no bodies to which something may be attached.
#[test]
fn friction_alone_follows_and_is_shown() {
    let bench = Bench::new();
    let network = InertiaNetworkArchitecture::new(&[Coordinate::Translation, Coordinate::Angle], 4);
    let dry = [0.4, 0.0, 1.0, 0.05].map(Number::known);
    let group_laws = GroupLaws::of_friction([0.5, 0.3].map(Number::known).to_vec(), vec![dry; 2]);
    let architecture = Architecture { group_laws, ..network.into() };
    let weights = architecture.initial_weights(0);
    let cart = Model::new(architecture, weights);
    fs::write(bench.at("cart.postcard"), cart.to_bytes().unwrap()).unwrap();
    write_log(&bench, "worn.csv", &cart.with_friction(1.5).unwrap(), (motion, 20.0), |_| 1.0);
    let report = bench.run("adapt cart.postcard --data worn.csv -o page.html --json").good().json();
    assert!(report["mass"].is_null() && !report["announced"].as_bool().unwrap(), "{report}");
    let numbers = report["numbers"].as_array().unwrap();
    let labels: Vec<_> =
        numbers.iter().map(|of| [&of["name"], &of["unit"]].map(|x| x.as_str().unwrap())).collect();
    let expected = [
        ["b of coordinate 0", "N s/m"],
        ["b of coordinate 1", "N m s/rad"],
        ["c of coordinate 0", "N"],
        ["c of coordinate 1", "N m"],
    ];
    assert_eq!(labels, expected);
    for of in numbers {
        let [distance, model, error] =
            ["distance", "model", "standard_error"].map(|name| of[name].as_f64().unwrap());
        assert!((distance - 0.5 * model).abs() < 4.0 * error && distance > 0.3 * model, "{of}");
    }
    let page = bench.text("page.html");
    assert!(page.contains("Friction, % of the model") && !page.contains("What is attached"));
    write_log(&bench, "rest.csv", &cart, (rest, 5.0), |_| 1.0);
    let outcome = bench.run("adapt cart.postcard --data rest.csv -o page.html").good();
    assert!(outcome.stdout.contains("the log shows 0 of 4") && !outcome.stdout.contains("announced"));
    assert!(bench.text("page.html").contains("THE LOG SHOWS NOTHING"));
}

/// A cart-pole with a potential and a dissipation by networks; `stiffness` multiplies the output of the first.
fn cart_with_networks(stiffness: f64) -> Model {
    let network = |width| CorrectionNetwork {
        coordinates: "ta".to_owned(),
        widths: vec![width],
        activation: Activation::Tanh,
    };
    let dissipation = DissipationNetwork { network: network(3), scales: vec![2.0, 3.0] };
    let corrections = Corrections { dissipation: Some(dissipation), potential: Some(network(4)) };
    let energies = InertiaNetworkArchitecture::new(&[Coordinate::Translation, Coordinate::Angle], 4);
    let architecture = Architecture { corrections, ..energies.into() };
    let mut weights = architecture.initial_weights(0);
    let networks = weights.iter_mut().skip(architecture.corrections_start() + 2);
    networks.enumerate().for_each(|(k, weight)| *weight = (1.3 * k as f64).sin());
    weights.iter_mut().rev().take(1 + 4).for_each(|weight| *weight *= 3.0 * stiffness);
    Model::new(architecture, weights)
}

#[test]
fn networks_follow_and_are_shown() {
    let bench = Bench::new();
    fs::write(bench.at("cart.postcard"), cart_with_networks(1.0).to_bytes().unwrap()).unwrap();
    write_log(&bench, "stiff.csv", &cart_with_networks(1.2), (motion, 20.0), |_| 1.0);
    let words = "adapt cart.postcard --data stiff.csv";
    bench.run(words).bad(2, &["no number that can follow"]);
    let report =
        bench.run(&format!("{words} --networks -o page.html --patch cart.patch --json")).good().json();
    let numbers = report["numbers"].as_array().unwrap();
    let names: Vec<_> = numbers.iter().map(|of| of["name"].as_str().unwrap().to_owned()).collect();
    let units = (0..4).map(|j| format!("w of potential unit {j}"));
    let columns = (0..2).map(|j| format!("s of dissipation column {j}"));
    assert_eq!(names, units.chain(columns).collect::<Vec<_>>());
    let [before, after] = ["nmse_before", "nmse_after"].map(|name| report[name].as_f64().unwrap());
    assert!(after < 0.1 * before, "{after} of {before}");
    let page = bench.text("page.html");
    assert!(page.contains("Networks") && page.contains("last layer of its network"));
    let shown = bench.run("inspect cart.postcard --patch cart.patch").good().stdout;
    assert!(
        shown.contains("w of potential unit 3") && shown.contains("s of dissipation column 1"),
        "{shown}"
    );
    bench.run("convert cart.postcard --patch cart.patch -o stiff.postcard").good();
    let (cart, stiff) =
        (decode(&bench.read("cart.postcard")).unwrap(), decode(&bench.read("stiff.postcard")).unwrap());
    let changed = cart.weights.iter().zip(&stiff.weights).filter(|(before, after)| before != after).count();
    // Four weights of the potential, and the rows of the three entries of the dissipation's factor.
    assert_eq!(changed, 4 + 3 * (3 + 1));
    let arms = arms();
    arms.run("adapt arm.postcard --data load.csv --networks").bad(2, &["arm.postcard", "no network"]);
}

#[test]
fn pages_of_other_names_are_refused() {
    let bench = arms();
    let words = "adapt arm.postcard --data load.csv --config arm.toml";
    bench.run(&format!("{words} -o page.txt")).bad(2, &["page.txt", "name a page"]);
    fs::write(bench.at("mine.html"), "no page of this program").unwrap();
    bench.run(&format!("{words} -o mine.html")).bad(2, &["mine.html"]);
    bench.run(&format!("{words} --body 3")).bad(2, &["arm.postcard", "no body 3"]);
}

/// Patches are a few bytes, read beside their own model alone, and added to its numbers.
#[test]
fn a_patch_is_shown_and_added() {
    let bench = arms();
    let words = "adapt arm.postcard --data load.csv --config arm.toml --json";
    let report = bench.run(&format!("{words} --patch arm.patch")).good().json();
    let used = report["numbers"][0]["used"].as_f64().unwrap();
    assert!(bench.read("arm.patch").len() < 200);
    let shown = bench.run("inspect arm.postcard --patch arm.patch --json").good().json();
    let first = &shown["patch"]["numbers"][0];
    assert_eq!(first["name"], "m of body 2");
    assert_eq!([&first["model"], &first["distance"]].map(|x| x.as_f64().unwrap()), [1.0, used]);
    let text = bench.run("inspect arm.postcard --patch arm.patch").good().stdout;
    assert!(text.contains("patch of") && text.contains("c of coordinate 2"), "{text}");
    bench.run("convert arm.postcard --patch arm.patch -o loaded.postcard").good();
    let body = bench.run("inspect loaded.postcard --json").good().json()["bodies"][2].clone();
    assert!((body["mass"].as_f64().unwrap() - 1.0 - used).abs() < 1e-5, "{body}");
    let other = [
        "inspect loaded.postcard --patch arm.patch",
        "convert loaded.postcard --patch arm.patch -o x.postcard",
    ];
    for words in other {
        bench.run(words).bad(2, &["arm.patch", "saved for the model with fingerprint"]);
    }
    let mut damaged = bench.read("arm.patch");
    damaged[20] ^= 1;
    fs::write(bench.at("bad.patch"), damaged).unwrap();
    bench.run("inspect arm.postcard --patch bad.patch").bad(2, &["bad.patch", "damaged"]);
    bench.run("inspect arm.postcard --patch arm.postcard").bad(2, &["LAPT"]);
    bench.run(&format!("{words} --patch load.csv")).bad(2, &["load.csv", "no patch"]);
}

/// Settings for a controller are a file or Rust source; another file is not replaced.
#[test]
fn settings_for_a_controller_are_written() {
    let bench = arms();
    let words = "adapt arm.postcard --data load.csv --config arm.toml";
    bench.run(&format!("{words} --rust adapter.rs --tick 0.001")).good();
    let source = bench.text("adapter.rs");
    for part in ["const N: usize = 3;", "const P: usize = 16;", "const BLOCK: u16 = 8;", "h: 0.008,"] {
        assert!(source.contains(part), "{part:?} is not in {source}");
    }
    bench.run(&format!("{words} --rust adapter.rs --tick 0.002")).good();
    bench.run(&format!("{words} --settings arm.settings --tick 0.002")).good();
    let (model, settings) = (bench.read("arm.postcard"), bench.read("arm.settings"));
    let read = StoredSettings::<3, 16>::read(&settings, fingerprint(&model).unwrap()).unwrap();
    assert_eq!((read.block, read.settings.h, read.settings.numbers.len()), (4, 0.008, 16));
    bench.run(&format!("{words} --settings arm.settings --rust adapter.rs --tick 0.001")).good();
    bench.run(&format!("{words} --tick 0.002")).bad(2, &["--settings"]);
    bench.run(&format!("{words} --settings arm.settings")).bad(2, &["--tick"]);
    bench
        .run(&format!("{words} --settings adapter.rs --tick 0.002"))
        .bad(2, &["adapter.rs", "no file of settings"]);
    bench.run(&format!("{words} --rust adapter.rs")).bad(2, &["--tick"]);
    bench.run(&format!("{words} --rust load.csv --tick 0.002")).bad(2, &["load.csv"]);
}
