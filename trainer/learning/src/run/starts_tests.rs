use super::tests::Warned;
use super::{Ending, Plan, Poor, Run};
use crate::checkpoint::State;
use crate::config::Config;
use crate::data::Dataset;
use leastaction_ground_truth::Mechanism;
use leastaction_ground_truth::robot::{
    Drives, Excitation, JointFriction, Machine, RobotSettings, Sensors, StartSpread, robot_logs,
};
use leastaction_models::parallel;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// Logs of two links with a drive at the elbow, whose fit with both masses known runs away from its first start.
fn logs() -> Dataset {
    let friction = |coulomb| JointFriction { viscous: 0.0, coulomb, width: 0.05 };
    robot_logs(&RobotSettings {
        machine: Machine::Named(Mechanism::Acrobot),
        friction: vec![friction(0.1), friction(0.07)],
        sensors: Sensors { noise: 1e-3, grid: 1.5e-3, ..Sensors::default() },
        drives: Drives { gain: vec![1.0; 2], delay: 0.006, noise: 0.0, driven: vec![false, true] },
        excitation: Excitation { sines: 3, frequency: [0.2, 1.5], amplitude: [1.0, 5.0] },
        start: StartSpread { q: 1.5, ..StartSpread::default() },
        logs: 5,
        samples: 151,
        h: 0.01,
        seed: 1,
    })
    .unwrap()
    .measured()
}

fn config() -> Config {
    let text = "[data]\nfile = \"logs.csv\"\n[model]\nfamily = \"bodies\"\n[[model.bodies]]\nmass = 1.0\n[[model.bodies]]\non = \
                0\nmass = 1.0\nat = [\"learned\", 0.0]\n[model.friction]\ncoulomb = \"learned\"\n[calibration]\ndelay = \
                \"learned\"\n[training]\nloss = \"windows\"\nwindow = 0.5\n";
    Config::parse(text, Path::new("c.toml")).unwrap()
}

/// The largest residual of a good fit, m or rad: the noise of the readings.
const GOOD: f64 = 1.5e-3;

#[test]
fn a_fit_that_ends_badly_begins_again_on_any_number_of_threads() {
    let data = logs();
    let on = |threads: usize| {
        let work = || Plan::new(config(), &data).unwrap().last_state().unwrap();
        parallel::threads(threads).unwrap().install(work)
    };
    let state = on(1);
    let State { start, earlier, best, .. } = &state;
    assert!(*start > 0 && earlier.is_none() && best.train.sqrt() < GOOD, "{start} {}", best.train);
    assert_eq!(state.best, on(3).best);
}

#[test]
fn a_fit_that_stays_bad_says_so() {
    let mut plan = Plan::new(config(), &logs()).unwrap();
    plan.further_starts = 0;
    let folder = tempfile::tempdir().unwrap();
    let mut run = Run::begin(plan, &folder.path().join("run"), false).unwrap();
    let mut monitor = Warned::default();
    let ending = run.train(&mut monitor, &AtomicBool::new(false)).unwrap();
    assert_eq!((ending, run.starts()), (Ending::RanAway, 1));
    assert!(matches!(run.poor(None), Some(Poor::RanAway(_))), "{:?}", run.poor(None));
    assert_eq!(run.warnings(), monitor.warnings);
    assert!(
        run.warnings().iter().any(|text| text.contains("times the noise of the logs")),
        "{:?}",
        run.warnings()
    );
    let page = std::fs::read_to_string(run.report().unwrap()).unwrap();
    assert!(page.contains("the fit ran away") && page.contains("times the noise of the logs"));
}

/// Stops a run after some iterations.
struct Stopping<'a>(&'a AtomicBool, u64);

impl super::Monitor for Stopping<'_> {
    fn row(&mut self, row: &super::Row) {
        self.0.store(row.iteration >= self.1, Ordering::Relaxed);
    }

    fn warning(&mut self, _: &str) {}
}

#[test]
fn a_run_resumed_from_a_later_start_gives_the_same_bits() {
    let (data, folder) = (logs(), tempfile::tempdir().unwrap());
    let whole = Plan::new(config(), &data).unwrap().last_state().unwrap();
    let (path, stop) = (folder.path().join("run"), AtomicBool::new(false));
    let mut run = Run::begin(Plan::new(config(), &data).unwrap(), &path, false).unwrap();
    let late = whole.iteration - 3;
    let ending = run.train(&mut Stopping(&stop, late), &stop).unwrap();
    assert_eq!((ending, run.state.start > 0), (Ending::Interrupted, true));
    drop(run);
    stop.store(false, Ordering::Relaxed);
    let mut run = Run::resume(Plan::new(config(), &data).unwrap(), &path).unwrap();
    let ending = run.train(&mut Stopping(&stop, u64::MAX), &stop).unwrap();
    assert_eq!(
        (ending, run.iteration(), run.starts()),
        (Ending::Converged, whole.iteration, whole.start + 1)
    );
    assert_eq!(run.best().train.to_bits(), whole.best.train.to_bits());
}
