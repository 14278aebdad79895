//! Signs that a fit has ended in nonsense: numbers that ran away, and residuals far above the noise of the logs.

use super::plan::Plan;
use super::verdict::of_samples;
use crate::checkpoint::State;
use leastaction_models::Architecture;
use std::fmt;

/// Value of a learned number, relative to the scale of its kind, from which on it counts as having run away.
const FURTHEST: f64 = 1e5;
/// Residual, relative to the noise of the logs, from which on the noise does not explain it.
const EXCESS: f64 = 5.0;
/// Residual, relative to the motion within a window, below which it does not matter.
const NEGLIGIBLE: f64 = 3e-3;

/// Residual, relative to the motion within a window, below which a fit follows the motion: the model may lack something, but its numbers are
/// not in the wrong place.
const NEAR: f64 = 0.03;

/// A learned number that ran away.
#[derive(Clone, Debug, PartialEq)]
pub struct RanAway {
    /// Name of the number.
    pub name: String,
    /// Unit of the number.
    pub unit: &'static str,
    /// Learned value.
    pub value: f64,
    /// Largest number of the same unit that was given or begun with.
    pub scale: f64,
}

/// Residuals of a fit over windows that the noise of the logs does not explain, m or rad, each the geometric mean over
/// coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unexplained {
    /// Root mean square of the residuals.
    pub residual: f64,
    /// Noise of the sensors.
    pub noise: f64,
    /// Motion within a window.
    pub motion: f64,
}

impl fmt::Display for RanAway {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { name, unit, value, scale } = self;
        write!(
            f,
            "the fit ran away: {name} became {value:.1e} {unit}, where the configuration has at most {scale:.1e} {unit}; no number of \
             this model means anything"
        )
    }
}

impl fmt::Display for Unexplained {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { residual, noise, motion } = self;
        write!(
            f,
            "the model is {residual:.1e} (m or rad) off within windows, {:.0} times the noise of the logs and {:.1}% of the motion: it \
             lacks something that moves the machine, such as friction, a delay or a body, or the fit has gone wrong",
            residual / noise,
            100.0 * residual / motion
        )
    }
}

/// Whether the fit has ended so badly that it is worth another start.
pub(super) fn is_bad(plan: &Plan, state: &State) -> bool {
    let worse_than_trivial = || plan.windows.is_none() && is_poor(plan, state);
    !state.best.is_a_model()
        || ran_away(plan, state).is_some()
        || unexplained(plan, state).is_some()
        || worse_than_trivial()
}

/// Whether no number ran away, and residuals are a small part of the motion.
pub(super) fn follows_the_motion(plan: &Plan, state: &State) -> bool {
    let is_near = |own: Unexplained| own.residual < NEAR * own.motion;
    ran_away(plan, state).is_none() && plan.windows.is_some() && unexplained(plan, state).is_none_or(is_near)
}

fn is_poor(plan: &Plan, state: &State) -> bool {
    plan.stages.get(state.stage).is_some_and(|stage| of_samples(stage, &state.best).is_some())
}

/// The learned number that ran away furthest, relative to its scale.
pub(super) fn ran_away(plan: &Plan, state: &State) -> Option<RanAway> {
    furthest(&plan.architecture, &plan.given, &state.best.weights)
}

/// The scale of numbers of a unit is the largest of those in `given`; the scale of inertias is at least that of masses,
/// at one metre.
fn furthest(architecture: &Architecture, given: &[f64], weights: &[f64]) -> Option<RanAway> {
    let (names, fixed) = (architecture.number_names(), architecture.fixed_positions());
    let unit_at = |k: usize| names.get(k).and_then(Option::as_ref).map(|name| name.unit);
    let largest = |unit: &str| {
        let of_unit = (0..given.len()).filter(|k| unit_at(*k) == Some(unit));
        of_unit.map(|k| given[k].abs()).fold(0.0, f64::max)
    };
    let scale = |unit: &str| largest(unit).max(if unit == "kg m²" { largest("kg") } else { 0.0 });
    let number = |k: usize| {
        let name = names[k].as_ref()?;
        let (scale, value) = (scale(name.unit), *weights.get(k)?);
        let far = scale > 0.0 && (value / scale).abs() > FURTHEST;
        far.then(|| RanAway { name: name.name.clone(), unit: name.unit, value, scale })
    };
    let learned = (0..names.len()).filter(|k| !fixed.contains(k));
    let part = |of: &RanAway| (of.value / of.scale).abs();
    learned.filter_map(number).max_by(|a, b| part(a).total_cmp(&part(b)))
}

/// The residuals of a fit over windows, if they are far above the noise of the logs; `None` for another loss.
pub(super) fn unexplained(plan: &Plan, state: &State) -> Option<Unexplained> {
    // Before the last stage the residuals may be those of shorter windows; numbers fitted to torques are not judged by windows.
    let is_last = state.stage + 1 == plan.stages.len();
    let windows = plan.windows.as_ref().filter(|_| is_last && plan.torques().is_none())?;
    let count = windows.logs.count();
    let mean = |of: Vec<f64>| (of.iter().map(|x| x.ln()).sum::<f64>() / of.len().max(1) as f64).exp();
    let noise = mean((0..windows.logs.n).map(|i| windows.logs.noise(0..count, i)).collect());
    let motion = mean(windows.logs.motions(windows.settings.steps));
    let residual = state.best.train.sqrt();
    let is_far = residual > EXCESS * noise && residual > NEGLIGIBLE * motion;
    is_far.then_some(Unexplained { residual, noise, motion })
}
