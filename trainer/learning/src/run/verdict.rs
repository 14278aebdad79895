//! Judgement of a finished run: whether its model is any better than a trivial one.

use super::doubt::{RanAway, ran_away};
use super::plan::Plan;
use super::report::calibrated;
use super::stages::Stage;
use crate::checkpoint::{Best, State};
use crate::evaluate::horizons::{HorizonErrors, Prediction, Predictions, Predictor};
use crate::torques::SplitErrors;
use crate::training::Objective;
use crate::windows::WindowLogs;
use std::fmt;

/// Least range of a coordinate during a prediction, relative to its range over all logs: a machine at rest judges
/// nothing.
const MOVES: f64 = 0.02;

/// A result of no use: no better than that of a trivial model, or with numbers that ran away.
#[derive(Clone, Debug, PartialEq)]
pub enum Poor {
    /// A learned number ran away.
    RanAway(RanAway),
    /// Torques are explained no better than by their mean.
    Torques {
        /// Mean over coordinates of mean squared error divided by variance; 1 or more.
        nmse: f64,
        /// Whether the trajectories were held back.
        held_back: bool,
    },
    /// Positions along logs are predicted no better than by a constant velocity, at any horizon.
    Positions {
        /// Horizon, s.
        seconds: f64,
        /// Median error of the model, m or rad.
        model: f64,
        /// Median error of a constant velocity, m or rad.
        constant_velocity: f64,
    },
    /// Samples are explained no better than by a motion of constant velocity.
    Samples {
        /// Mean squared residual of the model.
        model: f64,
        /// Mean squared residual of a constant velocity.
        constant_velocity: f64,
        /// Whether the samples were held back.
        held_back: bool,
    },
}

impl fmt::Display for Poor {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let of = |held_back: bool| if held_back { "held-back trajectories" } else { "the training data" };
        match self {
            Self::RanAway(number) => number.fmt(f),
            Self::Torques { nmse, held_back } => write!(
                f,
                "the torques of {} are explained worse than by their mean: squared error {nmse:.3} times the variance",
                of(*held_back)
            ),
            Self::Positions { seconds, model, constant_velocity } => write!(
                f,
                "the motion is predicted no better than by a constant velocity: after {seconds} s the model is {model:.2e} off \
                 (m or rad, median), a constant velocity {constant_velocity:.2e}"
            ),
            Self::Samples { model, constant_velocity, held_back } => write!(
                f,
                "{} are explained no better than by a constant velocity: mean squared error {model:.2e}, that of a constant velocity \
                 {constant_velocity:.2e}",
                of(*held_back)
            ),
        }
    }
}

/// The judgement of the best weights of a run, which have these torque errors if torques are the loss; `None` if they
/// are better than a trivial model, or if nothing can be compared.
pub(super) fn verdict(plan: &Plan, state: &State, torques: Option<&SplitErrors>) -> Option<Poor> {
    if let Some(number) = ran_away(plan, state) {
        return Some(Poor::RanAway(number));
    }
    if let Some(errors) = torques {
        return of_torques(errors);
    }
    if let Some((model, zeros)) = calibrated(plan, state) {
        let logs = &plan.windows.as_ref()?.logs;
        return of_positions(&Predictor { model: &model, zeros: &zeros, logs });
    }
    of_samples(plan.stages.get(state.stage)?, &state.best)
}

fn of_torques(errors: &SplitErrors) -> Option<Poor> {
    let judged = errors.held_back.as_ref().unwrap_or(&errors.train);
    let held_back = errors.held_back.is_some();
    (judged.nmse >= 1.0).then_some(Poor::Torques { nmse: judged.nmse, held_back })
}

/// Compares at every horizon; a chaotic motion may lose at the longest.
fn of_positions(predictor: &Predictor) -> Option<Poor> {
    let predictions = predictor.predict_windows().ok()?;
    let moving = Predictions { windows: moving(&predictions, predictor.logs), ..predictions };
    let errors = moving.errors(predictor.logs);
    let is_better = |errors: &HorizonErrors| {
        Some(errors.model.first()?.median < errors.constant_velocity.first()?.median)
    };
    if errors.iter().any(|errors| is_better(errors) != Some(false)) {
        return None;
    }
    let first = errors.first()?;
    Some(Poor::Positions {
        seconds: first.seconds?,
        model: first.model.first()?.median,
        constant_velocity: first.constant_velocity.first()?.median,
    })
}

/// Predictions during which some coordinate moves.
fn moving(predictions: &Predictions, logs: &WindowLogs) -> Vec<Prediction> {
    let n = predictions.n;
    let range = |log: usize, first: usize, count: usize, i: usize| {
        let positions = || (first..first + count).map(|k| logs.position(log, k, i));
        positions().fold(f64::NEG_INFINITY, f64::max) - positions().fold(f64::INFINITY, f64::min)
    };
    let whole =
        |i: usize| (0..logs.count()).map(|log| range(log, 0, logs.samples(log), i)).fold(0.0, f64::max);
    let least: Vec<f64> = (0..n).map(|i| MOVES * whole(i)).collect();
    let moves = |own: &&Prediction| (0..n).any(|i| range(own.log, own.first, own.steps(n) + 1, i) > least[i]);
    predictions.windows.iter().filter(moves).cloned().collect()
}

/// Compares the loss that decided between weights.
pub(super) fn of_samples(stage: &Stage, best: &Best) -> Option<Poor> {
    let (objective, model, held_back): (&dyn Objective, f64, bool) = match (&stage.judge, &stage.validation) {
        (Some(judge), validation) => (&**judge, best.next_position?, validation.is_some()),
        (None, Some(validation)) => (&**validation, best.validation?, true),
        (None, None) => (&*stage.objective, best.train, false),
    };
    let constant_velocity = objective.loss_of_constant_velocity()?;
    // Exact logs of a machine at rest are explained by both.
    let is_poor = model >= constant_velocity && constant_velocity > 0.0;
    is_poor.then_some(Poor::Samples { model, constant_velocity, held_back })
}

#[cfg(test)]
mod tests {
    use super::super::tests::{Warned, config, data};
    use super::super::{Plan, Run};
    use super::*;
    use crate::config::TrainingLoss;
    use crate::data::Dataset;
    use crate::torques::TorqueErrors;
    use std::sync::atomic::AtomicBool;

    fn judged(data: &Dataset, loss: TrainingLoss, window: Option<f64>) -> Option<Poor> {
        let mut config = config();
        (config.training.loss, config.training.window) = (Some(loss), window);
        let folder = tempfile::tempdir().unwrap();
        let mut run =
            Run::begin(Plan::new(config, data).unwrap(), &folder.path().join("run"), false).unwrap();
        run.train(&mut Warned::default(), &AtomicBool::new(false)).unwrap();
        run.poor(None)
    }

    /// Positions that no mechanism moves through.
    fn without_a_law() -> Dataset {
        let mut data = data(6, true);
        let mut seed = 1_u64;
        for trajectory in &mut data.trajectories {
            trajectory.q = trajectory.q.map(|_| {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                0.02 * ((seed >> 40) as f64 / (1 << 24) as f64).powi(9)
            });
        }
        data
    }

    #[test]
    fn a_model_of_a_pendulum_is_good() {
        assert_eq!(judged(&data(6, true), TrainingLoss::NextPosition, None), None);
        assert_eq!(judged(&data(6, true), TrainingLoss::Windows, Some(0.4)), None);
    }

    #[test]
    fn a_model_of_motion_without_a_law_is_compared_with_constant_velocity() {
        let mut data = without_a_law();
        let logged = judged(&data, TrainingLoss::DelResidual, None);
        // Forces that have nothing to do with the motion.
        for trajectory in &mut data.trajectories {
            trajectory.u = trajectory.u.as_ref().map(|u| u.map(|u| 1e3 * u));
        }
        let forced = judged(&data, TrainingLoss::DelResidual, None);
        for poor in [logged, forced.clone()].into_iter().flatten() {
            let Poor::Samples { model, constant_velocity, .. } = poor else { panic!("{poor}") };
            assert!(model >= constant_velocity, "{poor}");
        }
        assert!(forced.is_some());
    }

    #[test]
    fn torques_worse_than_their_mean_are_poor() {
        let errors = |nmse: f64| TorqueErrors { nmse, rmse: vec![1.0], samples: 9 };
        let split =
            |train: f64, held: Option<f64>| SplitErrors { train: errors(train), held_back: held.map(errors) };
        assert_eq!(of_torques(&split(2.0, Some(0.5))), None);
        assert_eq!(of_torques(&split(0.5, Some(2.0))), Some(Poor::Torques { nmse: 2.0, held_back: true }));
        assert_eq!(of_torques(&split(1.0, None)), Some(Poor::Torques { nmse: 1.0, held_back: false }));
    }
}
