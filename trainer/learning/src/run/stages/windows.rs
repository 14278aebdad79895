//! The stages of a loss over windows.

use super::windowed::Windowed;
use super::{ALL_LOGS, NETWORKS, PART, PlanError, Scope, Stage, TRAINING, WARM_UP, shows_scale, torques};
use crate::config::{Config, OptimiserKind, TrainingConfig, TrainingLoss};
use crate::data::Dataset;
use crate::run::lengths;
use crate::run::notice::Notice;
use crate::training::{Objective, Residuals};
use crate::windows::{CalibrationLayout, WindowLogs, WindowLoss, WindowModel, WindowSettings};
use leastaction_models::Architecture;
use leastaction_models::config::Source;
use std::ops::Range;
use std::sync::Arc;

/// Length of the warm-up windows, as a fraction of a window: over so short a time motion is hardly chaotic, whatever
/// the initial weights.
const SHORT: f64 = 0.2;
/// Least number of steps in a warm-up window.
const FEWEST_STEPS: usize = 5;
/// Largest integration step of a model with dry friction, s: this friction changes quickly where a velocity changes its
/// sign.
const STIFF_STEP: f64 = 0.005;
/// Range of the longest integration step of other models, s; within this range the step of the samples is taken. If
/// samples are closer, a step covers as many as fit; if they are further apart, their step is subdivided.
const SMOOTH_STEP: [f64; 2] = [0.01, 0.025];

/// Number of windows above which they do not overlap: side by side they already use all samples, and overlap would
/// double the time.
const MANY_WINDOWS: usize = 2000;
/// Overlap of consecutive windows if there are fewer windows.
const OVERLAP: f64 = 0.5;

/// Largest number of windows that a stage before the last learns from. Many more hardly lead nearer to the numbers that all windows give.
const MOST_WINDOWS: usize = 512;
/// Largest number of windows from which the residuals of a fit to torques are shown.
const SHOWN_WINDOWS: usize = 128;
/// Relative decrease of the loss of a part of the windows below which all windows go on.
const ENOUGH_OF_A_PART: f64 = 1e-4;
/// Relative decrease of the loss of many windows below which they show nothing that matters.
const ENOUGH_OF_MANY: f64 = 5e-5;
/// Relative decrease of the loss below which an iteration does not change a comparison.
const ENOUGH_TO_COMPARE: f64 = 1e-4;
/// Largest number of held-back windows that judge an iteration.
const MOST_JUDGES: usize = 128;

/// The default overlap of windows of `steps` steps.
fn usual_overlap(data: &Dataset, steps: usize) -> f64 {
    let windows: usize = data.trajectories.iter().map(|trajectory| trajectory.samples() / steps).sum();
    if windows < MANY_WINDOWS { OVERLAP } else { 0.0 }
}

/// The stages of a loss over windows of the first `training` trajectories; the rest is held back.
///
/// # Errors
/// [`PlanError`] if no trajectory is as long as a window, or if the optimiser does not support windows.
pub(in crate::run) fn of_windows(
    (config, scope): (&Config, Scope),
    architecture: &Architecture,
    (data, training): (&Dataset, usize),
    notices: &mut Vec<Notice>,
) -> Result<(Vec<Stage>, Windowed), PlanError> {
    if config.training.optimiser != OptimiserKind::LevenbergMarquardt {
        return Err(PlanError::WindowOptimiser);
    }
    if !shows_scale(architecture, data) {
        notices.push(Notice::UnknownScale);
    }
    let windows = Windows::new((config, scope), architecture, data);
    let count = windows.logs.count();
    let held_back = match scope {
        Scope::Whole => training..count,
        Scope::Fold { .. } => count..count,
    };
    let mut spans: Vec<_> =
        windows.spans(scope).into_iter().map(|span| (span, 0..training, held_back.clone())).collect();
    if !held_back.is_empty() && !windows.of_torques {
        // The held-back logs have served to choose the weights; now the model learns from them, too.
        let iterations = scope.iterations(config.training.iterations);
        spans.push((windows.whole(ALL_LOGS, iterations), 0..count, 0..0));
    }
    let (mut stages, last) = (Vec::new(), spans.len());
    for (k, (span, of, judges)) in (1..).zip(spans) {
        if windows.of_torques && span.name == NETWORKS {
            let (part, iterations) = ((data, training), scope.iterations(config.training.iterations));
            stages.push(torques::networks((config, iterations), architecture, part, &windows.layout()?)?);
            continue;
        }
        let extent = if k < last || windows.of_torques { Extent::Part } else { Extent::All };
        let stage = windows.stage(span, extent, (of.clone(), judges.clone()))?;
        if span.name == TRAINING && stage.objective.samples() > MOST_WINDOWS {
            let part = Span { name: PART, ..span };
            stages.push(windows.stage(part, Extent::Part, (of, judges))?);
        }
        stages.push(stage);
    }
    let windowed = Windowed {
        settings: windows.settings(windows.steps),
        layout: windows.layout()?,
        shown: if windows.of_torques { SHOWN_WINDOWS } else { usize::MAX },
        ends_with_shown: held_back.is_empty() || !windows.of_torques,
        logs: windows.logs,
    };
    Ok((stages, windowed))
}

/// Windows that a stage learns from.
#[derive(Clone, Copy, PartialEq)]
enum Extent {
    /// At most as many as lead near to the numbers that all windows give.
    Part,
    All,
}

/// Name of a stage, number of steps in its windows, and its iteration limit.
#[derive(Clone, Copy)]
struct Span {
    name: &'static str,
    steps: usize,
    iterations: u64,
}

/// Logs cut into windows, and the model that is learned from them.
struct Windows<'a> {
    config: &'a Config,
    architecture: &'a Architecture,
    data: &'a Dataset,
    logs: Arc<WindowLogs>,
    /// Steps in a whole window.
    steps: usize,
    /// Whether correcting networks are learned after the model alone.
    adds_networks: bool,
    /// Whether numbers learned from torques are fitted beforehand, so that windows only add networks.
    of_torques: bool,
    /// Whether the result is only compared with others.
    compares: bool,
}

impl<'a> Windows<'a> {
    fn new((config, scope): (&'a Config, Scope), architecture: &'a Architecture, data: &'a Dataset) -> Self {
        let window = config.training.window.unwrap_or_else(|| lengths::usual(data));
        Self {
            logs: Arc::new(WindowLogs::new(data)),
            steps: lengths::steps(window, data.h),
            adds_networks: !architecture.corrections.is_none() && config.model.source() != Source::Weights,
            of_torques: config.training.loss == Some(TrainingLoss::Torque),
            compares: matches!(scope, Scope::Fold { .. }),
            config,
            architecture,
            data,
        }
    }

    fn whole(&self, name: &'static str, iterations: u64) -> Span {
        Span { name, steps: self.steps, iterations }
    }

    /// A warm-up over short windows where nothing is known of the weights, the training, and the networks beside the model.
    fn spans(&self, scope: Scope) -> Vec<Span> {
        let TrainingConfig { warm_up, iterations, .. } = self.config.training;
        let [warm_up, iterations] = [warm_up, iterations].map(|iterations| scope.iterations(iterations));
        let iterations = if self.of_torques { 0 } else { iterations };
        let short = ((SHORT * self.steps as f64).round() as usize).max(FEWEST_STEPS).min(self.steps);
        let warms_up = !self.of_torques
            && short < self.steps
            && warm_up > 0
            && self.config.model.source() == Source::Nothing;
        let warm_up = warms_up.then_some(Span { name: WARM_UP, steps: short, iterations: warm_up });
        let networks = self.adds_networks.then(|| self.whole(NETWORKS, iterations));
        warm_up.into_iter().chain([self.whole(TRAINING, iterations)]).chain(networks).collect()
    }

    fn settings(&self, steps: usize) -> WindowSettings {
        let TrainingConfig { overlap, integrator, order, .. } = self.config.training;
        let overlap = overlap.unwrap_or_else(|| usual_overlap(self.data, steps));
        let [least, most] = SMOOTH_STEP;
        let is_smooth = !self.architecture.group_laws.has_dry_friction();
        WindowSettings {
            steps,
            stride: ((1.0 - overlap) * steps as f64).round() as usize,
            integrator: integrator.unwrap_or_default(),
            longest_step: if is_smooth { self.data.h.clamp(least, most) } else { STIFF_STEP },
            order,
            calibration: self.config.calibration.calibration(),
        }
    }

    /// Positions of the learned sensor and actuator numbers.
    fn layout(&self) -> Result<CalibrationLayout, PlanError> {
        let calibration = self.config.calibration.calibration();
        Ok(CalibrationLayout::new(self.architecture.parameters()?, &self.logs, calibration))
    }

    /// The loss over windows of some of the logs; without networks, these stay as they begin.
    fn loss(&self, steps: usize, of: Range<usize>, with_networks: bool) -> Result<WindowLoss, PlanError> {
        let model = WindowModel::new(self.architecture)?;
        let model = if with_networks { model } else { model.with_known_corrections(self.architecture) };
        Ok(WindowLoss::new(model, &self.logs, of, self.settings(steps))?)
    }

    /// Largest number of windows of a stage before the last. A fit to torques shows its residuals over windows, and learns nothing from them.
    fn most(&self) -> usize {
        if self.of_torques { SHOWN_WINDOWS } else { MOST_WINDOWS }
    }

    /// The windows of these logs that a stage learns from, with the decrease of their loss below which it ends.
    fn extent(
        &self,
        span: Span,
        extent: Extent,
        of: Range<usize>,
        with_networks: bool,
    ) -> Result<WindowLoss, PlanError> {
        let loss = self.loss(span.steps, of, with_networks)?;
        let are_many = Residuals::samples(&loss) > MOST_WINDOWS;
        let enough = match extent {
            _ if self.compares => ENOUGH_TO_COMPARE,
            Extent::Part if are_many => ENOUGH_OF_A_PART,
            Extent::All if are_many => ENOUGH_OF_MANY,
            _ => 0.0,
        };
        let most = if extent == Extent::Part { self.most() } else { usize::MAX };
        Ok(loss.with_at_most(most).with_tolerance(enough))
    }

    /// A stage that learns from windows of some logs, and is judged by whole windows of others.
    fn stage(
        &self,
        span: Span,
        extent: Extent,
        (of, judges): (Range<usize>, Range<usize>),
    ) -> Result<Stage, PlanError> {
        // Networks are added only after the simple physics has been learned.
        let with_networks = !self.adds_networks || [NETWORKS, ALL_LOGS].contains(&span.name);
        let validation =
            (!judges.is_empty()).then(|| self.loss(self.steps, judges, with_networks)).transpose()?;
        let validation = validation.map(|loss| loss.with_at_most(MOST_JUDGES));
        let begins_with = (self.adds_networks && span.name == NETWORKS).then(|| {
            let first = self.architecture.corrections.initial_weights(self.config.training.seed);
            (self.architecture.corrections_start(), first)
        });
        Ok(Stage {
            name: span.name,
            begins_with,
            optimiser: self.config.training.optimiser,
            iterations: span.iterations,
            objective: Box::new(self.extent(span, extent, of, with_networks)?),
            validation: validation.map(|loss| Box::new(loss) as Box<dyn Objective>),
            judge: None,
        })
    }
}
