//! Arms from a robot description and torques: configurations, their errors, training, and the model file.

use leastaction_core::forces::ControlKind;
use leastaction_learning::config::{Config, ConfigError};
use leastaction_learning::data::{Dataset, Rows, Trajectory};
use leastaction_learning::run::{Notice, Plan};
use leastaction_learning::torque::Samples;
use leastaction_learning::torque::fit::{Arm, JointNumbers};
use leastaction_learning::torques::torque_errors;
use leastaction_models::config::{ArmConfig, FamilyConfig};
use leastaction_models::file::{decode, encode, rust_source};
use leastaction_models::tree::{Inertia, Tree};
use leastaction_models::urdf::{Inertias, parse as parse_urdf};
use leastaction_models::{Architecture, Model};
use std::path::Path;

mod descriptions;
mod torques;

const N: usize = 3;
const H: f64 = 0.01;

/// Three links, the second on an oblique axis, the last on a sliding joint; `mass` is that of the first.
pub fn description(mass: f64) -> String {
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

pub fn write(folder: &Path, text: &str) {
    std::fs::write(folder.join("robot.urdf"), text).unwrap();
}

/// Parses a configuration with `rest` after the lines of the family.
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

/// Positions, velocities and accelerations at time t, different for every log.
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

/// The robot: heavier than described, with friction.
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

/// The logs with additional torques `more`, which depend on positions and velocities.
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
    // The offsets belong to the drive: their sign is opposite to that of the log's.
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
    // The described masses are far off; friction is learned, too.
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

/// Windows start from the fit to torques, and reach a lower loss with physically consistent bodies.
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

/// The arm is learned first; then its payload is learned with everything else known.
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
    // The model belongs to another arm, and the configuration names a joint that the arm lacks.
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
    // A link without mass is refused at the end of the arm, and not where it carries mass.
    write(path, &description(0.0));
    assert!(config_of(path, "").is_ok());
    write(path, &description(2.0).replace("<mass value=\"1\"/>", "<mass value=\"0\"/>"));
    let text = error(path, "");
    assert!(text.contains("link3") && text.contains("[model] mass = "), "{text}");
    write(path, &description(2.0).replace("</robot>", "<link name=\"f\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" \
        ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial></link><joint name=\"j\" type=\"revolute\"><parent link=\"link1\"/><child \
        link=\"f\"/><mimic joint=\"joint1\"/></joint></robot>"));
    let text = error(path, "joints = [\"joint2\", \"j\"]");
    assert!(text.contains("<mimic>") && text.contains("joints"), "{text}");
    let text = error(path, "lock = { joint4 = 0.5 }");
    assert!(text.contains("joint4") && text.contains("joint1, joint2, joint3, j"), "{text}");
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
