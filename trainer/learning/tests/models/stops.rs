//! Models whose coordinates run against end stops: configurations, their errors, the model file, and training on a log with strikes.

use super::arms::{description, write};
use leastaction_core::forces::ControlKind;
use leastaction_core::model::Law;
use leastaction_learning::config::{Config, ConfigError};
use leastaction_learning::data::{Dataset, Rows, Trajectory};
use leastaction_learning::run::Plan;
use leastaction_models::file::{decode, encode};
use leastaction_models::{Beginning, Model};
use std::path::Path;

const NETWORK: &str = "coordinates = \"ta\"\n";

fn parse(model: &str) -> Result<Config, ConfigError> {
    Config::parse(&format!("[data]\nfile = \"a.npz\"\n[model]\n{model}"), Path::new("c.toml"))
}

/// Middle, half the distance and restitution of every group.
fn numbers(config: &Config) -> Vec<[f64; 3]> {
    let stops = config.beginning().unwrap().0.group_laws.stops;
    stops.chunks(3).map(|own| [0, 1, 2].map(|k| own[k].value)).collect()
}

const NONE: [f64; 3] = [0.0, f32::MAX as f64, 0.0];

#[test]
fn stops_are_given_for_all_or_for_each() {
    let one = parse(&format!("{NETWORK}stops = {{ lower = -0.5, upper = 1.5 }}\n")).unwrap();
    assert_eq!(numbers(&one), [[0.5, 1.0, 0.0]; 2]);
    let each = "stops = { lower = [-0.5, -inf], upper = [1.5, inf], restitution = [0.25, 0] }\n";
    assert_eq!(numbers(&parse(&format!("{NETWORK}{each}")).unwrap()), [[0.5, 1.0, 0.25], NONE]);
    let types = "family = \"modular\"\ntypes = [{ name = \"cart\", transform = \"slide\" }, { name = \"bob\", transform = \"rod\" }]\n\
                 trees = { crane = [\"cart\", \"bob\", \"bob\"] }\nstops = { lower = [-1, -inf], upper = [2, inf] }\n";
    assert_eq!(numbers(&parse(types).unwrap()), [[0.5, 1.5, 0.0], NONE]);
}

/// The limits in the description of a robot are stops, of which keys replace some.
#[test]
fn an_arm_takes_the_limits_of_its_description() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &description(2.6));
    let arm = |stops: &str| {
        let file = folder.path().join("c.toml");
        let head = "[data]\nfile = \"d.npz\"\n[model]\nfamily = \"arm\"\nurdf = \"robot.urdf\"\n";
        std::fs::write(&file, format!("{head}{stops}\n")).unwrap();
        Config::read(&file).unwrap()
    };
    let limits = numbers(&arm("stops = \"limits\""));
    assert_eq!(limits.len(), 3);
    assert!(limits.iter().any(|stop| *stop != NONE), "{limits:?}");
    assert!(numbers(&arm("")).is_empty());
    let bouncing = numbers(&arm("stops = { restitution = 0.5 }"));
    for (own, bouncing) in limits.iter().zip(&bouncing) {
        assert_eq!([own[0], own[1], 0.5], *bouncing);
    }
    let given = numbers(&arm("stops = { lower = -3, upper = 1 }"));
    assert_eq!(given, [[-1.0, 2.0, 0.0]; 3]);
}

#[test]
fn what_is_written_is_read_again() {
    for stops in [
        "stops = { lower = [-0.5, -inf], upper = [1.5, inf], restitution = 0.25 }\n",
        "friction = \"sticking\"\npotential = {}\nstops = { lower = -1, upper = 1 }\n",
    ] {
        let config = parse(&format!("{NETWORK}{stops}")).unwrap();
        let written = config.to_toml();
        assert_eq!(Config::parse(&written, Path::new("c.toml")).unwrap(), config, "{written}");
        let (shape, weights) = config.beginning().unwrap();
        let model = decode(&encode(&shape, &weights, None, "test").unwrap()).unwrap();
        assert!(model.architecture.laws().contains(Law::Stops));
        let values = |shape: &leastaction_models::Architecture| {
            shape.group_laws.stops.iter().map(|number| number.value).collect::<Vec<_>>()
        };
        assert_eq!(values(&model.architecture), values(&shape));
        assert!(model.system().unwrap().has_contacts());
    }
}

#[test]
fn errors_name_line_and_key() {
    let cases = [
        ("stops = \"limit\"\n", "or \"limits\""),
        ("stops = \"limits\"\n", "`lower` is missing: this family has no description"),
        ("stops = { lower = -1 }\n", "`upper` is missing"),
        ("stops = { lower = 1, upper = -1 }\n", "the lower stop, 1, is not below the upper one, -1"),
        ("stops = { lower = [0, 1], upper = 1 }\n", "is not below the upper one, 1"),
        ("stops = { lower = -1, upper = inf }\n", "two stops or none: put the other one, which is inf,"),
        ("stops = { lower = inf, upper = -inf }\n", "is not below"),
        ("stops = { lower = nan, upper = 1 }\n", "`lower` is NaN; it must be a number; inf"),
        ("stops = { lower = \"learned\", upper = 1 }\n", "`lower` cannot be learned"),
        ("stops = { lower = -1, upper = { learn = 1 } }\n", "`upper` cannot be learned"),
        ("stops = { lower = -1, upper = 1, restitution = 1.5 }\n", "between 0 and 1"),
        ("stops = { lower = [-1], upper = 1 }\n", "one for each coordinate"),
        ("stops = { lower = -1, upper = 1, bounce = 1 }\n", "bounce"),
    ];
    for (model, expected) in cases {
        let error = parse(&format!("{NETWORK}{model}")).unwrap_err().to_string();
        assert!(error.contains(expected) && error.starts_with("c.toml:5: "), "{model}: {error}");
    }
    let graph = "family = \"graph\"\nnode_types = [{ name = \"bob\" }]\ngraphs = { one = { nodes = [\"bob\"] } }\nstops = \"limits\"\n";
    assert!(parse(graph).unwrap_err().to_string().contains("no end stops"));
}

/// Step of the log, s; mass of a cart, kg; distance of the stops from the middle of its rail, m, and their restitution.
const H: f64 = 0.01;
const MASS: f64 = 0.8;
const STOP: f64 = 0.3;
const RESTITUTION: f64 = 0.4;
const SAMPLES: usize = 400;

fn push(log: usize, k: usize) -> f64 {
    let t = H * k as f64;
    4.0 * (2.3 * t + log as f64).sin() + 3.0 * (5.9 * t + 0.5 * log as f64).cos()
}

/// The cart's position and velocity after a sample under a constant force: parabolas from strike to strike, the instants of which are exact.
fn moved([mut q, mut v]: [f64; 2], force: f64) -> [f64; 2] {
    let (a, mut left) = (force / MASS, H);
    for _ in 0..20 {
        // Pressed against a stop, the cart rests.
        if v == 0.0 && q.abs() == STOP && a * q >= 0.0 {
            return [q, 0.0];
        }
        let strike = [-STOP, STOP].into_iter().flat_map(|stop| {
            let root = (v * v + 2.0 * a * (stop - q)).sqrt();
            let times = [(-v - root) / a, (-v + root) / a];
            times.into_iter().filter(|t| *t > 1e-9 && *t < left).map(move |t| (t, stop)).collect::<Vec<_>>()
        });
        let Some((t, stop)) = strike.min_by(|a, b| a.0.total_cmp(&b.0)) else { break };
        let before = v + a * t;
        (q, v, left) = (stop, -RESTITUTION * before, left - t);
        if v.abs() < 1e-3 {
            v = 0.0;
        }
    }
    [q + v * left + 0.5 * a * left * left, v + a * left]
}

fn log(id: usize) -> Trajectory {
    let (mut state, mut q, mut u) = ([0.1, 0.0], Vec::new(), Vec::new());
    for k in 0..SAMPLES {
        q.push(state[0]);
        u.push(push(id, k));
        state = moved(state, push(id, k));
    }
    let rows = |values| Rows::from_flat(1, values).unwrap();
    Trajectory { id: id as i64, t0: 0.0, q: rows(q), v: None, a: None, u: Some(rows(u)) }
}

/// Root mean square of the error over whole logs, m.
fn error(model: &Model, data: &Dataset) -> f64 {
    let moved = model.rollout(2, (data, Beginning::Positions)).unwrap();
    let squares = |(moved, log): (&Vec<f64>, &Trajectory)| -> f64 {
        (0..SAMPLES).map(|k| (moved[k] - log.q[k][0]).powi(2)).sum()
    };
    let sum: f64 = moved.iter().zip(&data.trajectories).map(squares).sum();
    (sum / (SAMPLES * data.trajectories.len()) as f64).sqrt()
}

/// A cart that runs against its stops in every second: its mass is learned, and whole logs are predicted with their strikes.
#[test]
fn a_cart_between_stops_is_learned_and_predicted() {
    let data =
        Dataset { n: 1, h: H, control: Some(ControlKind::Held), trajectories: (0..3).map(log).collect() };
    let touches = data.trajectories.iter().flat_map(|log| (0..SAMPLES).map(|k| log.q[k][0].abs()));
    assert!(touches.filter(|q| *q > STOP - 1e-3).count() > 60);
    let config = |stops: &str| {
        let text = format!(
            "[data]\nfile = \"a.npz\"\n[model]\nfamily = \"bodies\"\ngravity = [0.0, 0.0]\n{stops}\
             bodies = [{{ joint = \"prismatic\", mass = \"learned\", centre = [0.0, 0.0], inertia = 1.0 }}]\n\
             [training]\nloss = \"windows\"\nwindow = 0.2\niterations = 30\n"
        );
        Config::parse(&text, Path::new("c.toml")).unwrap()
    };
    let learned = |stops: &str| {
        let trained = Plan::new(config(stops), &data).unwrap().train().unwrap();
        Model::new(trained.architecture, trained.best.weights)
    };
    let stops = format!("stops = {{ lower = -{STOP}, upper = {STOP}, restitution = {RESTITUTION} }}\n");
    let model = learned(&stops);
    let mass = model.architecture.number_names().into_iter().zip(&model.weights);
    let mass: Vec<f64> = mass
        .filter(|(name, _)| name.as_ref().is_some_and(|name| name.name.contains("mass")))
        .map(|(_, mass)| *mass)
        .collect();
    assert!((mass[0] / MASS - 1.0).abs() < 0.02, "{mass:?}");
    let (with, without) = (error(&model, &data), error(&learned(""), &data));
    // A step is late for a strike by a part of itself, and strikes add that up.
    assert!(with < 0.08 && without > 10.0 * with, "{with} m with stops, {without} m without");
}
