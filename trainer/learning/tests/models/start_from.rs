//! A network that starts from a fit of rigid bodies.

use leastaction_core::model::TrainedStep;
use leastaction_ground_truth::robot::{
    Drives, Excitation, Joint, JointFriction, Linkage, Machine, RobotSettings, Sensors, StartSpread,
    robot_logs,
};
use leastaction_learning::checkpoint::Trained;
use leastaction_learning::config::{Config, ConfigError};
use leastaction_learning::data::Dataset;
use leastaction_learning::run::Plan;
use leastaction_learning::training::Objective;
use leastaction_learning::windows::{
    Calibration, Integrator, WindowLogs, WindowLoss, WindowModel, WindowSettings,
};
use leastaction_models::Architecture;
use leastaction_models::file::encode;
use std::path::Path;
use std::sync::Arc;

const NOISE: f64 = 0.01;
const GAIN: f64 = 1.25;

fn logs(noise: f64, seed: u64) -> Dataset {
    let joint =
        |mass, length, centre, inertia| Joint { mass, length, centre, inertia, rotor: 6.287e-5, gear: 6.0 };
    let joints = vec![joint(0.52346, 0.2, 0.2, 0.010949), joint(0.62557, 0.3, 0.25569, 0.009971)];
    let friction = |viscous, coulomb| JointFriction { viscous, coulomb, width: 0.2 };
    robot_logs(&RobotSettings {
        machine: Machine::Linkage(Linkage { gravity: 9.81, joints }),
        friction: vec![friction(0.005, 0.1), friction(0.002, 0.07)],
        sensors: Sensors { noise, ..Sensors::default() },
        drives: Drives { gain: vec![GAIN; 2], delay: 0.0, noise: 0.0, driven: vec![true; 2] },
        excitation: Excitation { sines: 3, frequency: [0.3, 2.5], amplitude: [0.1, 0.35] },
        start: StartSpread::default(),
        logs: 3,
        samples: 121,
        h: 0.01,
        seed,
    })
    .unwrap()
    .measured()
}

fn trained(text: &str, folder: &Path, data: &Dataset) -> Trained {
    let file = folder.join("config.toml");
    std::fs::write(&file, text).unwrap();
    Plan::new(Config::read(&file).unwrap(), data).unwrap().train().unwrap()
}

const BODIES: &str = r#"
[data]
file = "logs.csv"
[model]
family = "bodies"
chain = 2
friction = { viscous = "learned", coulomb = "learned" }
[training]
loss = "windows"
iterations = 6
"#;

fn network(model: &str, iterations: usize) -> String {
    format!(
        "[data]\nfile = \"logs.csv\"\n[model]\ncoordinates = [\"angle\", \"angle\"]\nhidden = [10]\n{model}\n[training]\nloss = \
         \"windows\"\niterations = {iterations}\nwarm_up = 4\n"
    )
}

/// The error of positions over windows of noise-free logs, rad.
fn error(Trained { architecture, best, .. }: &Trained) -> f64 {
    let settings = WindowSettings {
        steps: 100,
        stride: 100,
        integrator: Integrator::RungeKutta,
        longest_step: 0.005,
        order: 4,
        calibration: Calibration::default(),
    };
    let data = logs(0.0, 2);
    let of = Arc::new(WindowLogs::new(&data));
    let model = WindowModel::new(architecture).unwrap();
    let loss = WindowLoss::new(model, &of, 0..data.trajectories.len(), settings).unwrap();
    Objective::held_back_loss(&loss, &best.weights).sqrt()
}

#[test]
fn a_network_learns_faster_from_where_bodies_are() {
    let (folder, data) = (tempfile::tempdir().unwrap(), logs(NOISE, 1));
    let bodies = trained(BODIES, folder.path(), &data);
    let file = encode(&bodies.architecture, &bodies.best.weights, None::<TrainedStep>, "bodies").unwrap();
    std::fs::write(folder.path().join("bodies.postcard"), file).unwrap();

    // Before any iteration the network has the inertia and the friction of the bodies.
    let text = network("start_from = \"bodies.postcard\"", 0);
    let begun = trained(&text, folder.path(), &data);
    let (own, theirs) = (masses(&begun), masses(&bodies));
    let size = theirs.iter().fold(0.0_f64, |most, m| most.max(m.abs()));
    assert!(own.iter().zip(&theirs).all(|(a, b)| (a - b).abs() < 0.02 * size), "{own:?} {theirs:?}");
    let friction = |of: &Trained| of.architecture.friction_of_coordinates(&of.best.weights);
    for (own, theirs) in friction(&begun).iter().zip(friction(&bodies)) {
        assert!((own.viscous - theirs.viscous).abs() < 1e-6, "{own:?} {theirs:?}");
        let constant = |of: &leastaction_models::CoordinateFriction| of.dry.unwrap().constant;
        assert!((constant(own) - constant(&theirs)).abs() < 1e-6, "{own:?} {theirs:?}");
    }

    let from_bodies = trained(&network("start_from = \"bodies.postcard\"", 2), folder.path(), &data);
    let friction = "friction = { viscous = \"learned\", coulomb = \"learned\" }";
    let from_random = trained(&network(friction, 6), folder.path(), &data);
    assert!(from_bodies.iterations < from_random.iterations / 2);
    let [own, random] = [&from_bodies, &from_random].map(error);
    assert!(own < random, "{own} and {random}");
}

/// Bodies whose numbers are those of a fit of the same bodies, but for one that is given.
#[test]
fn bodies_start_from_bodies() {
    let folder = tempfile::tempdir().unwrap();
    let data = logs(NOISE, 3);
    let first = trained(BODIES, folder.path(), &data);
    let file = encode(&first.architecture, &first.best.weights, None, "bodies").unwrap();
    std::fs::write(folder.path().join("bodies.postcard"), file).unwrap();
    let from = BODIES.replace("chain = 2", "chain = 2\nstart_from = \"bodies.postcard\"");
    let begun = trained(&from.replace("iterations = 6", "iterations = 0"), folder.path(), &data);
    for (own, theirs) in begun.best.weights.iter().zip(&first.best.weights) {
        assert!((own - theirs).abs() <= 1e-6 * theirs.abs(), "{own} {theirs}");
    }
    let heavy = from.replace("chain = 2", "gravity = [9.0, 0.0]\nchain = 2");
    let (architecture, weights) = beginning(&heavy, folder.path());
    let theirs = first.architecture.number_names().len();
    assert_eq!((architecture.number_names().len(), weights[0]), (theirs, 9.0));
    assert!((weights[5] - first.best.weights[5]).abs() < 1e-6 * weights[5].abs(), "{weights:?}");

    let side_by_side = from.replace("chain = 2", "bodies = [{}, {}]");
    let file = folder.path().join("other.toml");
    std::fs::write(&file, side_by_side).unwrap();
    let refused = Config::read(&file).unwrap_err().to_string();
    assert!(refused.contains("bodies.postcard holds another model than these bodies"), "{refused}");
}

/// Shape and weights that training of a configuration begins with.
fn beginning(text: &str, folder: &Path) -> (Architecture, Vec<f64>) {
    let file = folder.join("beginning.toml");
    std::fs::write(&file, text).unwrap();
    Config::read(&file).unwrap().beginning().unwrap()
}

fn masses(of: &Trained) -> Vec<f64> {
    let positions: [&[f64]; 3] = [&[0.2, -0.4], &[-0.5, 0.3], &[0.1, 0.8]];
    of.model().at_rest(&positions).unwrap().into_iter().flat_map(|at| at.mass).collect()
}

#[test]
fn what_cannot_be_started_from_is_refused_with_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let sliding = Config::parse(
        "[data]\nfile = \"logs.csv\"\n[model]\ncoordinates = [\"translation\"]\nhidden = [3]\n",
        Path::new("c.toml"),
    );
    let (architecture, weights): (Architecture, Vec<f64>) = sliding.unwrap().beginning().unwrap();
    let bytes = encode(&architecture, &weights, None::<TrainedStep>, "other").unwrap();
    std::fs::write(folder.path().join("other.postcard"), bytes).unwrap();
    for (name, says) in [("other.postcard", "coordinates \"t\""), ("nowhere.postcard", "nowhere.postcard")] {
        let file = folder.path().join("config.toml");
        std::fs::write(&file, network(&format!("start_from = \"{name}\""), 1)).unwrap();
        let error = match Config::read(&file) {
            Err(ConfigError::Invalid { line, message, .. }) => format!("{line}: {message}"),
            other => format!("{other:?}"),
        };
        assert!(error.contains(says) && error.starts_with("6:"), "{error}");
    }
}
