//! Free motion of the learned model compared with the true motion.

use super::Failure;
use leastaction_ground_truth::{Drive, Mechanism, Settings, generate};
use leastaction_learning::data::{Dataset, Trajectory};
use leastaction_learning::evaluate::integration_errors;
use leastaction_models::{Beginning, Model};
use leastaction_plot::{Angle, Phase, Series, Stroke, phase_portrait};
use serde::Serialize;
use std::path::Path;

/// Length of the predictions, s.
const SECONDS: f64 = 5.0;
const TRAJECTORIES: usize = 16;
/// Number of trajectories in the plot.
const SHOWN: usize = 4;

/// Comparison of the model's free motion with the true motion.
#[derive(Serialize)]
pub struct Forecast {
    /// Length of the predictions, s.
    pub seconds: f64,
    /// Number of random starts.
    pub trajectories: usize,
    /// Mean squared position error.
    pub mean: f64,
    /// Median over trajectories.
    pub median: f64,
}

/// Steps the model from the first two positions of unseen motions, and draws the phase plane of the last coordinate.
pub fn forecast(model: &Model, mechanism: Mechanism, seed: u64, picture: &Path) -> Result<Forecast, Failure> {
    let samples = (SECONDS / mechanism.step()).round() as usize + 2;
    let unseen = seed.wrapping_add(1);
    let settings =
        Settings { samples, drive: Drive::Free, ..Settings::symo(mechanism, TRAJECTORIES, unseen) };
    let truth = generate(&settings).map_err(|error| Failure::Work(error.to_string()))?;
    let order = model.facts.trained_step.map_or(4, |step| step.order.number());
    let learned = model
        .rollout(order, (&truth, Beginning::Positions))
        .map_err(|error| Failure::Work(error.to_string()))?;
    let errors = integration_errors(&learned, &truth);
    draw(picture, &truth, &learned)?;
    let trajectories = truth.trajectories.len();
    Ok(Forecast { seconds: SECONDS, trajectories, mean: errors.mean, median: errors.median })
}

fn draw(file: &Path, truth: &Dataset, learned: &[Vec<f64>]) -> Result<(), Failure> {
    let pairs = truth.trajectories.iter().zip(learned).take(SHOWN);
    let series: Vec<Series> = pairs.flat_map(|pair| curves(truth, pair)).collect();
    let phase = Phase { x_label: "θ (rad), upright at 0", y_label: "dθ/dt (rad/s)", angle: Angle::Wrapped };
    let title = format!("Free motion of the pole for {SECONDS} s: learned against true");
    phase_portrait(file, &title, phase, &series).map_err(|error| Failure::Work(error.to_string()))
}

/// The true and the learned curve of a trajectory.
fn curves(data: &Dataset, (truth, learned): (&Trajectory, &Vec<f64>)) -> [Series; 2] {
    let plane = |positions: &[f64]| phase_plane(positions, data.n, data.h);
    [
        Series::new("true", plane(truth.q.as_flat())).with_stroke(Stroke::Wide),
        Series::new("learned", plane(learned)),
    ]
}

/// The last coordinate, and its velocity by central differences.
fn phase_plane(positions: &[f64], n: usize, h: f64) -> Vec<(f64, f64)> {
    let last: Vec<f64> = positions.chunks_exact(n).filter_map(|q| q.last().copied()).collect();
    let ahead = last.iter().zip(last.iter().skip(1)).zip(last.iter().skip(2));
    ahead.map(|((before, q), after)| (*q, (after - before) / (2.0 * h))).collect()
}
