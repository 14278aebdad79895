//! Controls that change at every sample, held or linear in between, from the generator to the learned model.

use leastaction_core::forces::ControlKind::{self, Held, Linear};
use leastaction_core::forces::{System, Viscous};
use leastaction_ground_truth::{Drive, Exact, Mechanism, Settings, generate};
use leastaction_learning::checkpoint::Trained;
use leastaction_learning::config::Config;
use leastaction_learning::data::Dataset;
use leastaction_learning::evaluate::{one_step_mse, rollout_system};
use leastaction_learning::run::{Monitor, Plan, Row, Run};
use leastaction_learning::training::LossKind;
use leastaction_models::config::{Coordinates, InertiaNetworkConfig};
use std::sync::atomic::AtomicBool;

const KINDS: [ControlKind; 2] = [Held, Linear];

struct Silent;

impl Monitor for Silent {
    fn row(&mut self, _: &Row) {}

    fn warning(&mut self, message: &str) {
        panic!("{message}");
    }
}

fn log(kind: ControlKind, h: f64, trajectories: usize, seed: u64) -> Dataset {
    let settings = Settings::symo(Mechanism::Pendulum, trajectories, seed);
    generate(&Settings { drive: Drive::Changing(kind), h, samples: 20, ..settings }).expect("data")
}

fn as_kind(data: &Dataset, kind: ControlKind) -> Dataset {
    Dataset { control: Some(kind), ..data.clone() }
}

/// The exact mechanism, in short steps of order 4, reproduces the log only under the log's own kind of control.
#[test]
fn a_log_is_the_motion_under_its_kind_of_control() {
    let Exact::One(exact) = Mechanism::Pendulum.exact() else { panic!("one coordinate") };
    let system = System { lagrangian: exact, forces: Viscous { coefficients: [0.0] } };
    for kind in KINDS {
        let data = log(kind, 0.004, 3, 5);
        assert_eq!(data.control, Some(kind));
        let [own, other] = KINDS.map(|kind| {
            let runs = rollout_system(&system, 4, &as_kind(&data, kind));
            let pairs = runs.iter().zip(&data.trajectories);
            let errors = pairs.flat_map(|(run, t)| run.iter().zip(t.q.as_flat()).map(|(a, b)| (a - b).abs()));
            errors.fold(0.0, f64::max)
        });
        let (own, other) = if kind == Held { (own, other) } else { (other, own) };
        assert!(own < 1e-9 && other > 1e-6, "{kind:?}: {own:e}, taken for the other {other:e}");
    }
}

/// The logged acceleration is that under the control at the sample.
#[test]
fn accelerations_are_those_under_the_control_at_the_sample() {
    for kind in KINDS {
        for t in &log(kind, 0.1, 2, 1).trajectories {
            let [a, u] = [&t.a, &t.u].map(|rows| rows.as_ref().expect("logged"));
            for k in 0..t.samples() {
                let expected = 1.5 * 9.81 * t.q[k][0].sin() + 3.0 * u[k][0];
                assert!((a[k][0] - expected).abs() < 1e-12, "{kind:?}, sample {k}");
            }
        }
    }
}

/// The error on held-back motion of a model learned with the control kind `asked`.
fn learned(data: &Dataset, asked: ControlKind, (loss, order): (LossKind, u8)) -> f64 {
    let folder = tempfile::tempdir().expect("a folder");
    let coordinates = Coordinates(Mechanism::Pendulum.coordinates().to_vec());
    let model = InertiaNetworkConfig { hidden: vec![12], ..InertiaNetworkConfig::new(coordinates) };
    let mut config = Config::new("nowhere.npz", model);
    config.data.control = Some(asked);
    (config.training.loss, config.training.order) = (Some(loss.into()), order);
    (config.training.iterations, config.training.warm_up) = (40, 20);
    let (training, unseen) = Dataset { control: None, ..data.clone() }.split(24);
    let plan = Plan::new(config, &training).expect("a plan");
    let mut run = Run::begin(plan, folder.path(), false).expect("a run");
    run.train(&mut Silent, &AtomicBool::new(false)).expect("trains");
    let trained = Trained::read(folder.path()).expect("a checkpoint");
    if loss.is_discrete() {
        assert_eq!(trained.trained_step.map(|step| step.control), Some(asked));
    } else {
        return run.best().validation.expect("held back");
    }
    one_step_mse(&trained.model(), order, &as_kind(&unseen, asked))
        .expect("steps")
        .mean_square
        .expect("solved")
}

/// The error with the other kind of control is at least the given factor times that with the log's own kind, for held and for linear logs.
fn only_its_own_kind_is_learned(loss: (LossKind, u8), h: f64, factors: [f64; 2]) {
    for (kind, factor) in KINDS.into_iter().zip(factors) {
        let data = log(kind, h, 30, 2);
        let other = if kind == Held { Linear } else { Held };
        let [own, wrong] = [kind, other].map(|asked| learned(&data, asked, loss));
        assert!(wrong > factor * own, "{loss:?} {kind:?}: {own:e}, taken for the other {wrong:e}");
    }
}

#[test]
fn the_next_position_is_learned_under_its_own_kind_of_control() {
    only_its_own_kind_is_learned((LossKind::NextPosition, 4), 0.1, [1e6, 1e5]);
}

/// At order 2 the impulse of a step is halved between its ends, which is exact for a constant force; for a linear force the position is off
/// by h²(u₁ − u₀)/12m, half the error of assuming the other kind.
#[test]
fn the_midpoint_rule_knows_a_held_control_better() {
    only_its_own_kind_is_learned((LossKind::NextPosition, 2), 0.02, [1e5, 2.0]);
}

#[test]
fn the_residual_is_learned_under_its_own_kind_of_control() {
    only_its_own_kind_is_learned((LossKind::DelResidual, 4), 0.1, [1e6, 1e5]);
}

#[test]
fn the_next_state_is_learned_under_its_own_kind_of_control() {
    only_its_own_kind_is_learned((LossKind::NextState, 4), 0.1, [1e5, 1e5]);
}
