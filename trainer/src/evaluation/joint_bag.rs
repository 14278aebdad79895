//! Measured and predicted motion as a bag of ROS 2, for Foxglove, `PlotJuggler` and Rerun.

use super::{Log, Tell};
use crate::cli::Failure;
use leastaction_learning::data::{Dataset, JointSample, JointTopic, Trajectory, write_bag};
use leastaction_learning::evaluate::horizons::{Prediction, Predictor};
use leastaction_learning::windows::WindowLogs;
use leastaction_models::Model;
use std::path::Path;

/// Length of a prediction, s.
const WINDOW: f64 = 1.0;
/// Time between trajectories whose stamps overlap, s.
const APART: f64 = 1.0;

/// Writes the topics `/measured`, `/predicted` and `/residual` (measured minus predicted). The model predicts over windows of one second, one
/// after the other, each from a parabola through seven positions and under the logged control. Trajectories whose stamps overlap are
/// put one after the other.
///
/// # Errors
/// [`Failure::Input`] if the model cannot be stepped, [`Failure::Work`] if the file cannot be written.
pub fn write(path: &Path, (file, model): (&Path, &Model), log: &Log, tell: Tell) -> Result<(), Failure> {
    let logs = WindowLogs::new(&log.data);
    let predictor = Predictor { model, zeros: &[], logs: &logs };
    let predictions = predictor.successive(WINDOW).map_err(|error| Failure::input(file, error))?;
    let delays = delays(&log.data);
    if delays.iter().any(|delay| *delay != 0.0) {
        tell(format!("trajectories whose stamps overlap are {APART} s apart in {}", path.display()));
    }
    let joints = joints(model, log);
    let topic = |name: &str, states: Vec<JointSample>| JointTopic {
        topic: name.to_owned(),
        joints: joints.clone(),
        states,
    };
    let motions = || log.data.trajectories.iter().zip(&delays);
    let measured = motions().flat_map(|(motion, delay)| measured(&log.data, motion, *delay)).collect();
    let of =
        |part: Part| predictions.iter().flat_map(|own| predicted(&log.data, &delays, own, part)).collect();
    let topics = [
        topic("/measured", measured),
        topic("/predicted", of(Part::Prediction)),
        topic("/residual", of(Part::Residual)),
    ];
    write_bag(path, &topics).map_err(|error| Failure::Work(error.to_string()))
}

/// Names of the coordinates: the joints of an arm, else the columns of the log, else q0, q1, …
fn joints(model: &Model, log: &Log) -> Vec<String> {
    let n = log.data.n;
    let of_arm = model.architecture.family.arm();
    let of_arm: Vec<String> =
        of_arm.into_iter().flat_map(|arm| &arm.bodies).map(|body| body.name.clone()).collect();
    let fits = |names: &Vec<String>| names.len() == n && names.iter().all(|name| !name.is_empty());
    let known = [of_arm, log.names.clone()].into_iter().find(fits);
    known.unwrap_or_else(|| (0..n).map(|i| format!("q{i}")).collect())
}

/// Time by which each trajectory is late in the bag, s, so that none overlaps another, nor begins before 0.
fn delays(data: &Dataset) -> Vec<f64> {
    let mut end = f64::NEG_INFINITY;
    let delay = |motion: &Trajectory| {
        let earliest = if end.is_finite() { end + APART } else { 0.0 };
        let is_free = motion.t0 >= 0.0 && motion.t0 > end;
        let delay = if is_free { 0.0 } else { earliest - motion.t0 };
        end = motion.t0 + delay + motion.samples() as f64 * data.h;
        delay
    };
    data.trajectories.iter().map(delay).collect()
}

/// A message for every sample.
fn measured(data: &Dataset, motion: &Trajectory, delay: f64) -> Vec<JointSample> {
    let sample = |(k, time): (usize, f64)| {
        let of = |rows: Option<&leastaction_learning::data::Rows>| {
            rows.and_then(|rows| rows.get(k)).unwrap_or_default().to_vec()
        };
        JointSample {
            time: time + delay,
            position: of(Some(&motion.q)),
            velocity: of(motion.v.as_ref()),
            effort: of(motion.u.as_ref()),
        }
    };
    data.times(motion).enumerate().map(sample).collect()
}

/// Part of a prediction.
#[derive(Clone, Copy, PartialEq)]
enum Part {
    Prediction,
    Residual,
}

/// A message for every sample after the start of a prediction, as far as it goes.
fn predicted(data: &Dataset, delays: &[f64], own: &Prediction, part: Part) -> Vec<JointSample> {
    let motion = &data.trajectories[own.log];
    let times: Vec<f64> = data.times(motion).collect();
    let rows = own.path.chunks_exact(data.n).enumerate().skip(1);
    let rows = rows.take_while(|(_, row)| row.iter().all(|x| x.is_finite()));
    let sample = |(k, row): (usize, &[f64])| {
        let k = own.first + k;
        let residual =
            || motion.q[k].iter().zip(row).map(|(measured, predicted)| measured - predicted).collect();
        let position = if part == Part::Prediction { row.to_vec() } else { residual() };
        JointSample { time: times[k] + delays[own.log], position, ..JointSample::default() }
    };
    rows.map(sample).collect()
}
