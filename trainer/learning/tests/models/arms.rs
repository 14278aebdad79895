//! Arms from a robot description and torques: configurations, what is wrong with them, training, and the model file.

use leastaction_core::forces::ControlKind;
use leastaction_learning::checkpoint::Trained;
use leastaction_learning::config::{Config, ConfigError};
use leastaction_learning::data::{Dataset, Rows, Trajectory};
use leastaction_learning::run::{Monitor, Notice, Plan, Row, Run};
use leastaction_learning::torque::Samples;
use leastaction_learning::torque::fit::{Arm, JointNumbers};
use leastaction_learning::torques::torque_errors;
use leastaction_learning::training::{Samples as States, inverse_dynamics};
use leastaction_models::config::{ArmConfig, FamilyConfig};
use leastaction_models::file::{decode, encode, rust_source};
use leastaction_models::tree::{Inertia, Tree};
use leastaction_models::urdf::{Inertias, parse as parse_urdf};
use leastaction_models::{
    Actuator, Architecture, ArmArchitecture, Facts, FrictionArchitecture, Model, Number,
};
use leastaction_programs::System;
use std::path::Path;
use std::sync::atomic::AtomicBool;

const N: usize = 3;
const H: f64 = 0.01;

struct Silent;

impl Monitor for Silent {
    fn row(&mut self, _: &Row) {}

    fn warning(&mut self, message: &str) {
        panic!("{message}");
    }
}

/// Three links, the second on an axis askew, of which the last slides; `mass` is that of the first.
fn description(mass: f64) -> String {
    let link = |k: usize, mass: f64, i: f64| {
        format!(
            "<link name=\"link{k}\"><inertial><origin xyz=\"0.05 0.02 0.1\"/><mass value=\"{mass}\"/><inertia ixx=\"{i}\" \
             iyy=\"{i}\" izz=\"{}\" ixy=\"0\" ixz=\"0.001\" iyz=\"0\"/></inertial></link>",
            1.2 * i
        )
    };
    let joint = |k: usize, kind: &str, axis: &str| {
        format!(
            "<joint name=\"joint{k}\" type=\"{kind}\"><parent link=\"link{}\"/><child link=\"link{k}\"/><origin xyz=\"0.1 0 0.2\" \
             rpy=\"0.3 {k} 0\"/><axis xyz=\"{axis}\"/><limit lower=\"-9\" upper=\"9\" effort=\"9\" velocity=\"9\"/></joint>",
            k - 1
        )
    };
    let links = [link(1, mass, 0.05), link(2, 1.5, 0.03), link(3, 1.0, 0.02)].concat();
    let joints =
        [joint(1, "revolute", "0 0 1"), joint(2, "revolute", "0.6 0 0.8"), joint(3, "prismatic", "1 0 0")]
            .concat();
    format!("<robot name=\"r\"><link name=\"link0\"/>{links}{joints}</robot>")
}

fn write(folder: &Path, text: &str) {
    std::fs::write(folder.join("robot.urdf"), text).unwrap();
}

/// After the lines of the family.
fn config_of(folder: &Path, rest: &str) -> Result<Config, ConfigError> {
    let file = folder.join("c.toml");
    let text = format!(
        "[data]\nfile = \"d.npz\"\nvalidation = 0.3\n[model]\nfamily = \"arm\"\nurdf = \"robot.urdf\"\n{rest}\n"
    );
    std::fs::write(&file, text).unwrap();
    Config::read(&file)
}

fn error(folder: &Path, rest: &str) -> String {
    config_of(folder, rest).unwrap_err().to_string()
}

/// Positions, velocities and accelerations at a time, other ones for every log.
fn motion(log: usize, t: f64) -> [[f64; N]; 3] {
    let mut all = [[0.0; N]; 3];
    for (i, w) in [2.1, 2.9, 3.7].into_iter().enumerate() {
        for (k, share) in [(1.0, 0.5), (1.7, 0.3)] {
            let (w, phase) = (w * k, i as f64 + 2.0 * log as f64 * k);
            let (sine, cosine) = (w * t + phase).sin_cos();
            all[0][i] += share * sine;
            all[1][i] += share * w * cosine;
            all[2][i] -= share * w * w * sine;
        }
    }
    all
}

/// The robot, heavier than it is described, with friction.
fn robot() -> Arm {
    let mut tree = parse_urdf(&description(2.6), Inertias::Required).unwrap();
    tree.rotors = vec![0.2, 0.1, 0.3];
    let joint = |rotor: f64| JointNumbers {
        rotor,
        viscous: 0.3,
        coulomb: 0.4,
        width: 0.1,
        offset: if rotor == 0.1 { 0.25 } else { 0.0 },
        ..JointNumbers::default()
    };
    let joints = tree.rotors.iter().map(|rotor| joint(*rotor)).collect();
    Arm { tree, joints }
}

/// Three logs of four seconds.
fn data() -> Dataset {
    data_of(&robot())
}

fn data_of(robot: &Arm) -> Dataset {
    data_with(robot, |_, _| [0.0; N])
}

/// The same with more torques, of positions and velocities.
fn data_with(robot: &Arm, more: impl Fn(&[f64], &[f64]) -> [f64; N]) -> Dataset {
    let log = |log: usize| {
        let states: Vec<[[f64; N]; 3]> = (0..400).map(|k| motion(log, k as f64 * H)).collect();
        let rows = |part: usize| {
            Rows::from_flat(N, states.iter().flat_map(|state| state[part]).collect::<Vec<_>>()).unwrap()
        };
        let (q, v, a) = (rows(0), rows(1), rows(2));
        let t = (0..400).map(|k| k as f64 * H).collect();
        let samples = Samples { t, q: q.clone(), v: v.clone(), a, tau: q.clone() };
        let more = q.iter().zip(v.iter()).flat_map(|(q, v)| more(q, v));
        let torques = robot.torques(&samples).into_iter().zip(more).map(|(own, more)| own + more);
        let u = Rows::from_flat(N, torques.collect()).unwrap();
        Trajectory { id: log as i64, t0: 0.0, q, v: Some(v), a: None, u: Some(u) }
    };
    Dataset { n: N, h: H, control: Some(ControlKind::Linear), trajectories: (0..3).map(log).collect() }
}

const LEARNED: &str = "friction = \"learned\"\n[calibration]\noffset = \"learned\"";

fn bodies(architecture: &Architecture, weights: &[f64]) -> Tree {
    architecture.family.arm().unwrap().host_tree(weights).unwrap()
}

#[test]
fn an_arm_is_learned_from_its_description_and_torques() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &description(2.0));
    let plan = Plan::new(config_of(folder.path(), LEARNED).unwrap(), &data()).unwrap();
    let report = plan.notices().iter().find_map(|notice| match notice {
        Notice::Torques(report) => Some(report.clone()),
        _ => None,
    });
    let report = report.unwrap();
    let errors = &report.errors;
    assert!(errors.train.nmse < 1e-3 && errors.held_back.as_ref().unwrap().nmse < 1e-3, "{report:?}");
    // Offsets are those of the drive: what the log has more they have less.
    let by_log = |name: &str| {
        let rows = report.numbers.rows();
        rows.into_iter().find(|row| row.name == name).and_then(|row| row.by_log).unwrap()
    };
    assert!((by_log("coordinate 1: offset of the actuator") + 0.25).abs() < 0.02);
    assert!((by_log("coordinate 2: Coulomb friction") - 0.4).abs() < 0.04);
    assert!(report.to_string().contains("by the log alone"), "{report}");
    let trained = plan.train().unwrap();
    let (architecture, weights) = (&trained.architecture, &trained.best.weights);
    let is_body = |inertia: Inertia| inertia.consistency() > 0.0;
    assert!(bodies(architecture, weights).bodies().iter().all(|body| is_body(body.inertia)));
    // What the description says is far off, and friction is found.
    let (_, initial) = config_of(folder.path(), LEARNED).unwrap().beginning().unwrap();
    let of = |weights: &[f64]| {
        let model = Model { weights: weights.to_vec(), ..trained.model() };
        torque_errors(&model, &data(), 20.0).unwrap().nmse
    };
    assert!(of(weights) < 1e-4 && of(&initial) > 0.1, "{} {}", of(weights), of(&initial));
    for friction in architecture.friction_of_coordinates(weights) {
        assert!((friction.viscous - 0.3).abs() < 0.03, "{friction:?}");
        assert!((friction.dry.unwrap().constant - 0.4).abs() < 0.04, "{friction:?}");
    }
    let offset = &trained.calibrated.as_ref().unwrap().actuator.offset;
    assert!((offset[1] + 0.25).abs() < 0.02 && offset[0].abs() < 0.02, "{offset:?}");
}

#[test]
fn the_model_file_has_the_arm_and_rust_loads_it() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &description(2.0));
    let plan = Plan::new(config_of(folder.path(), LEARNED).unwrap(), &data()).unwrap();
    let trained = plan.train().unwrap();
    let bytes = encode(&trained.architecture, &trained.best.weights, trained.trained_step, "test").unwrap();
    let model = decode(&bytes).unwrap();
    let [there, back] = [&trained.best.weights, &model.weights].map(|weights| {
        let model = Model { weights: weights.clone(), ..trained.model() };
        torque_errors(&model, &data(), 20.0).unwrap().nmse
    });
    assert!((there - back).abs() < 1e-5, "{there} {back}");
    assert!(rust_source(&bytes).unwrap().contains("ArmModel<'static, N"));
}

/// Windows begin at the fit to torques, and end below it with bodies that can be.
#[test]
fn windows_go_on_from_torques() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &description(2.0));
    let rest =
        format!("{LEARNED}\n[training]\nloss = \"windows\"\nwindow = 0.2\niterations = 3\nwarm_up = 0");
    let mut data = data();
    data.trajectories.truncate(2);
    let plan = |rest: &str| Plan::new(config_of(folder.path(), rest).unwrap(), &data).unwrap();
    let (before, plan) = (plan(&rest.replace("iterations = 3", "iterations = 0")), plan(&rest));
    let [after, before] = [plan, before].map(|plan| plan.train().unwrap());
    assert!(after.best.train < 0.9 * before.best.train, "{} {}", after.best.train, before.best.train);
    let tree = bodies(&after.architecture, &after.best.weights);
    assert!(tree.bodies().iter().all(|body| body.inertia.consistency() > 0.0));
}

#[test]
fn known_bodies_stay_as_they_are_described() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &description(2.6));
    let rest = format!("bodies = \"known\"\n{LEARNED}");
    let trained = Plan::new(config_of(folder.path(), &rest).unwrap(), &data()).unwrap().train().unwrap();
    let tree = bodies(&trained.architecture, &trained.best.weights);
    let described = parse_urdf(&description(2.6), Inertias::Required).unwrap();
    for (found, given) in tree.bodies().iter().zip(described.bodies()) {
        assert_eq!(found.inertia, given.inertia);
    }
    assert!((tree.rotors[2] - 0.3).abs() < 0.02, "{:?}", tree.rotors);
}

/// Some numbers of friction are known, one here, another there.
#[test]
fn friction_is_learned_beside_what_is_known_of_it() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &description(2.0));
    let mut robot = robot();
    for joint in &mut robot.joints {
        (joint.load, joint.smoothing) = (0.2, 0.5);
    }
    let rest = "[model.friction]\nviscous = [0.3, \"learned\", \"learned\"]\ncoulomb = [\"learned\", 0.4, \"learned\"]\n\
                load = \"learned\"\nsmoothing = 0.5\nwidth = 0.1\n[calibration]\noffset = \"learned\"";
    let plan = Plan::new(config_of(folder.path(), rest).unwrap(), &data_of(&robot)).unwrap();
    let trained = plan.train().unwrap();
    let found = trained.architecture.friction_of_coordinates(&trained.best.weights);
    let dry = |i: usize| found[i].dry.unwrap();
    let held = [found[0].viscous, dry(1).constant, dry(0).smoothing, dry(2).smoothing, dry(0).width];
    assert_eq!(held, [0.3, 0.4, 0.5, 0.5, 0.1]);
    for (i, own) in found.iter().enumerate() {
        let pairs = [(own.viscous, 0.3), (dry(i).constant, 0.4), (dry(i).load, 0.2), (dry(i).width, 0.1)];
        assert!(pairs.iter().all(|(found, truth)| (found - truth).abs() < 0.04), "{own:?}");
    }
    // What is left is what the filter does to friction that turns fast.
    assert!(torque_errors(&trained.model(), &data_of(&robot), 20.0).unwrap().nmse < 1e-3);
}

/// A network of the same coordinates, with the friction of an arm, from the same filtered motion: from nothing, or from where the arm is.
#[test]
fn a_network_is_learned_from_the_same_torques() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &description(2.0));
    let arm = Plan::new(config_of(folder.path(), LEARNED).unwrap(), &data()).unwrap().train().unwrap();
    let file = encode(&arm.architecture, &arm.best.weights, None, "test").unwrap();
    std::fs::write(folder.path().join("arm.postcard"), file).unwrap();
    let plan = |start: &str, iterations: usize, data: &Dataset| {
        let text = format!(
            "[data]\nfile = \"d.npz\"\nvalidation = 0.3\n[model]\ncoordinates = [\"angle\", \"angle\", \"translation\"]\nhidden = [6]\n\
             {start}\nfriction = {{ viscous = \"learned\", coulomb = \"learned\" }}\n[training]\nloss = \"torque\"\niterations = {iterations}\n"
        );
        let file = folder.path().join("network.toml");
        std::fs::write(&file, text).unwrap();
        Plan::new(Config::read(&file).unwrap(), data)
    };
    let loss = |start: &str, iterations: usize| {
        let best = plan(start, iterations, &data()).unwrap().train().unwrap().best;
        (best.train, best.validation.unwrap())
    };
    let (before, after, from_arm) = (loss("", 0), loss("", 5), loss("start_from = \"arm.postcard\"", 0));
    assert!(after.0 < 0.5 * before.0 && after.1 < before.1, "{before:?} {after:?}");
    assert!(from_arm.1 < 0.5 * before.1, "{before:?} {from_arm:?}");
    // The loss is in deviations of the torque, and friction does not see the load: the same is found by inverse dynamics.
    let model = plan("", 5, &data()).unwrap().train().unwrap().model();
    let nmse = |logs: std::ops::Range<usize>| {
        let of = Dataset { trajectories: data().trajectories[logs].to_vec(), ..data() };
        torque_errors(&model, &of, 20.0).unwrap().nmse
    };
    assert!(
        (nmse(0..2) / after.0 - 1.0).abs() < 1e-6 && (nmse(2..3) / after.1 - 1.0).abs() < 1e-6,
        "{after:?}"
    );
    let mut none = data();
    none.trajectories.iter_mut().for_each(|trajectory| trajectory.u = None);
    assert_eq!(torque_errors(&model, &none, 20.0), None);
    let error = plan("", 1, &none).err().unwrap().to_string();
    assert!(error.contains("the data has none"), "{error}");
}

/// The shape of a robot, all of whose numbers are known.
fn known(robot: &Arm) -> Architecture {
    let numbers =
        |joint: &JointNumbers| [joint.coulomb, joint.load, joint.smoothing, joint.width].map(Number::known);
    let friction = FrictionArchitecture::new(
        robot.joints.iter().map(|joint| Number::known(joint.viscous)).collect(),
        robot.joints.iter().map(numbers).collect(),
    );
    let family =
        ArmArchitecture::new(&robot.tree, |_| false, |k| Number::known(robot.tree.rotors[k])).unwrap();
    Architecture { friction, ..Architecture::from(family) }
}

/// Drives that are late and have another gain are judged by what they do with the logged commands; where one coordinate is not driven
/// there is nothing to judge by.
#[test]
fn torques_are_judged_behind_the_drives() {
    const LATE: usize = 3;
    let mut robot = robot();
    for joint in &mut robot.joints {
        (joint.load, joint.smoothing) = (0.3, 0.4);
    }
    let mut data = data_of(&robot);
    for u in data.trajectories.iter_mut().filter_map(|trajectory| trajectory.u.as_mut()) {
        let row = |k: usize| u[(k + LATE).min(u.len() - 1)].iter().map(|x| x / 2.0);
        *u = Rows::from_flat(N, (0..u.len()).flat_map(row).collect()).unwrap();
    }
    let architecture = known(&robot);
    let weights = architecture.initial_weights(0);
    let offset = robot.joints.iter().map(|joint| -joint.offset).collect();
    let actuator = Actuator { gain: vec![2.0; N], offset, delay: LATE as f64 * H };
    let errors = |actuator: Actuator, data: &Dataset| {
        let facts = Facts { actuator, ..Facts::default() };
        torque_errors(&Model::new(architecture.clone(), weights.clone()).with_facts(facts), data, 20.0)
    };
    let own = errors(actuator.clone(), &data).unwrap();
    assert!(own.nmse < 1e-3 && own.rmse.len() == N, "{own:?}");
    for other in [
        Actuator { delay: 0.0, ..actuator.clone() },
        Actuator { gain: vec![1.0; N], ..actuator.clone() },
        Actuator { offset: Vec::new(), ..actuator.clone() },
    ] {
        let worse = errors(other, &data).unwrap();
        assert!(worse.rmse.iter().zip(&own.rmse).any(|(worse, own)| *worse > 4.0 * own), "{worse:?} {own:?}");
    }
    for trajectory in &mut data.trajectories {
        let row = |u: &[f64]| [u[0], 0.0, u[2]];
        let values = trajectory.u.iter().flat_map(|u| u.iter().flat_map(row)).collect();
        trajectory.u = Rows::from_flat(N, values);
    }
    assert_eq!(errors(actuator, &data), None);
}

/// The programs' inverse dynamics are the arm's, with friction that grows with the torque that is asked for.
#[test]
fn networks_and_arms_take_torques_alike() {
    let mut robot = robot();
    for joint in &mut robot.joints {
        (joint.load, joint.offset, joint.smoothing) = (0.3, 0.0, 0.4);
    }
    let architecture = known(&robot);
    let states: Vec<_> = (0..40).map(|k| motion(0, 0.1 * f64::from(k))).collect();
    let [q, v, a] = [0, 1, 2].map(|part| Rows::from_rows(N, states.iter().map(|state| state[part])).unwrap());
    let samples = Samples { t: Vec::new(), tau: q.clone(), q, v, a };
    let system = System::new(&*architecture.energies().unwrap());
    let found = inverse_dynamics(&system, &architecture.initial_weights(0), &States::of_torques(&samples, H));
    let expected = robot.torques(&samples);
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(&expected) {
        assert!((found - expected).abs() < 1e-9 * (1.0 + expected.abs()), "{found} {expected}");
    }
}

/// Air that brakes one joint and a spring at another, which no number of an arm is, by either loss.
#[test]
fn networks_beside_an_arm_are_learned_from_torques_and_over_windows() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &description(2.6));
    let of = |size: f64| {
        data_with(&robot(), move |q, v| [size * v[0] * v[0].abs(), 3.0 * size * (2.0 * q[1]).sin(), 0.0])
    };
    let mut data = of(2.0);
    let networks = "[model.dissipation]\ncoordinates = [0]\nhidden = [4]\n[model.potential]\ncoordinates = [1]\nhidden = [4]";
    let plan = |rest: &str, data: &Dataset| {
        let text = format!("bodies = \"known\"\n{LEARNED}\n{rest}");
        Plan::new(config_of(folder.path(), &text).unwrap(), data).unwrap()
    };
    let nmse = |rest: &str, data: &Dataset| {
        torque_errors(&plan(rest, data).train().unwrap().model(), data, 20.0).unwrap().nmse
    };
    let (alone, both) = (nmse("", &data), nmse(&format!("{networks}\n[training]\niterations = 40"), &data));
    assert!(both < 0.05 * alone, "{alone} {both}");
    // The bodies are as they were, and the page has the torques of all of it.
    let report = folder.path().join("run");
    let plan_of_run = plan(&format!("{networks}\n[training]\niterations = 5"), &data);
    let mut run = Run::begin(plan_of_run, &report, true).unwrap();
    run.train(&mut Silent, &AtomicBool::new(false)).unwrap();
    let errors = run.torque_errors().unwrap();
    assert!(errors.held_back.as_ref().unwrap().nmse < alone, "{errors:?}");
    let page = std::fs::read_to_string(run.report().unwrap()).unwrap();
    assert!(page.contains(&errors.to_string()) && page.contains("without networks"), "{errors}");
    let trained = Trained::read(&report).unwrap();
    let described = parse_urdf(&description(2.6), Inertias::Required).unwrap();
    let tree = bodies(&trained.architecture, &trained.best.weights);
    assert!(tree.bodies().iter().zip(described.bodies()).all(|(own, given)| own.inertia == given.inertia));
    // Over windows networks begin where the arm alone is.
    data = of(0.3);
    data.trajectories.truncate(2);
    let windows = "[training]\nloss = \"windows\"\nwindow = 0.4\nwarm_up = 0\niterations = 4";
    let (alone, both) = (nmse(windows, &data), nmse(&format!("{networks}\n{windows}"), &data));
    assert!(both < 0.5 * alone, "{alone} {both}");
    // What torques cannot tell is refused.
    let rest = format!("[calibration]\ngain = \"learned\"\n{networks}");
    let refused = Plan::new(config_of(folder.path(), &rest).unwrap(), &data).err().unwrap().to_string();
    assert!(refused.contains("learns offset alone"), "{refused}");
}

/// The arm is learned first, then what it carries, all else being known.
#[test]
fn a_payload_is_found_by_the_body_that_carries_it() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &description(2.0));
    let plan = Plan::new(config_of(folder.path(), LEARNED).unwrap(), &data()).unwrap();
    let trained = plan.train().unwrap();
    let file = encode(&trained.architecture, &trained.best.weights, None, "test").unwrap();
    std::fs::write(folder.path().join("arm.postcard"), file).unwrap();
    let mut robot = robot();
    let load = Inertia::of_centre(
        1.0,
        nalgebra::Vector3::new(0.05, 0.02, 0.2),
        nalgebra::Matrix3::identity() * 0.002,
    );
    let mut parameters = robot.tree.parameters();
    parameters[20..30].iter_mut().zip(load.0).for_each(|(own, more)| *own += more);
    robot.tree = robot.tree.with_parameters(&parameters);
    let rest = format!("start_from = \"arm.postcard\"\nbodies = [\"joint3\"]\n{LEARNED}");
    let carrying =
        Plan::new(config_of(folder.path(), &rest).unwrap(), &data_of(&robot)).unwrap().train().unwrap();
    let [before, after] = [&trained, &carrying].map(|of| bodies(&of.architecture, &of.best.weights));
    for k in 0..2 {
        let [a, b] = [&before, &after].map(|tree| tree.bodies()[k].inertia.0);
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6), "{a:?} {b:?}");
    }
    let [before, after] = [before, after].map(|tree| tree.bodies()[2].inertia.mass());
    assert!((after - before - 1.0).abs() < 0.02, "{before} {after}");
    // Another arm, and a joint that it has not.
    write(folder.path(), &description(2.0).replace("0.1 0 0.2", "0.1 0 0.3"));
    let text = error(folder.path(), &rest);
    assert!(text.contains("other joints"), "{text}");
    write(folder.path(), &description(2.0));
    let text = error(folder.path(), &rest.replace("joint3", "wrist"));
    assert!(text.contains("wrist") && text.contains("joint1, joint2, joint3"), "{text}");
}

#[test]
fn what_cannot_be_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    assert!(error(path, "").contains("robot.urdf"), "{}", error(path, ""));
    write(path, &description(2.0));
    assert!(error(path, "mass = -1.0").contains("above 0"));
    let text = error(path, "bodies = \"guessed\"");
    assert!(text.contains("names of the joints"), "{text}");
    assert!(error(path, "friction = [1]").contains("friction"));
    write(path, &description(0.0));
    let text = error(path, "");
    assert!(text.contains("link1"), "{text}");
    write(path, &description(2.0).replace("</robot>", "<link name=\"f\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" \
        ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial></link><joint name=\"j\" type=\"revolute\"><parent link=\"link1\"/><child \
        link=\"f\"/><mimic joint=\"joint1\"/></joint></robot>"));
    let text = error(path, "");
    assert!(text.contains("<mimic>"), "{text}");
    write(path, &description(2.0));
    let plan = |rest: &str, data: &Dataset| {
        Plan::new(config_of(path, rest).unwrap(), data).err().unwrap().to_string()
    };
    let mut none = data();
    none.trajectories.iter_mut().for_each(|trajectory| trajectory.u = None);
    assert!(plan("", &none).contains("the data has none"), "{}", plan("", &none));
    let two = Dataset { n: 2, ..data() };
    assert!(plan("", &two).contains("joint1, joint2, joint3"), "{}", plan("", &two));
    let fast = plan("friction = \"learned\"\n[training]\ncut_off = 70.0", &data());
    assert!(fast.contains("half the sampling rate"), "{fast}");
}

#[test]
fn printed_defaults_are_read() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &description(2.0));
    let text =
        ArmConfig::defaults().replace("robot.urdf", &folder.path().join("robot.urdf").display().to_string());
    let printed = Config::parse(&text, Path::new("c.toml")).unwrap();
    assert_eq!(Config::parse(&printed.to_toml(), Path::new("c.toml")).unwrap(), printed);
}
