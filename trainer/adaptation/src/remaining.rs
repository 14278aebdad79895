//! Part of the balance that the numbers in use leave unexplained.

use crate::ticks::Ticks;
use crate::{AdaptationError, Choice, Course, on_chip};
use leastaction_data::Dataset;
use leastaction_models::Model;
use leastaction_replica::{AdapterSettings, Replica};

/// Balance of the model with the numbers in use at the end of every window, over this window, N or N m for every coordinate. The numbers then
/// in use follow from earlier windows alone, so that a small balance is a prediction.
///
/// # Errors
/// [`AdaptationError`].
pub fn remaining(
    model: &Model,
    choice: &Choice,
    data: &Dataset,
    course: &Course,
) -> Result<Vec<Vec<f32>>, AdaptationError> {
    // Nothing follows, and no change drops a window.
    let settings = AdapterSettings { numbers: Vec::new(), change: f32::INFINITY, ..choice.settings.clone() };
    let mut entries = course.entries.iter().peekable();
    let (mut remaining, mut begun) = (Vec::new(), 0);
    for trajectory in &data.trajectories {
        let ticks = on_chip(model, |chip| Ticks::new((model, chip), data, trajectory))?;
        let ended = |t: f64| ((t / data.h).round() as usize).saturating_sub(begun);
        while let Some(entry) = entries.next_if(|entry| ended(entry.t) <= ticks.len()) {
            let adapted = choice.adapted(model, &entry.applied)?;
            remaining.push(on_chip(&adapted, |chip| balance(chip, &settings, (&ticks, ended(entry.t))))?);
        }
        begun += ticks.len();
    }
    Ok(remaining)
}

/// Balance over the windows that end last before a tick, at which that of the last coordinate ends.
fn balance(
    chip: &Replica,
    settings: &AdapterSettings,
    (ticks, end): (&Ticks, usize),
) -> Result<Vec<f32>, AdaptationError> {
    let mut adaptation = chip.adaptation(settings)?;
    let half = usize::from(settings.half);
    // Windows of every coordinate end a tick after those of the one before; those of many coordinates take half a window more.
    let span = 2 * half + (settings.deviation.len() - 1) % half;
    let begin = end.checked_sub(span + half).unwrap_or(end.saturating_sub(span));
    for k in begin..end {
        adaptation.take(ticks.at(k))?;
    }
    Ok(adaptation.findings().residuals().to_vec())
}
