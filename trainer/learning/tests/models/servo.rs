//! Models whose commands are positions: configurations, their errors, the model file, and training from positions alone.

use super::arms::{description, write};
use leastaction_core::forces::ControlKind;
use leastaction_core::model::Law;
use leastaction_learning::config::{Config, ConfigError};
use leastaction_learning::data::{Dataset, Rows, Trajectory};
use leastaction_learning::run::{Notice, Plan, PlanError};
use leastaction_models::file::{decode, encode, rust_source};
use leastaction_models::{Beginning, Model, Number, Scales};
use std::path::Path;

const N: usize = 3;
/// Interval of the log, s, and the number of steps of the robot in it.
const H: f64 = 0.02;
const FINE: usize = 4;
const SAMPLES: usize = 300;
/// Stiffness and damping of the robot's servos, N m/rad or N/m, and N m s/rad or N s/m.
const STIFFNESS: [f64; N] = [25.0, 14.0, 90.0];
const DAMPING: [f64; N] = [2.5, 1.2, 9.0];

const NETWORK: &str = "coordinates = \"ta\"\n";

fn parse(model: &str) -> Result<Config, ConfigError> {
    Config::parse(&format!("[data]\nfile = \"a.npz\"\n[model]\n{model}"), Path::new("c.toml"))
}

fn arm(folder: &Path, model: &str) -> Config {
    write(folder, &description(2.6));
    let file = folder.join("c.toml");
    let head =
        "[data]\nfile = \"d.npz\"\nvalidation = 0.3\n[model]\nfamily = \"arm\"\nurdf = \"robot.urdf\"\n";
    std::fs::write(&file, format!("{head}{model}\n")).unwrap();
    Config::read(&file).unwrap()
}

#[test]
fn one_word_learns_stiffness_and_damping() {
    let (shape, weights) = parse(&format!("{NETWORK}servo = \"learned\"\n")).unwrap().beginning().unwrap();
    let follows = |start, part| Number { part: Some(part), ..Number::learned(start) };
    assert_eq!(shape.group_laws.servo, [follows(10.0, 1.0); 2]);
    assert_eq!(shape.group_laws.viscous, [follows(1.0, 0.3); 2]);
    assert_eq!(weights[weights.len() - 4..], [1.0, 1.0, 10.0, 10.0]);
    let both = parse(&format!("{NETWORK}servo = \"learned\"\nfriction = \"learned\"\n")).unwrap();
    assert_eq!(both.beginning().unwrap().0.group_laws.viscous, [follows(0.01, 0.02); 2], "friction says it");
    let (mut of_log, mut begins) = (shape.clone(), weights.clone());
    of_log.follow(&[Scales { speed: 2.0, force: 8.0, deflection: 0.1, ..Scales::default() }; 2], &mut begins);
    assert_eq!(begins[begins.len() - 4..], [0.3 * 4.0, 0.3 * 4.0, 80.0, 80.0]);
    let names = shape.number_names();
    let last = |k: usize| names[names.len() - k].clone().unwrap();
    assert_eq!((&*last(2).name, last(2).unit), ("coordinate 0: stiffness of the servo", "N/m"));
    assert_eq!((last(1).unit, last(4).unit), ("N m/rad", "N s/m"));
}

#[test]
fn what_is_written_is_read_again() {
    for servo in [
        "servo = \"learned\"\n",
        "servo = { stiffness = [17.0, { learn = 3.0 }] }\n",
        "dissipation = {}\nservo = { stiffness = 2.0, damping = [\"learned\", 0.5] }\nfriction = { coulomb = \"learned\" }\n",
    ] {
        let config = parse(&format!("{NETWORK}{servo}")).unwrap();
        let written = config.to_toml();
        assert_eq!(Config::parse(&written, Path::new("c.toml")).unwrap(), config, "{written}");
        let (shape, weights) = config.beginning().unwrap();
        let weights: Vec<f64> = weights.into_iter().map(|weight| f64::from(weight as f32)).collect();
        let model = decode(&encode(&shape, &weights, None, "test").unwrap()).unwrap();
        assert!(model.architecture.laws().contains(Law::Servo));
        let values = |numbers: &[Number]| numbers.iter().map(|number| number.value).collect::<Vec<_>>();
        assert_eq!(values(&model.architecture.group_laws.servo), values(&shape.group_laws.servo));
        let friction = shape.friction_of_coordinates(&weights);
        assert_eq!(model.architecture.friction_of_coordinates(&model.weights), friction);
        assert_eq!(model.architecture.parameters().unwrap(), weights.len());
    }
}

#[test]
fn errors_name_line_and_key() {
    let cases = [
        ("servo = \"stiff\"\n", "a table with stiffness and damping"),
        ("servo = { stiffness = -1.0 }\n", "0 or above"),
        ("servo = { stiffness = { learn = 0 } }\n", "above 0 where it is learned"),
        ("servo = { stiffness = [1.0, 2.0, 3.0] }\n", "one for each coordinate"),
        ("servo = { damping = 2.0 }\nfriction = \"learned\"\n", "given by `friction.viscous` too"),
        ("servo = { gain = 2.0 }\n", "gain"),
        ("servo = {}\nfriction = { load = \"learned\" }\n", "commands"),
    ];
    for (model, expected) in cases {
        let error = parse(&format!("{NETWORK}{model}")).unwrap_err().to_string();
        assert!(error.contains(expected), "{model}: {error}");
    }
}

/// Commands of a log: steps of a slow motion, held over an interval.
fn command(log: usize, k: usize, i: usize) -> f64 {
    let t = H * (k as f64);
    let wave = |w: f64, phase: f64| (w * t + phase + 1.3 * log as f64).sin();
    0.5 * wave(1.9 + 0.7 * i as f64, i as f64) + 0.3 * wave(5.1 - 0.9 * i as f64, 2.0 * i as f64)
}

/// Logs of the robot: positions and commands.
fn data(robot: &Model) -> Dataset {
    let logs = 0..3;
    let rows = |of: &dyn Fn(usize, usize) -> f64, count: usize| {
        Rows::from_flat(
            N,
            (0..count).flat_map(|k| (0..N).map(move |i| (k, i))).map(|(k, i)| of(k, i)).collect(),
        )
        .unwrap()
    };
    let trajectory = |log: usize, q: Rows, every: usize| Trajectory {
        id: log as i64,
        t0: 0.0,
        v: None,
        a: None,
        u: Some(rows(&|k, i| command(log, k / every, i), q.len())),
        q,
    };
    let dataset = |h: f64, trajectories| Dataset { n: N, h, control: Some(ControlKind::Held), trajectories };
    let start = |log: usize| trajectory(log, rows(&|_, _| 0.0, SAMPLES * FINE), FINE);
    let fine = dataset(H / FINE as f64, logs.clone().map(start).collect());
    let moved = robot.rollout(4, (&fine, Beginning::Positions)).unwrap();
    let coarse = |log: usize| {
        let q = moved[log].chunks(N * FINE).flat_map(|chunk| chunk[..N].to_vec()).collect();
        trajectory(log, Rows::from_flat(N, q).unwrap(), 1)
    };
    dataset(H, logs.map(coarse).collect())
}

fn robot(folder: &Path) -> Model {
    let servo = format!("servo = {{ stiffness = {STIFFNESS:?}, damping = {DAMPING:?} }}");
    let (architecture, weights) =
        arm(folder, &format!("bodies = \"known\"\nrotors = \"known\"\n{servo}")).beginning().unwrap();
    Model::new(architecture, weights)
}

#[test]
fn an_arm_of_known_bodies_is_learned_from_positions_alone() {
    let folder = tempfile::tempdir().unwrap();
    let data = data(&robot(folder.path()));
    let rest = "bodies = \"known\"\nrotors = \"known\"\nservo = \"learned\"\n[training]\nwindow = 0.4\niterations = 60";
    let plan = Plan::new(arm(folder.path(), rest), &data).unwrap();
    assert!(!plan.notices().contains(&Notice::UnknownScale));
    let trained = plan.train().unwrap();
    let (shape, weights) = (&trained.architecture, &trained.best.weights);
    let found = &weights[shape.corrections_place().end..];
    for (found, truth) in found.iter().zip(STIFFNESS) {
        assert!((found / truth - 1.0).abs() < 0.02, "stiffness {found} {truth}");
    }
    for (found, truth) in shape.friction_of_coordinates(weights).iter().zip(DAMPING) {
        assert!((found.viscous / truth - 1.0).abs() < 0.02, "damping {found:?} {truth}");
    }
    let file = encode(shape, weights, trained.trained_step, "test").unwrap();
    let source = rust_source(&file).unwrap();
    assert!(source.contains("(Viscous<f32, M>, Servo<f32, M>)"), "{source}");
}

/// Positions show masses, stiffnesses and friction up to a common factor: the same log with everything doubled.
#[test]
fn bodies_and_servos_cannot_both_be_unknown() {
    let folder = tempfile::tempdir().unwrap();
    let data = data(&robot(folder.path()));
    let plan = |rest: &str| Plan::new(arm(folder.path(), rest), &data).map(|_| ());
    assert_eq!(plan("servo = \"learned\""), Err(PlanError::ServoScale));
    assert_eq!(plan("servo = { stiffness = 20.0 }"), Ok(()));
    let torques = "bodies = \"known\"\nservo = \"learned\"\n[training]\nloss = \"torque\"";
    assert_eq!(plan(torques), Err(PlanError::ServoTorque));
}
