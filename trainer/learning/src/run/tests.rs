use super::*;
use crate::checkpoint::Trained;
use crate::config::{Config, TrainingLoss};
use crate::data::Dataset;
use crate::training::{Objective, StateNoise};
use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_ground_truth::{
    Drive, ManyBody, Mechanism, ModlanetSettings, Settings, generate, generate_many,
};
use leastaction_models::config::{Coordinates, InertiaNetworkConfig};

#[derive(Default)]
struct Silent {
    rows: Vec<Row>,
}

impl Monitor for Silent {
    fn row(&mut self, row: &Row) {
        self.rows.push(row.clone());
    }

    fn warning(&mut self, message: &str) {
        panic!("{message}");
    }
}

/// Collects the warnings of a run.
#[derive(Default)]
pub(super) struct Warned {
    rows: Vec<Row>,
    pub(super) warnings: Vec<String>,
}

impl Monitor for Warned {
    fn row(&mut self, row: &Row) {
        self.rows.push(row.clone());
    }

    fn warning(&mut self, message: &str) {
        self.warnings.push(message.to_owned());
    }
}

pub(super) fn data(trajectories: usize, control: bool) -> Dataset {
    noisy(trajectories, control, 0.0)
}

fn noisy(trajectories: usize, control: bool, noise: f64) -> Dataset {
    let drive = if control { Drive::Constant } else { Drive::Free };
    let settings =
        Settings { samples: 9, drive, noise, ..Settings::symo(Mechanism::Pendulum, trajectories, 0) };
    generate(&settings).unwrap()
}

pub(super) fn config() -> Config {
    let coordinates = Coordinates(vec![Coordinate::Angle]);
    let model = InertiaNetworkConfig { hidden: vec![5], ..InertiaNetworkConfig::new(coordinates) };
    let mut config = Config::new("nowhere.npz", model);
    config.training.order = 2;
    (config.training.iterations, config.training.warm_up) = (4, 2);
    config
}

#[test]
fn trajectories_are_held_back_whole_from_the_end() {
    for (trajectories, validation, expected) in
        [(8, 0.1, (7, 1)), (8, 0.25, (6, 2)), (2, 0.9, (1, 1)), (3, 0.0, (3, 0))]
    {
        let mut config = config();
        config.data.validation = validation;
        let plan = Plan::new(config, &data(trajectories, true)).unwrap();
        assert_eq!(plan.samples(), (7 * expected.0, 7 * expected.1), "{trajectories} {validation}");
        assert_eq!(plan.notices(), []);
    }
    assert_eq!(Plan::new(config(), &data(1, true)).unwrap().notices(), [Notice::NoValidation]);
}

#[test]
fn only_the_first_trajectories_are_used_where_so_asked() {
    let mut config = config();
    config.data.trajectories = Some(4);
    let plan = Plan::new(config, &data(9, true)).unwrap();
    assert_eq!(plan.samples(), (3 * 7, 7));
}

#[test]
fn without_force_there_is_no_warm_up_and_no_scale() {
    let free = data(4, false);
    let plan = Plan::new(config(), &free).unwrap();
    assert_eq!(plan.notices(), [Notice::UnknownScale, Notice::NoWarmUp]);
    assert_eq!(plan.iterations(), 4);
    let mut residual = config();
    residual.training.loss = Some(crate::training::LossKind::DelResidual.into());
    assert_eq!(Plan::new(residual, &free).err(), Some(PlanError::Unforced));
}

/// A free chain of pendulums, and a configuration for it.
fn chain(count: usize, trajectories: usize) -> (Dataset, Config) {
    let system = ManyBody::Pendulum(count);
    let settings = ModlanetSettings { trajectories, h: 0.01, ..ModlanetSettings::published(system, 0) };
    let model = InertiaNetworkConfig {
        hidden: vec![8],
        ..InertiaNetworkConfig::new(Coordinates(vec![Coordinate::Angle; count]))
    };
    (generate_many(&settings).unwrap(), Config::new("nowhere.npz", model))
}

#[test]
fn initial_weights_move_a_chain_of_many_joints_about_as_a_constant_velocity_does() {
    for count in [3, 4, 7, 12] {
        for seed in 0..3 {
            let (data, mut config) = chain(count, 4);
            config.training.seed = seed;
            let plan = Plan::new(config, &data).unwrap();
            let stage = plan.stages.last().unwrap();
            let (loss, constant) = (stage.objective.loss(&plan.initial), of_constant_velocity(&data));
            assert!(
                stage.objective.solved(&plan.initial).unsolved == 0 && loss < 10.0 * constant,
                "{count}: {loss} {constant}"
            );
        }
    }
}

/// Mean square of the error of a constant velocity, q₊ − q − (q − q₋).
fn of_constant_velocity(data: &Dataset) -> f64 {
    let [before, now, next] = crate::training::Samples::triples(data).states;
    let error = |k: usize| next[k] - 2.0 * now[k] + before[k];
    (0..now.len()).map(|k| error(k).powi(2)).sum::<f64>() / now.len() as f64
}

#[test]
fn free_motion_is_learned_from_a_part_of_the_samples_first() {
    let (data, mut config) = chain(3, 40);
    (config.training.iterations, config.training.warm_up) = (1, 12);
    let plan = Plan::new(config, &data).unwrap();
    assert_eq!(plan.notices(), [Notice::UnknownScale]);
    let [first, last] = &plan.stages[..] else { panic!("two stages") };
    assert_eq!(first.name, stages::WARM_UP);
    assert_eq!(first.objective.samples(), (4 * plan.parameters()).div_ceil(3));
    assert_eq!(last.objective.samples(), 36 * 99);
    let folder = tempfile::tempdir().unwrap();
    let mut run = Run::begin(plan, folder.path(), false).unwrap();
    run.train(&mut Silent::default(), &AtomicBool::new(false)).unwrap();
    let (error, constant) = (run.best().validation.unwrap(), of_constant_velocity(&data));
    assert!(error < 0.1 * constant, "{error} {constant}");
}

#[test]
fn a_force_in_a_trajectory_held_back_does_not_count() {
    let mut mixed = data(4, false);
    mixed.trajectories[3] = data(4, true).trajectories[3].clone();
    let mut residual = config();
    residual.training.loss = Some(crate::training::LossKind::DelResidual.into());
    assert_eq!(Plan::new(residual, &mixed).err(), Some(PlanError::Unforced));
}

#[test]
fn the_best_on_validation_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let mut run =
        Run::begin(Plan::new(config(), &data(6, true)).unwrap(), &folder.path().join("run"), false).unwrap();
    let mut monitor = Silent::default();
    assert_eq!(run.train(&mut monitor, &AtomicBool::new(false)).unwrap(), Ending::Iterations);
    let last_stage = monitor.rows.iter().filter(|row| row.stage == "training");
    let best = last_stage.min_by(|a, b| a.validation.unwrap().total_cmp(&b.validation.unwrap())).unwrap();
    assert_eq!((run.best().iteration, run.best().validation), (best.iteration, best.validation));
    let trained = Trained::read(&folder.path().join("run")).unwrap();
    assert_eq!(&trained.best, run.best());
}

/// Mean squared error of the next position if the last increment is repeated (20σ² for noise of standard deviation σ).
/// A model that knows the motion has an error of 6σ² or less.
fn of_repetition(data: &Dataset) -> f64 {
    let curve = |q: &crate::data::Rows, k: usize| (q[k][0] - 2.0 * q[k + 1][0] + q[k + 2][0]).powi(2);
    let all = data.trajectories.iter().flat_map(|motion| (0..7).map(|k| curve(&motion.q, k)));
    all.sum::<f64>() / (7 * data.trajectories.len()) as f64
}

#[test]
fn noise_does_not_keep_the_next_position_from_being_learned() {
    const NOISE: f64 = 0.1;
    let (log, folder) = (noisy(40, true, NOISE), tempfile::tempdir().unwrap());
    for order in [2, 4] {
        let mut config = config();
        (config.training.order, config.training.iterations, config.training.warm_up) = (order, 10, 20);
        let path = folder.path().join(order.to_string());
        let mut run = Run::begin(Plan::new(config, &log).unwrap(), &path, false).unwrap();
        run.train(&mut Silent::default(), &AtomicBool::new(false)).unwrap();
        let (best, repeated) = (run.best(), of_repetition(&log));
        assert!(
            best.train < 8.0 * NOISE * NOISE && best.train < repeated,
            "{order}: {} {repeated}",
            best.train
        );
        assert!(best.validation.unwrap() < 8.0 * NOISE * NOISE, "{order}: {best:?}");
    }
}

#[test]
fn of_the_residual_the_weights_that_predict_best_are_kept() {
    let (log, folder) = (noisy(40, true, 0.1), tempfile::tempdir().unwrap());
    let mut config = config();
    (config.training.loss, config.training.iterations) =
        (Some(crate::training::LossKind::DelResidual.into()), 20);
    let mut run = Run::begin(Plan::new(config, &log).unwrap(), folder.path(), false).unwrap();
    let mut monitor = Warned::default();
    run.train(&mut monitor, &AtomicBool::new(false)).unwrap();
    if run.best().iteration == 0 {
        let nothing = "nothing was learned: no iteration was better than the initial weights";
        assert!(monitor.warnings.iter().any(|warning| warning == nothing), "{:?}", monitor.warnings);
    }
    // The Lagrangian with the smallest residual is far too small.
    let (best, last) = (run.best(), monitor.rows.last().unwrap());
    assert!(best.iteration < last.iteration && best.train > last.train, "{best:?} {last:?}");
    let judge = run.plan.stages[0].judge.as_ref().unwrap();
    let [kept, least] = [&best.weights[..], run.state.optimiser.weights()].map(|weights| judge.loss(weights));
    assert!(best.next_position == Some(kept) && kept < 0.9 * least, "{kept} {least}");
}

#[test]
fn a_stop_before_the_first_iteration_saves_the_initial_weights() {
    let folder = tempfile::tempdir().unwrap();
    let plan = Plan::new(config(), &data(3, true)).unwrap();
    let initial = plan.architecture.initial_weights(0);
    let mut run = Run::begin(plan, folder.path(), false).unwrap();
    assert_eq!(run.train(&mut Silent::default(), &AtomicBool::new(true)).unwrap(), Ending::Interrupted);
    assert_eq!(Trained::read(folder.path()).unwrap().best.weights, initial);
}

/// The data with positions multiplied by `factor`.
pub(super) fn scaled(factor: f64) -> Dataset {
    let mut data = data(3, true);
    for trajectory in &mut data.trajectories {
        trajectory.q = trajectory.q.map(|q| q * factor);
    }
    data
}

#[test]
fn a_step_that_cannot_be_solved_is_an_error_that_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let plan = Plan::new(config(), &scaled(1e11)).unwrap();
    assert!(matches!(plan.notices(), [Notice::Doubtful(crate::data::Doubt::Leap { .. }), ..]));
    let mut run = Run::begin(plan, folder.path(), false).unwrap();
    let error = run.train(&mut Silent::default(), &AtomicBool::new(false)).unwrap_err();
    assert!(matches!(error, RunError::Stuck { .. }), "{error}");
    let message = error.to_string();
    assert!(
        message.contains("look at the data first: q0 leaps") && !message.contains("warm_up"),
        "{message}"
    );
}

/// A step that no model could make is reported, and the model learns from the other steps.
#[test]
fn what_cannot_be_solved_is_counted_and_said() {
    let (mut log, folder) = (data(8, true), tempfile::tempdir().unwrap());
    let mut at = 0;
    log.trajectories[0].q = log.trajectories[0].q.map(|q| {
        at += 1;
        if at == 9 { q + 1e11 } else { q }
    });
    let mut run = Run::begin(Plan::new(config(), &log).unwrap(), folder.path(), false).unwrap();
    let mut monitor = Warned::default();
    run.train(&mut monitor, &AtomicBool::new(false)).unwrap();
    assert!(run.best().train.is_finite() && run.best().iteration > 0, "{:?}", run.best());
    let said = |warning: &String| warning.contains("1 of 49 training samples cannot be solved");
    assert!(monitor.warnings.iter().any(said), "{:?}", monitor.warnings);
}

#[test]
fn numbers_that_stand_for_none_are_refused() {
    let error = Plan::new(config(), &scaled(1e300)).err().unwrap().to_string();
    assert!(
        error.contains("look for a sensor that failed there, or for a number that stands for none"),
        "{error}"
    );
}

#[test]
fn numbers_that_the_loss_does_not_read_are_only_told_of() {
    let mut data = data(3, true);
    for trajectory in &mut data.trajectories {
        trajectory.v = trajectory.v.as_ref().map(|v| v.map(|_| -1e300));
    }
    let plan = Plan::new(config(), &data).unwrap();
    assert!(matches!(plan.notices(), [Notice::Doubtful(crate::data::Doubt::Value { field: "v", .. })]));
    let mut next_state = config();
    next_state.training.loss = Some(crate::training::LossKind::NextState.into());
    assert!(matches!(Plan::new(next_state, &data).err(), Some(PlanError::Data(_))));
}

/// The motion with angles wrapped to [−π, π).
fn wrapped(data: &Dataset) -> Dataset {
    use std::f64::consts::{PI, TAU};
    let mut data = data.clone();
    for trajectory in &mut data.trajectories {
        trajectory.q = trajectory.q.map(|q| (q + PI).rem_euclid(TAU) - PI);
    }
    data
}

#[test]
fn wrapped_angles_are_learned_from_as_straight_ones() {
    let mut straight = data(8, true);
    for trajectory in &mut straight.trajectories {
        // The motion goes through the upright position, which is now the seam.
        trajectory.q = trajectory.q.map(|q| q + std::f64::consts::PI);
    }
    let loss = |data: &Dataset| {
        let folder = tempfile::tempdir().unwrap();
        let plan = Plan::new(config(), data).unwrap();
        let notices = plan.notices().to_vec();
        let mut run = Run::begin(plan, folder.path(), false).unwrap();
        run.train(&mut Silent::default(), &AtomicBool::new(false)).unwrap();
        (run.best().train, notices)
    };
    let ((expected, none), (found, notices)) = (loss(&straight), loss(&wrapped(&straight)));
    assert!(none.is_empty() && matches!(notices[..], [Notice::Changed(_)]), "{notices:?}");
    assert!((found / expected - 1.0).abs() < 1e-3, "{found:e} {expected:e}");
}

#[test]
fn errors_of_writing_say_what_is_wrong() {
    let folder = || std::path::PathBuf::from("run");
    let both = |kind: io::ErrorKind| {
        let begun = RunError::Folder { folder: folder(), error: kind.into() };
        let saved = RunError::Save { folder: folder(), iteration: 5, saved: 4, error: kind.into() };
        [begun.to_string(), saved.to_string()]
    };
    for (kind, words) in [
        (io::ErrorKind::StorageFull, "free some space"),
        (io::ErrorKind::PermissionDenied, "have the permissions of the folder and its files changed"),
        (io::ErrorKind::ReadOnlyFilesystem, "have the disk made writable"),
        (io::ErrorKind::NotADirectory, "remove what stands in its place"),
    ] {
        for message in both(kind) {
            assert!(message.contains(words), "{kind}: {message}");
            assert_eq!(message.contains("space"), kind == io::ErrorKind::StorageFull, "{kind}: {message}");
        }
    }
}

#[test]
fn noisy_states_are_learned_beside_the_weights_and_not_kept() {
    let mut config = config();
    config.training.state_noise = Some(StateNoise { q: 0.01, v: 0.01, a: 0.0 });
    let plan = Plan::new(config.clone(), &data(4, true)).unwrap();
    assert_eq!(plan.config.training.loss, Some(TrainingLoss::Acceleration));
    let trained = plan.train().unwrap();
    assert_eq!(trained.best.weights.len(), plan.parameters());
    assert!(trained.best.validation.is_some());
    for loss in [TrainingLoss::NextPosition, TrainingLoss::Windows] {
        config.training.loss = Some(loss);
        let error = Plan::new(config.clone(), &data(4, true)).err();
        assert_eq!(error, Some(PlanError::StateNoise));
    }
}

/// Correcting networks are added after the model alone has been learned, at first without effect.
#[test]
fn networks_that_correct_come_after_the_model_alone() {
    let mut config = config();
    (config.training.loss, config.training.window) = (Some(TrainingLoss::Windows), Some(0.2));
    config.model = config.model.with_networks(true, true).unwrap();
    let plan = Plan::new(config, &data(6, true)).unwrap();
    let names: Vec<_> = plan.stages.iter().map(|stage| stage.name).collect();
    assert_eq!(names, ["training", "networks", "all logs"]);
    let start = plan.architecture.corrections_start();
    assert_eq!(plan.initial[start..], plan.architecture.corrections.without_effect());
    let mut state = State::new(&plan).unwrap();
    while state.iterate(&plan.stages[0]).0 == Progress::Lower {}
    let count = plan.architecture.corrections.count();
    let numbers = |state: &State| state.best.weights[start..start + count].to_vec();
    assert_eq!(numbers(&state), plan.architecture.corrections.without_effect());
    assert!(state.next_stage(&plan));
    for _ in 0..4 {
        let _ = state.iterate(&plan.stages[1]);
    }
    assert_ne!(numbers(&state), plan.architecture.corrections.without_effect());
}

/// Stages before the last learn from a part of many windows, and few held-back windows judge them; the last learns from all.
#[test]
fn many_windows_are_learned_from_in_the_end() {
    let mut config = config();
    (config.training.loss, config.training.window) = (Some(TrainingLoss::Windows), Some(0.2));
    let data = data(1600, true);
    let of_plan = |validation: f64| -> Vec<(&str, usize, Option<usize>)> {
        config.data.validation = validation;
        let plan = Plan::new(config.clone(), &data).unwrap();
        let samples = |of: &Option<Box<dyn Objective>>| of.as_ref().map(|of| of.samples());
        let of = |stage: &Stage| (stage.name, stage.objective.samples(), samples(&stage.validation));
        plan.stages.iter().map(of).collect()
    };
    let mut stages = [0.0, 0.25].map(of_plan);
    let all = stages[0].pop().unwrap();
    assert_eq!((all.0, all.2), ("training", None));
    assert!(all.1 >= 1600, "{all:?}");
    assert_eq!(stages[0], [("part of the windows", 512, None)]);
    assert_eq!(stages[1], [("training", 512, Some(128)), ("all logs", all.1, None)]);
}
