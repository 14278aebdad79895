//! Rigid bodies on joints: configurations, their errors, training, and the model file.

use crate::documented_bodies;
use crate::page::Strict;
use leastaction_core::energy::bodies::{BodyParameters, Joint, TreeBody};
use leastaction_learning::checkpoint::Trained;
use leastaction_learning::config::{Config, ConfigError};
use leastaction_learning::data::{Dataset, Rows};
use leastaction_learning::run::{Plan, Run};
use leastaction_learning::training::{Range, linear_start};
use leastaction_models::Family as _;
use leastaction_models::config::{BodiesConfig, FamilyConfig};
use leastaction_models::file::{decode, encode, rust_source};
use leastaction_models::{Architecture, BodiesArchitecture, Number};
use std::path::Path;
use std::sync::atomic::AtomicBool;

fn parse(text: &str) -> Result<Config, ConfigError> {
    Config::parse(text, Path::new("c.toml"))
}

/// A configuration whose first four lines are the two of `[data]` and the two of `[model]` that name the family.
fn config_of(rest: &str) -> String {
    format!("[data]\nfile = \"data.npz\"\n[model]\nfamily = \"bodies\"\n{rest}\n")
}

fn architecture(text: &str) -> BodiesArchitecture {
    parse(text).unwrap().beginning().unwrap().0.family.bodies().unwrap().clone()
}

fn error(rest: &str) -> String {
    parse(&config_of(rest)).unwrap_err().to_string()
}

fn numbers(architecture: &BodiesArchitecture) -> Vec<BodyParameters<Number>> {
    architecture.numbers.iter().map(|numbers| BodyParameters::from_array(*numbers)).collect()
}

const ARM: &str = "[[model.bodies]]\nmass = 2\n[[model.bodies]]\njoint = \"prismatic\"\non = 0\n";

#[test]
fn printed_defaults_are_the_defaults() {
    let least =
        "[[model.bodies]]\n[[model.bodies]]\non = 0\nat = [\"learned\", 0]\nrotor = \"learned\"\ngear = 6";
    assert_eq!(architecture(BodiesConfig::defaults()), architecture(&config_of(least)));
    let on = BodiesConfig::defaults().replace("# chain = ", "chain = ").replace("# gear = ", "gear = ");
    assert!(parse(&on).unwrap_err().to_string().contains("leave one of them out"));
    let printed = parse(BodiesConfig::defaults()).unwrap();
    assert_eq!(parse(&printed.to_toml()).unwrap(), printed);
}

#[test]
fn numbers_are_known_or_learned() {
    let text = "gravity = [0, { learn = -9 }]\n[[model.bodies]]\nat = [0.2, { learn = 0.1 }]\nangle = -1\nmass = { learn = 3 }\n\
                centre = [\"learned\", \"learned\"]\ninertia = 0.5\nrotor = \"learned\"\ngear = \"learned\"";
    let text = config_of(text);
    let found = architecture(&text);
    assert_eq!(found.gravity, [Number::known(0.0), Number::learned(-9.0)]);
    let expected = BodyParameters {
        place: [Number::known(0.2), Number::learned(0.1)],
        angle: Number::known(-1.0),
        mass: Number::learned(3.0),
        centre: [Number::learned(0.15), Number::learned(0.0)],
        inertia: Number::known(0.5),
        rotor: Number::learned(1e-4),
        gear: Number::learned(10.0),
    };
    assert_eq!(numbers(&found), [expected]);
    assert_eq!(found.fixed_positions(), [0, 2, 4, 8]);
    let positive: Vec<_> =
        found.ranges().into_iter().filter(|(_, range)| *range == Range::Positive).collect();
    assert_eq!(positive, [(5, Range::Positive), (9, Range::Positive)]);
    assert_eq!(found.ranges().len(), 7);
    let config = parse(&text).unwrap();
    assert_eq!(parse(&config.to_toml()).unwrap(), config);
}

#[test]
fn trees_branch_and_slide() {
    let text = format!("{ARM}[[model.bodies]]\non = 0\n");
    let found = architecture(&config_of(&text));
    let body = |joint, parent| TreeBody { joint, parent };
    let tree = [body(Joint::Revolute, None), body(Joint::Prismatic, Some(0)), body(Joint::Revolute, Some(0))];
    assert_eq!(found.bodies().collect::<Vec<_>>(), tree);
    assert_eq!(found.coordinates(), "ata");
}

/// The short form: all numbers that a chain can show are learned.
#[test]
fn a_chain_is_written_in_short() {
    let found = architecture(&config_of("chain = 3\ngear = 6.0"));
    assert_eq!((found.n(), found.coordinates().as_str()), (3, "aaa"));
    let [first, second, third] = numbers(&found).try_into().unwrap();
    assert!(first.mass.learned && first.centre[0].learned && first.inertia.learned);
    assert_eq!((first.place[0], first.rotor), (Number::known(0.0), Number::known(0.0)));
    assert!(second.place[0].learned && second.rotor.learned);
    assert_eq!((second, second.gear), (third, Number::known(6.0)));
    assert_eq!(found.bodies().map(|body| body.parent).collect::<Vec<_>>(), [None, Some(0), Some(1)]);
}

#[test]
fn mistakes_are_found_with_their_line() {
    for (rest, line, words) in [
        ("", 3, "no bodies: add chain = 2"),
        ("chain = 0", 5, "0 coordinates to train; this program takes 1 to 64"),
        ("chain = 65", 5, "65 coordinates"),
        ("chain = 2\n[[model.bodies]]", 5, "leave one of them out"),
        ("gear = 2.0\n[[model.bodies]]", 5, "only a chain has one gear ratio"),
        ("[[model.bodies]]\nmass = 0", 6, "`mass` is 0; it must be a finite number above 0"),
        ("[[model.bodies]]\ninertia = -1", 6, "`inertia` is -1"),
        ("[[model.bodies]]\nrotor = { learn = 0 }", 6, "`rotor` is 0; it must be a finite number above 0"),
        ("[[model.bodies]]\ncentre = [1e40, 0]", 6, "`centre` is 1"),
        ("[[model.bodies]]\nmass = \"lerned\"", 6, "or \"learned\", or { learn = 0.3 }"),
        ("[[model.bodies]]\njoint = \"ball\"", 6, "unknown variant `ball`"),
        ("[[model.bodies]]\non = 0", 6, "body 0 sits on body 0, which does not come before it"),
        ("[[model.bodies]]\n[[model.bodies]]\non = 7", 7, "body 1 sits on body 7"),
        ("[[model.bodies]]\nlength = 1", 6, "unknown field `length`"),
    ] {
        let found = error(rest);
        assert!(found.contains(words) && found.contains(&format!(":{line}")), "{rest}: {found}");
    }
}

/// Two links on geared drives.
fn machine() -> BodiesArchitecture {
    let link = BodyParameters {
        place: [0.0; 2],
        angle: 0.0,
        mass: 0.5,
        centre: [0.15, 0.0],
        inertia: 0.004,
        rotor: 6e-5,
        gear: 6.0,
    };
    let below = BodyParameters { place: [0.2, 0.0], mass: 0.6, centre: [0.22, 0.0], inertia: 0.006, ..link };
    let bodies = [(None, link), (Some(0), below)].map(|(parent, numbers)| {
        let known = BodyParameters::from_array(numbers.into_array().map(Number::known));
        (TreeBody { joint: Joint::Revolute, parent }, known)
    });
    BodiesArchitecture::new([9.81, 0.0].map(Number::known), bodies).unwrap()
}

fn log(trajectories: i64) -> Dataset {
    documented_bodies::log::<2>(&machine(), &machine().initial_weights(0), trajectories)
}

/// Numbers that the motion of a geared double pendulum shows: constants of M, the coupling, gravity.
fn shown(weights: &[f64]) -> [f64; 6] {
    let (bodies, _) = weights[2..].as_chunks();
    let [one, two] = [bodies[0], bodies[1]].map(BodyParameters::from_array);
    let length = two.place[0];
    let own = two.inertia + two.mass * two.centre[0].powi(2);
    let below = one.inertia + one.mass * one.centre[0].powi(2) + two.mass * length * length;
    [
        below + one.gear.powi(2) * one.rotor + own + two.rotor,
        own + two.gear * two.rotor,
        own + two.gear.powi(2) * two.rotor,
        two.mass * length * two.centre[0],
        one.mass * one.centre[0] + two.mass * length,
        two.mass * two.centre[0],
    ]
}

/// A chain of which only gravity and a guess of the gear are known learns the numbers that motion shows.
#[test]
fn a_chain_learns_the_machine_that_it_sees() {
    let training = "[training]\nloss = \"acceleration\"\niterations = 60\nwarm_up = 0";
    let config = parse(&config_of(&format!("chain = 2\n{training}"))).unwrap();
    let (folder, data) = (tempfile::tempdir().unwrap(), log(6));
    let plan = Plan::new(config, &data).unwrap();
    assert_eq!((plan.parameters(), plan.learned_parameters()), (20, 8));
    let run = folder.path().join("run");
    Run::begin(plan, &run, true).unwrap().train(&mut Strict, &AtomicBool::new(false)).unwrap();
    let trained = Trained::read(&run).unwrap();
    let (found, expected) = (shown(&trained.best.weights), shown(&machine().initial_weights(0)));
    for (found, expected) in found.iter().zip(expected) {
        assert!((found / expected - 1.0).abs() < 1e-5, "{found} instead of {expected}");
    }
}

/// Torques alone lead from the default numbers, lengths and friction included, to the numbers that motion shows, whatever the size of the
/// machine.
#[test]
fn least_squares_of_torques_find_what_motion_shows() {
    const B: [f64; 2] = [0.02, 0.01];
    const C: [f64; 2] = [0.15, 0.1];
    let tanh = |v: f64| (v / 0.1).tanh();
    let model = "chain = 2\n[model.friction]\nviscous = \"learned\"\ncoulomb = \"learned\"\nwidth = 0.1";
    let architecture = parse(&config_of(model)).unwrap().beginning().unwrap().0;
    for scale in [1.0, 30.0] {
        let [mut q, mut v, mut a, mut u] = [const { Vec::new() }; 4];
        for t in &log(6).trajectories {
            let of = |rows: &Option<Rows>| rows.as_ref().unwrap().as_flat().to_vec();
            let velocities = of(&t.v);
            let friction = velocities.iter().enumerate().map(|(k, v)| B[k % 2] * v + C[k % 2] * tanh(*v));
            u.extend(of(&t.u).iter().zip(friction).map(|(u, friction)| scale * u + friction));
            q.extend(t.q.as_flat());
            v.extend(velocities);
            a.extend(of(&t.a));
        }
        let found = linear_start(&architecture, [&q, &v, &a, &u]).unwrap().weights;
        let expected = shown(&machine().initial_weights(0));
        for (found, expected) in shown(&found).iter().zip(expected) {
            let expected = scale * expected;
            assert!((found / expected - 1.0).abs() < 1e-4, "{found} instead of {expected}");
        }
        for (group, found) in architecture.friction_of_coordinates(&found).iter().enumerate() {
            assert!((found.viscous / B[group] - 1.0).abs() < 1e-3, "{found:?}");
            assert!((found.dry.unwrap().constant / C[group] - 1.0).abs() < 1e-3, "{found:?}");
        }
    }
    let short = linear_start(&architecture, [&[0.0; 4], &[0.0; 4], &[0.0; 4], &[0.0; 3]]);
    assert!(short.is_err(), "a torque is missing");
}

/// Free motion shows only ratios: J v̇ + b v + m g c sin q = 0. A body of known mass keeps its ratio of I to m c², and with
/// it the scale of all others, where a least sum of squares would have them vanish.
#[test]
fn free_motion_keeps_the_scale_of_a_known_mass() {
    let model = "[[model.bodies]]\nmass = 0.5\ncentre = [\"learned\", 0.0]\ninertia = \"learned\"\n\
                 [model.friction]\nviscous = \"learned\"";
    let architecture = parse(&config_of(model)).unwrap().beginning().unwrap().0;
    let (gravity, damping) = (40.0, 0.3);
    let [mut q, mut v, mut a] = [const { Vec::new() }; 3];
    for k in 0..200 {
        let own = [(0.37 * f64::from(k)).sin() * 2.0, (0.61 * f64::from(k)).cos() * 3.0];
        q.push(own[0]);
        v.push(own[1]);
        a.push(-gravity * own[0].sin() - damping * own[1]);
    }
    let found = linear_start(&architecture, [&q, &v, &a, &vec![0.0; q.len()]]).unwrap();
    assert!(!found.shows_scale);
    let body = BodyParameters::from_array(*found.weights[2..].first_chunk().unwrap());
    let square = body.mass * body.centre[0] * body.centre[0];
    let about_joint = body.inertia + square;
    let friction = architecture.friction_of_coordinates(&found.weights)[0].viscous;
    let close =
        |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-5, "{found} {expected}");
    close(body.mass * 9.81 * body.centre[0] / about_joint, gravity);
    close(friction / about_joint, damping);
    close(body.inertia / square, 0.01 / 0.15_f64.powi(2));
    let forced = linear_start(&architecture, [&q, &v, &a, &a]).unwrap();
    assert!(forced.shows_scale);
}

#[test]
fn a_model_of_another_number_of_bodies_is_refused() {
    let plan = |rest: &str, data: &Dataset| {
        let config = parse(&config_of(&format!("{rest}\n[training]\nloss = \"acceleration\""))).unwrap();
        Plan::new(config, data).err().map(|error| error.to_string())
    };
    let mut data = log(3);
    let words = plan("chain = 3", &data).unwrap();
    assert!(words.contains("3 bodies") && words.contains("set chain = 2"), "{words}");
    assert_eq!(plan("chain = 2", &data), None);
    // If no force is logged, at least one mass or inertia must be known.
    data.trajectories.iter_mut().for_each(|trajectory| trajectory.u = None);
    assert!(
        plan("chain = 2", &data).unwrap().contains("[[model.bodies]]: every mass of the tree is learned")
    );
    assert_eq!(plan("[[model.bodies]]\nmass = 2\n[[model.bodies]]\non = 0", &data), None);
}

#[test]
fn the_model_file_holds_bodies() {
    let (machine, weights) = (Architecture::from(machine()), machine().initial_weights(0));
    let bytes = encode(&machine, &weights, None, "bodies").unwrap();
    let read = decode(&bytes).unwrap();
    let bodies = read.architecture.family.bodies().unwrap();
    assert_eq!((bodies.n(), read.architecture.name()), (2, "bodies"));
    assert_eq!(bodies.initial_weights(0), read.weights);
    assert_eq!(read.architecture.units(), "rad,rad");
    assert_eq!(encode(&read.architecture, &read.weights, None, "bodies").unwrap(), bytes);
    let source = rust_source(&bytes).unwrap();
    assert!(source.contains("pub type Model = BodiesModel<'static, N>;"), "{source}");
    assert!(
        source.contains("use leastaction_core::model::{BodiesModel, ModelError};")
            && !source.contains("const H")
    );
    let mut light = weights;
    light[5] = 0.0;
    assert!(encode(&machine, &light, None, "").unwrap_err().to_string().contains("mass of a body"));
}
