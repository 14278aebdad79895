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
    let settings = AdapterSettings { numbers: Vec::new(), ..choice.settings.clone() };
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

/// Balance over the window that ends before a tick.
fn balance(
    chip: &Replica,
    settings: &AdapterSettings,
    (ticks, end): (&Ticks, usize),
) -> Result<Vec<f32>, AdaptationError> {
    let mut adaptation = chip.adaptation(settings)?;
    for k in end.saturating_sub(2 * usize::from(settings.half))..end {
        adaptation.take(ticks.at(k))?;
    }
    Ok(adaptation.findings().residuals().to_vec())
}
