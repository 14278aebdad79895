//! Mechanisms that take up a load, and whose friction grows, while they run.

use crate::support::Bench;
use leastaction_core::adapt::{Patch, StoredSettings};
use leastaction_core::energy::bodies::{BodyParameters, Joint, TreeBody};
use leastaction_core::model::{FrictionNumber, Interval};
use leastaction_models::file::decode;
use leastaction_models::tree::{Inertia, Tree};
use leastaction_models::urdf::{Inertias, parse};
use leastaction_models::{Architecture, ArmArchitecture, BodiesArchitecture, GroupLaws, Model, Number};
use serde_json::Value;
use std::fs;

const ROBOT: &str = r#"<robot name="r"><link name="base"/>
<link name="upper"><inertial><origin xyz="0 0 0.2"/><mass value="3"/>
<inertia ixx="0.03" iyy="0.03" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="lower"><inertial><origin xyz="0 0 0.15"/><mass value="1.5"/>
<inertia ixx="0.02" iyy="0.02" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="yaw" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0 0 0.3" rpy="0.4 0 0"/><axis xyz="0 0.6 0.8"/>
<limit lower="-3" upper="3" velocity="9" effort="90"/></joint>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0 0 0.4"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" velocity="9" effort="90"/></joint></robot>"#;

/// Position at which the arm floats.
const AT: [f64; 2] = [0.3, -0.9];

pub fn tree() -> Tree {
    parse(ROBOT, Inertias::Required).unwrap()
}

/// Writes the arm with damping b and dry friction c of every joint, of which 0.8 c grows with the load.
pub fn write_arm(bench: &Bench, name: &str, tree: &Tree, [b, c]: [f64; 2]) {
    let numbers = |all: &[f64]| all.iter().map(|x| Number::known(*x)).collect::<Vec<_>>();
    let dry: [Number; FrictionNumber::ALL.len()] = [c, 0.8 * c, 1.0, 0.05].map(Number::known);
    let arm = ArmArchitecture::new(tree, |_| false, |_| Number::known(0.1)).unwrap();
    let n = arm.bodies.len();
    let group_laws = GroupLaws::of_friction(numbers(&vec![b; n]), vec![dry; n]);
    let architecture = Architecture { group_laws, ..arm.into() };
    let weights = architecture.initial_weights(0);
    fs::write(bench.at(name), Model::new(architecture, weights).to_bytes().unwrap()).unwrap();
}

/// An arm without friction, and the words that let it float without drag and push.
fn arm() -> (Bench, String) {
    let bench = Bench::new();
    write_arm(&bench, "arm.postcard", &tree(), [0.0; 2]);
    let [first, second] = AT;
    let words = format!(
        "simulate arm.postcard --scenario gravity --at {first},{second} --limit 90 --push 0 --noise 0 --json -o out"
    );
    (bench, words)
}

/// Runs to an end at which the mechanism may still move.
fn run(bench: &Bench, words: &str) -> Value {
    let outcome = bench.run(words);
    assert!(matches!(outcome.code, Some(0 | 1)), "{}", outcome.stderr);
    outcome.json()
}

/// A column of the trace.
fn column(bench: &Bench, name: &str) -> Vec<f64> {
    let text = bench.text("out/trace.csv");
    let mut lines = text.lines();
    let place = lines.next().unwrap().split(',').position(|cell| cell == name).unwrap();
    lines.map(|line| line.split(',').nth(place).unwrap().parse().unwrap()).collect()
}

/// The load of 2 kg at (0.05, 0.1, 0.2) as part of the last body.
fn loaded() -> Tree {
    let (tree, load) = (tree(), Inertia::of_centre(2.0, [0.05, 0.1, 0.2].into(), [[0.0; 3]; 3].into()));
    let mut numbers = tree.parameters();
    let body = Inertia(*numbers[10..].first_chunk().unwrap()).with(&load);
    numbers[10..20].copy_from_slice(&body.0);
    tree.with_parameters(&numbers)
}

/// Held by the gravity of the arm alone, the arm with its load begins to sink with the acceleration M⁻¹(g − g₀).
#[test]
fn a_load_sinks_by_the_gravity_that_the_model_lacks() {
    let (bench, words) = arm();
    let words = format!("{words} --plant arm.postcard --drag 0 --seconds 0.6 --payload 2@0.5s@0.05,0.1,0.2");
    let report = run(&bench, &words);
    let carried = &report["carried"][0];
    assert_eq!(
        (carried["mass"].as_f64(), carried["since"].as_f64(), carried["body"].as_u64()),
        (Some(2.0), Some(0.5), Some(1))
    );
    let torque = |tree: &Tree, a: [f64; 2]| tree.inverse_dynamics(&AT, &[0.0; 2], &a);
    let (own, loaded) = (torque(&tree(), [0.0; 2]), loaded());
    let g = torque(&loaded, [0.0; 2]);
    let missing: [f64; 2] = std::array::from_fn(|i| own[i] - g[i]);
    // Columns of M, with rotors of 0.1 kg m².
    let [[a, b], [c, d]] = [[1.0, 0.0], [0.0, 1.0]].map(|unit| {
        let column = torque(&loaded, unit);
        [0, 1].map(|i| column[i] - g[i] + 0.1 * unit[i])
    });
    let [x, y] = missing.map(|force| force / (a * d - b * c));
    let expected = [d * x - c * y, a * y - b * x];
    let size = expected[0].hypot(expected[1]);
    for (i, expected) in expected.into_iter().enumerate() {
        let v = column(&bench, &format!("v{i}"));
        assert!(v[500].abs() < 1e-2 * size, "moves before: {}", v[500]);
        let found = (v[530] - v[500]) / 0.03;
        assert!((found - expected).abs() < 0.02 * size, "{found} instead of {expected}");
    }
    // Velocities are continuous, in a motion too.
    let words = words.replace("--payload 2@0.5s", "--payload 2@0.1s --payload 0@0.55");
    let report = run(&bench, &words);
    assert_eq!(report["carried"][1]["mass"].as_f64(), Some(0.0));
    let v = column(&bench, "v1");
    assert!(v[550].abs() > 0.5 && (v[551] - v[550]).abs() < 0.02 * v[550].abs(), "{} {}", v[550], v[551]);
}

#[test]
fn a_load_from_the_beginning_is_that_of_a_file_with_it() {
    let (bench, words) = arm();
    write_arm(&bench, "loaded.postcard", &loaded(), [0.0; 2]);
    let words = format!("{words} --seconds 0.5");
    let plain = run(&bench, &format!("{words} --plant arm.postcard"));
    assert!(plain.get("carried").is_none() && plain.get("friction_drift").is_none());
    let other = run(&bench, &format!("{words} --plant loaded.postcard"));
    let theirs = column(&bench, "q1");
    let report = run(&bench, &format!("{words} --plant arm.postcard --payload 2@0@0.05,0.1,0.2"));
    let ours = column(&bench, "q1");
    let way = theirs.last().unwrap() - AT[1];
    assert!(
        way.abs() > 0.05 && ours.iter().zip(&theirs).all(|(x, y)| (x - y).abs() < 1e-4 * way.abs()),
        "{way}"
    );
    assert_ne!((&report["trace_hash"], &other["trace_hash"]), (&plain["trace_hash"], &plain["trace_hash"]));
    // A load on the last body at its end: twice 0.15 m.
    run(&bench, &format!("{words} --plant arm.postcard --payload 2@0@0,0,0.3 --payload-body 1"));
    let named = column(&bench, "q1");
    let usual = run(&bench, &format!("{words} --plant arm.postcard --payload 2"));
    assert!((usual["carried"][0]["place"][2].as_f64().unwrap() - 0.3).abs() < 1e-6, "{usual}");
    assert!(column(&bench, "q1").iter().zip(&named).all(|(x, y)| (x - y).abs() < 1e-4 * way.abs()));
    for nothing in ["--payload 0@0.2s", "--payload 2@9s", "--payload -0.1@9s"] {
        let report = run(&bench, &format!("{words} --plant arm.postcard {nothing}"));
        assert_eq!(report["trace_hash"], plain["trace_hash"], "{nothing}");
    }
}

#[test]
fn friction_grows_to_that_of_a_file_with_more() {
    let (bench, words) = arm();
    write_arm(&bench, "dry.postcard", &tree(), [0.5, 0.25]);
    write_arm(&bench, "drier.postcard", &tree(), [1.0, 0.5]);
    let words = format!("{words} --seconds 0.5 --payload 3");
    let hash = |plant: &str| run(&bench, &format!("{words} --plant {plant}"))["trace_hash"].clone();
    let [dry, drier] = ["dry", "drier"].map(|name| hash(&format!("{name}.postcard")));
    assert_eq!(hash("dry.postcard --friction-drift 1@9s"), dry);
    let grown = run(&bench, &format!("{words} --plant dry.postcard --friction-drift 2@0.3s"));
    assert_eq!(
        (grown["friction_drift"]["factor"].as_f64(), grown["friction_drift"]["until"].as_f64()),
        (Some(2.0), Some(0.3))
    );
    assert!(grown["trace_hash"] != dry && grown["trace_hash"] != drier);
    assert_eq!(hash("dry.postcard --friction-drift 2@1e-4s"), drier);
    bench
        .run(&format!("{words} --plant dry.postcard --friction-drift 6@1s"))
        .bad(2, &["--friction-drift", "times the load"]);
}

/// A cart and a pole as bodies in the plane: the same as the exact mechanism, seen from behind.
fn write_cartpole(bench: &Bench) {
    use std::f64::consts::{FRAC_PI_2, PI};
    let known =
        |numbers: BodyParameters<f64>| BodyParameters::from_array(numbers.into_array().map(Number::known));
    let body = |angle: f64, mass: f64, centre: f64, inertia: f64| {
        known(BodyParameters {
            place: [0.0; 2],
            angle,
            mass,
            centre: [centre, 0.0],
            inertia,
            rotor: 0.0,
            gear: 1.0,
        })
    };
    let bodies = [
        (TreeBody { joint: Joint::Prismatic, parent: None }, body(PI, 1.0, 0.0, 1.0)),
        (TreeBody { joint: Joint::Revolute, parent: Some(0) }, body(-FRAC_PI_2, 0.1, 0.5, 0.1 / 12.0)),
    ];
    let architecture = BodiesArchitecture::new([0.0, -9.81].map(Number::known), bodies).unwrap();
    let architecture = Architecture::from(architecture);
    let weights = architecture.initial_weights(0);
    let mut model = Model::new(architecture, weights);
    model.facts.range = vec![
        leastaction_core::model::CoordinateRange {
            q: Interval { least: -1.0, most: 1.0 },
            v: Interval { least: -1.0, most: 1.0 },
            u: Interval { least: -15.0, most: 15.0 },
            period: 0.0,
        };
        2
    ];
    fs::write(bench.at("cart.postcard"), model.to_bytes().unwrap()).unwrap();
}

#[test]
fn exact_mechanisms_carry_the_loads_of_bodies() {
    let bench = Bench::new();
    write_cartpole(&bench);
    let words = "simulate cart.postcard --scenario gravity --at 0,1 --limit 15,2 --push 0 --noise 0 --seconds 0.8 --tick 0.01 --json -o out";
    let fall = |options: &str| {
        let report = run(&bench, &format!("{words} {options}"));
        (report, [column(&bench, "q0"), column(&bench, "q1")])
    };
    for load in ["--payload 0.2@0.4s", "--payload -0.02@0.4s"] {
        let (exact, by_waves) = fall(load);
        let (file, by_bodies) = fall(&format!("{load} --plant cart.postcard"));
        assert_eq!(exact["carried"], file["carried"], "{load}");
        let fallen = (by_waves[1].last().unwrap() - 1.0).abs();
        assert!(fallen > 0.1, "{load}: {fallen}");
        for (one, other) in by_waves.iter().zip(&by_bodies) {
            let differs = one.iter().zip(other).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
            assert!(differs < 1e-3 * fallen, "{load}: {differs} of {fallen}");
        }
    }
    let hash = |options: &str| fall(options).0["trace_hash"].clone();
    assert_eq!(
        hash("--viscous 0.25 --payload 0.2 --friction-drift 2@1e-3s"),
        hash("--viscous 0.5 --payload 0.2")
    );
    assert_eq!(
        hash("--coulomb 0.25 --payload 0.2 --friction-drift 1@5"),
        hash("--coulomb 0.25 --payload 0.2")
    );
    let text = bench.run(&format!(
        "{} --payload 0.2@0.4s --viscous 0.1 --friction-drift 2@9s",
        words.replace("--json", "")
    ));
    assert!(
        text.stdout.contains("0.2 kg from 0.4 s on, at (1.000, 0.000, 0.000) m of body 1"),
        "{}",
        text.stdout
    );
    assert!(text.stdout.contains("grows to 2 times at 9 s"), "{}", text.stdout);
}

#[test]
fn what_cannot_change_is_said() {
    let (bench, words) = arm();
    write_cartpole(&bench);
    let of_arm = |options: &str, said: &[&str]| {
        drop(bench.run(&format!("{words} --plant arm.postcard {options}")).bad(2, said));
    };
    of_arm("--payload 2@3s@1,2", &["three lengths"]);
    of_arm("--payload 2@-3", &["0 or above"]);
    of_arm("--payload 2@3@0,0,0@1", &["2.5@3s@0,0,0.1"]);
    of_arm("--payload two", &["finite number"]);
    of_arm("--payload 2 --payload 3@0s", &["twice from 0 s"]);
    of_arm("--payload 2 --payload-body 2", &["no body 2", "there are 2"]);
    of_arm("--payload-body 1", &["--payload"]);
    of_arm("--payload -1.4@1s", &["body 1", "loses too much"]);
    of_arm("--friction-drift 2", &["1.5@60s"]);
    of_arm("--friction-drift 2@0", &["above 0"]);
    of_arm("--friction-drift 2@5s", &["no friction that could grow"]);
    let of_cart = |options: &str, said: &[&str]| {
        drop(bench.run(&format!("simulate cart.postcard {options}")).bad(2, said));
    };
    of_cart("--scenario predict --payload 1", &["predict", "leave out --payload"]);
    of_cart("--scenario predict --plant cart.postcard --friction-drift 2@5s", &["predict"]);
    of_cart("--replay log.csv --payload 1", &["--replay", "leave out --payload"]);
    of_cart("--scenario track --friction-drift 2@5s", &["no friction that could grow"]);
    of_cart("--scenario track --payload 1@0@0.5,0.1,0", &["line of its body"]);
    of_cart(
        "--scenario gravity --plant cart.postcard --limit 9 --payload 1@0@0.5,0.1,0.2",
        &["plane of the bodies"],
    );
    of_cart("--scenario swing-up --payload -0.09", &["body 1", "loses too much"]);
    bench.run("generate pendulum -o data.npz --trajectories 2 --samples 10 --h 0.05").good();
    let config = "[data]\nfile = \"data.npz\"\n[model]\ncoordinates = \"a\"\nhidden = [2]\n[training]\niterations = 0\nwarm_up = 0\n";
    bench.write("c.toml", config);
    bench.run("train c.toml -o run -q --accept-poor");
    bench.model("run");
    bench
        .run("simulate run.postcard --scenario gravity --plant run.postcard --limit 9 --payload 1")
        .bad(2, &["inertia-network", "no bodies"]);
}

/// A motion of both joints.
pub const MOTION: &str = "frequency = 0.4
centre = [0.3, -0.9]
cosine = [[0.5, 0.2], [-0.6, 0.3]]
sine = [[0.3, -0.3], [0.4, 0.2]]
limit = [90, 90]
ramp = 1.0
";

/// Observer and controller run over the numbers that follow, and the report says what is attached: two joints hardly show the mass itself.
#[test]
fn the_firmware_carries_what_the_mechanism_took_up() {
    let bench = Bench::new();
    write_arm(&bench, "arm.postcard", &tree(), [0.5, 0.4]);
    fs::write(bench.at("motion.toml"), MOTION).unwrap();
    let words = "simulate arm.postcard --scenario track --plant arm.postcard --trajectory motion.toml --tick 0.002 --seconds 6 --json \
                 -o out --payload 2@3s@0.05,0.1,0.2";
    let (without, with) = (run(&bench, words), run(&bench, &format!("{words} --adapt")));
    assert!(without.get("adapted").is_none());
    let found = &with["adapted"];
    let (mass, error) = (found["mass"].as_f64().unwrap(), found["standard_error"].as_f64().unwrap());
    assert!((mass - 2.0).abs() < 4.0 * error, "{mass} kg, standard error {error} kg");
    assert_eq!(found["unlike"], false);
    let changes = found["changes"].as_array().unwrap();
    assert!(changes.iter().any(|t| (3.0..3.5).contains(&t.as_f64().unwrap())), "{changes:?}");
    let rms = |report: &Value| report["rms_error"][1].as_f64().unwrap();
    assert!(rms(&with) < 0.7 * rms(&without), "{} and {} rad", rms(&with), rms(&without));
    let again = run(&bench, &format!("{words} --adapt"));
    assert_eq!(again["trace_hash"], with["trace_hash"]);
    let patch = bench.read("out/adapter.patch");
    fs::copy(bench.at("out/adapter.settings"), bench.at("arm.settings")).unwrap();
    let known = run(&bench, &format!("{words} --settings arm.settings"));
    assert_eq!((&known["trace_hash"], bench.read("out/adapter.patch")), (&with["trace_hash"], patch));
    assert_eq!(known["adapted"]["settings"], "arm.settings");
    bench.run(&format!("{words} --settings arm.postcard")).bad(2, &["arm.postcard", "LATU"]);
    let slow = words.replace("--tick 0.002", "--tick 0.004");
    bench.run(&format!("{slow} --settings arm.settings")).bad(2, &["arm.settings", "0.002"]);
    bench.run(&format!("{words} --settings nowhere.settings")).bad(2, &["nowhere.settings"]);
    bench.run("inspect arm.postcard --patch out/adapter.patch").good();
}

/// A board knows its model by the bytes of the file, which another program may have written with other text.
#[test]
fn settings_and_patches_are_bound_to_the_bytes_of_the_file() {
    let bench = Bench::new();
    let models = concat!(env!("CARGO_MANIFEST_DIR"), "/../firmware-sim/chip/models");
    let file = fs::read(format!("{models}/arm.postcard")).unwrap();
    assert_ne!(decode(&file).unwrap().to_bytes().unwrap(), file, "these bytes are those of the command");
    let arm = format!("{models}/arm.postcard");
    run(
        &bench,
        &format!(
            "simulate {arm} --scenario track --plant {arm} --trajectory {models}/arm-motion.toml --seconds 0.9 --adapt --json -o out"
        ),
    );
    let fingerprint = leastaction_core::model::fingerprint(&file).unwrap();
    let settings = bench.read("out/adapter.settings");
    assert!(StoredSettings::<7, 24>::read(&settings, fingerprint).is_ok());
    assert!(Patch::<24>::read(&bench.read("out/adapter.patch"), fingerprint).is_ok());
    bench.run(&format!("inspect {arm} --patch out/adapter.patch")).good();
}

/// Along a log, numbers follow by settings as they do in a loop; the model that follows is not compared for drift.
#[test]
fn numbers_follow_along_a_log_by_settings() {
    let bench = Bench::new();
    write_arm(&bench, "arm.postcard", &tree(), [0.5, 0.4]);
    fs::write(bench.at("motion.toml"), MOTION).unwrap();
    let words = "simulate arm.postcard --scenario track --plant arm.postcard --trajectory motion.toml --tick 0.002 --seconds 6 --json \
                 -o out --payload 2@3s@0.05,0.1,0.2 --adapt";
    let live = run(&bench, words);
    let columns = "[data]\nfile = \"out/trace.csv\"\n[data.columns]\nt = \"time\"\nq = [\"measured0\", \"measured1\"]\n\
                   u = [\"commanded0\", \"commanded1\"]\n[model]\ncoordinates = \"aa\"\n";
    bench.write("c.toml", columns);
    let report = run(
        &bench,
        "simulate arm.postcard --replay out/trace.csv --config c.toml --settings out/adapter.settings --json -o along",
    );
    let mass = |report: &Value| report["adapted"]["mass"].as_f64().unwrap();
    assert!((mass(&report) - mass(&live)).abs() < 0.2, "{} and {} kg", mass(&report), mass(&live));
    assert!(report.get("drift").is_none_or(Value::is_null));
    assert!(bench.at("along/adapter.patch").is_file());
}

/// Without a load nothing is found; models without bodies are refused.
#[test]
fn the_firmware_finds_nothing_where_nothing_was_taken_up() {
    let bench = Bench::new();
    write_arm(&bench, "arm.postcard", &tree(), [0.5, 0.4]);
    fs::write(bench.at("motion.toml"), MOTION).unwrap();
    let words = "simulate arm.postcard --scenario track --plant arm.postcard --trajectory motion.toml --tick 0.002 --seconds 4 --json \
                 -o out --adapt";
    let found = run(&bench, words)["adapted"].clone();
    let (mass, error) = (found["mass"].as_f64().unwrap(), found["standard_error"].as_f64().unwrap());
    assert!(found["announced_at"].is_null() && mass.abs() < 4.0 * error, "{found}");
    bench.run(&format!("{words} --settings out/adapter.settings")).bad(2, &["--settings"]);
    bench
        .run("simulate arm.postcard --scenario predict --plant arm.postcard --adapt")
        .bad(2, &["predict", "--adapt"]);
    bench.run("generate pendulum -o data.npz --trajectories 2 --samples 10 --h 0.05").good();
    let config = "[data]\nfile = \"data.npz\"\n[model]\ncoordinates = \"a\"\nhidden = [2]\n[training]\niterations = 0\nwarm_up = 0\n";
    bench.write("c.toml", config);
    bench.run("train c.toml -o run -q --accept-poor");
    bench.model("run");
    bench
        .run("simulate run.postcard --scenario swing-up --adapt")
        .bad(2, &["--adapt", "neither bodies nor friction"]);
}
