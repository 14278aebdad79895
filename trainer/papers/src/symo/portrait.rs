//! A long free motion in phase space, learned and exact (Figure 1).

use super::Case;
use crate::rollouts::UNSEEN;
use crate::task::TaskError;
use leastaction_ground_truth::{Drive, Mechanism, Settings, generate};
use leastaction_learning::data::Dataset;
use leastaction_models::{Beginning, Model};
use leastaction_plot::{Angle, Phase, Series, Stroke, phase_portrait};
use std::path::Path;

/// Number of steps of the motion.
const STEPS: usize = 4_000;
/// Draws the angle of the last coordinate and its rate along 4,000 steps of a motion that is in no data set; returns
/// the name of the file.
pub(super) fn draw(folder: &Path, name: &str, case: &Case, model: &Model) -> Result<String, TaskError> {
    let start = Settings {
        samples: STEPS + 2,
        drive: Drive::Free,
        ..Settings::symo(case.mechanism, 1, case.seed ^ UNSEEN)
    };
    let exact = generate(&start)?;
    let learned = model.rollout(case.order, (&exact, Beginning::Positions))?;
    let flat = |data: &Dataset| data.trajectories.first().map_or(Vec::new(), |run| run.q.as_flat().to_vec());
    let series = [
        Series::new("exact", points(&flat(&exact), &exact)).with_stroke(Stroke::Wide),
        Series::new("learned", points(&learned.concat(), &exact)),
    ];
    let is_double = case.mechanism == Mechanism::Acrobot;
    let x_label = if is_double { "angle of the second joint (rad)" } else { "angle (rad)" };
    let phase = Phase { x_label, y_label: "its rate (rad/s)", angle: Angle::Wrapped };
    let file = format!("{name}-portrait.svg");
    phase_portrait(&folder.join(&file), &format!("{name}: {STEPS} free steps"), phase, &series)?;
    Ok(file)
}

/// The last coordinate and its rate at every midpoint.
fn points(q: &[f64], data: &Dataset) -> Vec<(f64, f64)> {
    let last: Vec<f64> = q.chunks_exact(data.n).filter_map(|row| row.last().copied()).collect();
    last.windows(2).map(|pair| (0.5 * (pair[0] + pair[1]), (pair[1] - pair[0]) / data.h)).collect()
}
