//! Coverage of standard errors over many simulated robots with known numbers.
//!
//! Long: `LEASTACTION_SEEDS=100 cargo test --release -p leastaction-learning --test models coverage -- --ignored --nocapture`

use leastaction_ground_truth::robot::{
    Drives, Excitation, Joint, JointFriction, Linkage, Machine, RobotSettings, Sensors, StartSpread,
    robot_logs,
};
use leastaction_learning::config::Config;
use leastaction_learning::run::Plan;
use leastaction_learning::training::Objective;
use leastaction_learning::windows::{
    Calibration, Integrator, Setting, Shown, WindowLogs, WindowLoss, WindowModel, WindowSettings, certainty,
};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

const H: f64 = 0.01;
/// Default number of robots.
const FEW_SEEDS: u64 = 2;
const LOGS: usize = 26;
const FRICTION: [JointFriction; 2] = [
    JointFriction { viscous: 0.005, coulomb: 0.1, width: 0.2 },
    JointFriction { viscous: 0.002, coulomb: 0.07, width: 0.2 },
];
const DELAY: f64 = 0.013;
const CONFIGURATION: &str = r#"
[data]
file = "simulated.csv"
[model]
family = "bodies"
chain = 2
friction = { viscous = "learned", coulomb = "learned" }
[calibration]
zero = "learned"
delay = "learned"
[training]
loss = "windows"
"#;

fn robot(seed: u64) -> RobotSettings {
    let joint =
        |mass, length, centre, inertia| Joint { mass, length, centre, inertia, rotor: 6.287e-5, gear: 6.0 };
    let joints = vec![joint(0.52346, 0.2, 0.2, 0.010949), joint(0.62557, 0.3, 0.25569, 0.009971)];
    RobotSettings {
        machine: Machine::Linkage(Linkage { gravity: 9.81, joints }),
        friction: FRICTION.to_vec(),
        sensors: Sensors { noise: 1e-3, zeros: 0.02, ..Sensors::default() },
        drives: Drives { gain: vec![1.0; 2], delay: DELAY, noise: 0.0, driven: vec![true; 2] },
        excitation: Excitation { sines: 3, frequency: [0.3, 2.5], amplitude: [0.1, 0.35] },
        start: StartSpread::default(),
        logs: LOGS,
        samples: 201,
        h: H,
        seed,
    }
}

/// True value of a number; `None` for numbers that are shown in combination only. The chain's gear is 10: the rotor inertia that has the
/// same (g² − g)J is smaller.
fn truth(name: &str) -> Option<f64> {
    match name {
        "body 1: joint x in the parent" => Some(0.2),
        "body 1: inertia of the rotor" => Some(6.287e-5 * (36.0 - 6.0) / (100.0 - 10.0)),
        _ => {
            let (coordinate, number) = name.strip_prefix("coordinate ")?.split_once(": ")?;
            let own = FRICTION[coordinate.parse::<usize>().ok()?];
            match number {
                "viscous friction" => Some(own.viscous),
                "Coulomb friction" => Some(own.coulomb),
                _ => Some(own.width),
            }
        }
    }
}

/// Errors of a kind of number, each with its standard error and the half-width of its interval.
#[derive(Default)]
struct Kind(Vec<[f64; 3]>);

impl Kind {
    /// Fraction of errors within the interval, and ratio of the reported to the empirical standard deviation.
    fn summary(&self) -> [f64; 2] {
        let count = self.0.len() as f64;
        let covered = self.0.iter().filter(|[error, _, interval]| error.abs() <= *interval).count();
        let mean = |f: &dyn Fn(&[f64; 3]) -> f64| self.0.iter().map(f).sum::<f64>() / count;
        [covered as f64 / count, (mean(&|of| of[1] * of[1]) / mean(&|of| of[0] * of[0])).sqrt()]
    }
}

#[test]
#[ignore = "minutes"]
fn intervals_cover_the_truth() {
    let seeds =
        std::env::var("LEASTACTION_SEEDS").ok().and_then(|text| text.parse().ok()).unwrap_or(FEW_SEEDS);
    let mut kinds: BTreeMap<String, Kind> = BTreeMap::new();
    for seed in 0..seeds {
        let logs = robot_logs(&robot(seed)).unwrap();
        let data = logs.measured();
        let config = Config::parse(CONFIGURATION, Path::new("coverage.toml")).unwrap();
        let trained = Plan::new(config, &data).unwrap().train().unwrap();
        let (architecture, found) = (&trained.architecture, trained.calibrated.as_ref().unwrap());
        let calibration = Calibration { zero: true, delay: Setting::Learned, ..Calibration::default() };
        let settings = WindowSettings {
            steps: 50,
            stride: 25,
            integrator: Integrator::RungeKutta,
            longest_step: 0.005,
            order: 4,
            calibration,
        };
        let model = WindowModel::new(architecture).unwrap();
        let loss = WindowLoss::new(model, &Arc::new(WindowLogs::new(&data)), 0..LOGS, settings).unwrap();
        let shared = [
            &trained.best.weights[..],
            &found.actuator.gain,
            &found.actuator.offset,
            &[found.actuator.delay],
            &found.zeros.concat(),
        ]
        .concat();
        let mut all = loss.enter(shared);
        for _ in 0..3 {
            loss.settle(&mut all);
            let _ = loss.completed_loss(&mut all);
        }
        let certainty = certainty(&loss, &all, &architecture.ranges()).unwrap();
        let (names, layout) = (architecture.number_names(), loss.layout());
        for number in &certainty.numbers {
            let known = match names.get(number.position) {
                Some(name) => name.as_ref().and_then(|name| Some((name.name.clone(), truth(&name.name)?))),
                None if number.position == layout.delay() => Some(("delay".to_owned(), DELAY)),
                None if number.position >= layout.zero(0, 0) => {
                    let k = number.position - layout.zero(0, 0);
                    Some((format!("zero {}", k % 2), logs.logs[k / 2].zeros[k % 2]))
                }
                None => None,
            };
            let (Some((name, truth)), Shown::Within(error)) = (known, number.shown) else { continue };
            let own = [number.value - truth, error, certainty.interval() * error];
            kinds.entry(name).or_default().0.push(own);
        }
    }
    for (name, kind) in &kinds {
        let [covered, ratio] = kind.summary();
        println!(
            "{name}: {:.1}% of {} covered, reported {ratio:.2} of empirical",
            100.0 * covered,
            kind.0.len()
        );
    }
    let numbers = |zeros: bool| {
        let own = kinds.iter().filter(move |(name, _)| name.starts_with("zero") == zeros);
        Kind(own.flat_map(|(_, kind)| kind.0.iter().map(|of| [of[0] / of[1], 1.0, of[2] / of[1]])).collect())
    };
    for (name, zeros) in [("numbers", false), ("zeros", true)] {
        let [covered, ratio] = numbers(zeros).summary();
        println!("all {name}: {:.1}% covered, ratio {ratio:.2}", 100.0 * covered);
        // Numbers of few robots are correlated, so the covered fraction may be lower.
        let least = if seeds > FEW_SEEDS { 0.9 } else { 0.6 };
        assert!(covered >= least, "{name}: {covered}");
    }
}
