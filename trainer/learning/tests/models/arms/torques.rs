//! Torque errors of models: with drives, with networks, with networks beside arms, and with partly known friction.

use super::{H, LEARNED, N, bodies, config_of, data, data_of, data_with, description, motion, robot, write};
use leastaction_learning::checkpoint::Trained;
use leastaction_learning::config::Config;
use leastaction_learning::data::{Dataset, Rows};
use leastaction_learning::run::{Monitor, Plan, Row, Run};
use leastaction_learning::torque::Samples;
use leastaction_learning::torque::fit::{Arm, JointNumbers};
use leastaction_learning::torques::torque_errors;
use leastaction_learning::training::{Samples as States, inverse_dynamics};
use leastaction_models::file::encode;
use leastaction_models::urdf::{Inertias, parse as parse_urdf};
use leastaction_models::{Actuator, Architecture, ArmArchitecture, Facts, GroupLaws, Model, Number};
use leastaction_programs::System;
use std::sync::atomic::AtomicBool;

struct Silent;

impl Monitor for Silent {
    fn row(&mut self, _: &Row) {}

    fn warning(&mut self, message: &str) {
        panic!("{message}");
    }
}

/// Single friction numbers can be known while the rest is learned.
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
    // The remaining error is the effect of the filter on friction that changes quickly.
    assert!(torque_errors(&trained.model(), &data_of(&robot), 20.0).unwrap().nmse < 1e-3);
}

/// The way on which friction at rest turns is that of the log, if the configuration gives no width.
#[test]
fn friction_at_rest_turns_on_the_way_that_the_log_shows() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &description(2.6));
    let widths_of = |truth: f64, rest: &str| {
        let mut robot = robot();
        robot.joints.iter_mut().for_each(|joint| joint.width = truth);
        let mut data = data_of(&robot);
        for log in &mut data.trajectories {
            let t = (0..log.q.len()).map(|k| k as f64 * H).collect();
            let (q, v) = (log.q.clone(), log.v.clone().unwrap());
            let a =
                Rows::from_rows(N, (0..q.len()).map(|k| motion(log.id as usize, k as f64 * H)[2])).unwrap();
            let samples = Samples { t, tau: q.clone(), q, v, a }.with_friction_at_rest(&[truth; N]);
            log.u = Rows::from_flat(N, robot.torques(&samples));
        }
        let rest = format!(
            "[model.friction]\nviscous = \"learned\"\ncoulomb = \"sticking\"\n{rest}\n[calibration]\noffset = \"learned\""
        );
        let trained = Plan::new(config_of(folder.path(), &rest).unwrap(), &data).unwrap().train().unwrap();
        let friction = trained.architecture.friction_of_coordinates(&trained.best.weights);
        friction.iter().map(|own| own.dry.unwrap().width).collect::<Vec<_>>()
    };
    let (narrow, wide) = (widths_of(0.005, ""), widths_of(0.5, ""));
    for (narrow, wide) in narrow.iter().zip(&wide) {
        assert!((0.003..0.013).contains(narrow) && *wide > 3.9 * narrow, "{narrow} {wide}");
    }
    assert_eq!(widths_of(0.05, "width = 0.02"), [0.02; N]);
}

/// A network of the same coordinates, with the friction of an arm, learns from the same filtered motion, from scratch or from the arm.
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
    // The loss is in standard deviations of the torque, and friction does not depend on the load: inverse dynamics give the same error.
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

/// The shape of a robot with all numbers known.
fn known(robot: &Arm) -> Architecture {
    let numbers =
        |joint: &JointNumbers| [joint.coulomb, joint.load, joint.smoothing, joint.width].map(Number::known);
    let friction = GroupLaws::of_friction(
        robot.joints.iter().map(|joint| Number::known(joint.viscous)).collect(),
        robot.joints.iter().map(numbers).collect(),
    );
    let family =
        ArmArchitecture::new(&robot.tree, |_| false, |k| Number::known(robot.tree.rotors[k])).unwrap();
    Architecture { group_laws: friction, ..Architecture::from(family) }
}

/// Drives with a delay and another gain are judged by the forces that they make of the logged commands; if a coordinate is not driven,
/// there is no error.
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
    let actuator = Actuator { gain: vec![2.0; N], offset, delay: LATE as f64 * H, lag: 0.0 };
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

/// The programs' inverse dynamics equal the arm's, with friction that grows with the requested torque.
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

/// Air drag at one joint and a spring at another, which no number of an arm describes, are learned by networks under either loss.
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
    // The bodies are unchanged, and the page reports the torques of the whole model.
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
    // Over windows the networks start from the result of the arm alone.
    data = of(0.3);
    data.trajectories.truncate(2);
    let windows = "[training]\nloss = \"windows\"\nwindow = 0.4\nwarm_up = 0\niterations = 4";
    let (alone, both) = (nmse(windows, &data), nmse(&format!("{networks}\n{windows}"), &data));
    assert!(both < 0.5 * alone, "{alone} {both}");
    // Numbers that torques cannot determine are refused.
    let rest = format!("[calibration]\ngain = \"learned\"\n{networks}");
    let refused = Plan::new(config_of(folder.path(), &rest).unwrap(), &data).err().unwrap().to_string();
    assert!(refused.contains("learns offset alone"), "{refused}");
}
