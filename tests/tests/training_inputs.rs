//! Inputs that a model depends on: positions, controls and the seed; not threads, not logged velocities.

mod common;

use common::{config, log, model_file};
use leastaction_learning::config::Config;
use leastaction_learning::data::{self, Dataset, Rows};
use leastaction_learning::evaluate::one_step_mse;
use leastaction_learning::training::LossKind;
use leastaction_models::Beginning;
use leastaction_models::file::decode;

const WIDTH: u16 = 16;

fn with_threads(threads: usize) -> Config {
    let mut config = config(WIDTH, 4);
    config.training.warm_up = 4;
    config.training.threads = threads;
    config
}

/// Returns the same positions and controls with other velocities and accelerations, or none.
fn with_velocities(log: &Dataset, value: Option<f64>) -> Dataset {
    let mut log = log.clone();
    for trajectory in &mut log.trajectories {
        let other = value.map(|x| Rows::from_flat(2, vec![x; trajectory.q.as_flat().len()]).unwrap());
        (trajectory.v, trajectory.a) = (other.clone(), other);
    }
    log
}

#[test]
fn one_and_two_threads_give_the_same_bytes() {
    let log = log(16);
    assert_eq!(model_file(with_threads(1), &log), model_file(with_threads(2), &log));
}

#[test]
fn another_seed_gives_another_model() {
    let log = log(4);
    let mut other = with_threads(1);
    other.training.seed = 1;
    assert_ne!(model_file(with_threads(1), &log), model_file(other, &log));
}

#[test]
fn logged_velocities_do_not_enter_the_model() {
    let log = log(4);
    for loss in [LossKind::NextPosition, LossKind::DelResidual] {
        let mut config = with_threads(0);
        config.training.loss = Some(loss.into());
        let expected = model_file(config.clone(), &log);
        for value in [None, Some(0.0), Some(-1e300)] {
            assert_eq!(
                model_file(config.clone(), &with_velocities(&log, value)),
                expected,
                "{loss:?} {value:?}"
            );
        }
    }
}

#[test]
fn logged_velocities_do_not_enter_the_prediction() {
    let log = log(4);
    let model = decode(&model_file(with_threads(0), &log)).unwrap();
    for value in [None, Some(-1e300)] {
        let other = with_velocities(&log, value);
        for order in [2, 4] {
            let paths = |log| model.rollout(order, (log, Beginning::Positions)).unwrap();
            assert_eq!(paths(&log), paths(&other));
            let error = |log| one_step_mse(&model, order, log).unwrap().or_infinite();
            assert_eq!(error(&log).to_bits(), error(&other).to_bits());
        }
    }
}

/// A column of NaN velocities is a damaged log, whether or not the loss reads it.
#[test]
fn velocities_that_are_no_numbers_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("log.csv");
    std::fs::write(&file, "t,q,v\n0,0.1,nan\n0.1,0.2,1\n0.2,0.3,1\n").unwrap();
    let error = data::read(&file).unwrap_err().to_string();
    assert!(error.contains("line 2") && error.contains("column v"), "{error}");
}
