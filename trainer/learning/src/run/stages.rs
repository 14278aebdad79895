//! The stages of a run, each with its loss.

mod torques;
mod windowed;
mod windows;

pub(super) use windowed::Windowed;
pub(super) use windows::of_windows;

use super::TorqueError;
use super::notice::Notice;
use super::plan::{PlanError, is_forced};
use crate::config::{Config, OptimiserKind, TrainingConfig};
use crate::data::Dataset;
use crate::torques::filtered;
use crate::training::{LossKind, Objective, Samples, free_states_objective, objective};
use leastaction_models::config::Source;
use leastaction_models::{Architecture, GraphArchitecture};

/// Purpose of a plan; the stages depend on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scope {
    /// A run. Its held-back trajectories judge every iteration; in the last stage it learns from them, too.
    Whole,
    /// A fold: a short training that suffices to compare configurations.
    Fold {
        /// Number of training trajectories; the rest judges the result.
        training: usize,
        /// Whether it starts from an earlier result, so that the initial weights do not matter.
        goes_on: bool,
    },
}

impl Scope {
    /// The number of iterations: as given for a run, limited for a fold.
    fn iterations(self, iterations: u64) -> u64 {
        match self {
            Self::Whole => iterations,
            Self::Fold { .. } => iterations.min(FOLD_ITERATIONS),
        }
    }
}

/// Largest number of iterations in a stage of a fold.
const FOLD_ITERATIONS: u64 = 12;

/// A stage of a run.
pub(super) struct Stage {
    /// Name in the history.
    pub name: &'static str,
    /// Position and values of parameters that replace those of the previous stage.
    pub begins_with: Option<(usize, Vec<f64>)>,
    /// Optimiser.
    pub optimiser: OptimiserKind,
    /// Iteration limit.
    pub iterations: u64,
    /// Loss over the training trajectories.
    pub objective: Box<dyn Objective>,
    /// Loss over the held-back trajectories.
    pub validation: Option<Box<dyn Objective>>,
    /// Loss that decides between weights, if it is not the minimised one: for the DEL residual, the error of the next
    /// position. Noise favours Lagrangians that are too small. Their residual is low, but they do not move as logged,
    /// or their step cannot be solved.
    pub judge: Option<Box<dyn Objective>>,
}

/// The stages of a loss over single samples.
///
/// # Errors
/// [`PlanError`] if the data lacks what the loss needs, or if calibration is to be learned.
pub(super) fn of_samples(
    (config, scope): (&Config, Scope),
    kind: LossKind,
    architecture: &Architecture,
    parts: (&Dataset, Option<&Dataset>),
    notices: &mut Vec<Notice>,
) -> Result<Vec<Stage>, PlanError> {
    if !config.calibration.is_default() {
        return Err(PlanError::Calibration);
    }
    if config.training.integrator.is_some() {
        return Err(PlanError::Integrator);
    }
    let scale = shows_scale(architecture, parts.0);
    let laws = architecture.family.graph().and_then(GraphArchitecture::laws_alone);
    let enough = enough_triples(parts.0, architecture.learned_parameters()?);
    let mut kinds = kinds((&config.training, kind), laws.is_some(), (scale, enough.is_some()), notices)?;
    let first = laws.map_or_else(|| architecture.clone(), Architecture::from);
    if config.model.source() != Source::Nothing {
        // A warm-up would replace trained weights by weights that are better only for the loss of the warm-up.
        kinds.retain(|(name, _)| *name != WARM_UP);
    }
    let shape = |name| if name == WARM_UP { &first } else { architecture };
    kinds
        .into_iter()
        .map(|(name, kind)| {
            let stage = stage((name, kind), &config.training, (shape(name), enough), parts)?;
            Ok(Stage { iterations: scope.iterations(stage.iterations), ..stage })
        })
        .collect()
}

/// Whether energies are determined absolutely, not only up to a common factor.
fn shows_scale(architecture: &Architecture, data: &Dataset) -> bool {
    is_forced(architecture, data) || architecture.family.shows_scale()
}

/// Name of the stage that learns the model, or all of it.
pub(super) const TRAINING: &str = "training";
/// Name of the stage that learns correcting networks together with the model, after the model alone.
pub(super) const NETWORKS: &str = "networks";
/// Name of the stage that learns from a part of many windows, before all of them are used.
pub(super) const PART: &str = "part of the windows";
/// Name of the last stage of a loss over windows, which adds the logs held back before.
pub(super) const ALL_LOGS: &str = "all logs";

/// Number of residual components per weight that a warm-up on the next position uses.
const WARM_UP_ROWS: usize = 4;

/// Number of triples that suffices for a warm-up, whose iterations then take proportionally less time; `None` if there
/// are not many more.
fn enough_triples(data: &Dataset, weights: usize) -> Option<usize> {
    let all: usize = data.trajectories.iter().map(|trajectory| trajectory.samples().saturating_sub(2)).sum();
    let count = (WARM_UP_ROWS * weights).div_ceil(data.n.max(1));
    (all > 2 * count).then_some(count)
}

/// The stages with their losses. `laws`: simple laws are learned before the networks beside them. `scale`: the scale of
/// L is determined, by a force or otherwise. `fewer`: a part of the samples suffices for a warm-up.
fn kinds(
    (training, loss): (&TrainingConfig, LossKind),
    laws: bool,
    (scale, fewer): (bool, bool),
    notices: &mut Vec<Notice>,
) -> Result<Vec<(&'static str, LossKind)>, PlanError> {
    match loss {
        LossKind::DelResidual if !scale => return Err(PlanError::Unforced),
        LossKind::Torque if !scale => return Err(PlanError::NoTorques),
        _ => (),
    }
    if !scale {
        notices.push(Notice::UnknownScale);
    }
    let mut kinds = vec![(TRAINING, loss)];
    let first = match loss {
        LossKind::NextPosition => Some(LossKind::DelResidual),
        loss => laws.then_some(loss),
    };
    if let Some(first) = first.filter(|_| training.warm_up > 0) {
        if scale || first != LossKind::DelResidual {
            kinds.insert(0, (WARM_UP, first));
        } else if fewer {
            kinds.insert(0, (WARM_UP, LossKind::NextPosition));
        } else {
            notices.push(Notice::NoWarmUp);
        }
    }
    Ok(kinds)
}

/// Name of the first of two stages.
pub(super) const WARM_UP: &str = "warm-up";

/// All samples of a loss.
fn samples(data: &Dataset, kind: LossKind, training: &TrainingConfig) -> Result<Samples, PlanError> {
    Ok(match kind {
        LossKind::Acceleration => Samples::accelerations(data)?,
        LossKind::NextState => Samples::next_states(data)?,
        LossKind::Torque => filtered(data, training.cut_off).map_err(TorqueError::from)?,
        LossKind::DelResidual | LossKind::NextPosition => Samples::triples(data),
    })
}

/// Builds the loss, at logged states or, with state noise, at free states near them.
fn build_objective(
    architecture: &Architecture,
    samples: Samples,
    (kind, order): (LossKind, u8),
    training: &TrainingConfig,
) -> Result<Box<dyn Objective>, PlanError> {
    let noise = training.state_noise.filter(|_| kind == LossKind::Acceleration);
    Ok(match noise {
        Some(noise) => free_states_objective(architecture, samples, noise)?,
        None => objective(architecture, samples, kind, order)?,
    })
}

/// Builds a stage; `enough` is the number of triples in a warm-up on the next position.
fn stage(
    (name, kind): (&'static str, LossKind),
    training: &TrainingConfig,
    (architecture, enough): (&Architecture, Option<usize>),
    (data, validation): (&Dataset, Option<&Dataset>),
) -> Result<Stage, PlanError> {
    let warm_up = name == WARM_UP;
    // The DEL residual of order 2 is explicit, and thus finite whatever the initial weights.
    let order = if warm_up && kind != LossKind::NextPosition { 2 } else { training.order };
    let mut own = samples(data, kind, training)?;
    if let Some(count) = enough.filter(|_| warm_up && kind == LossKind::NextPosition) {
        own = own.shuffled(0).range(0..count);
    }
    let build = |data: &Dataset, kind: LossKind, order: u8| -> Result<Box<dyn Objective>, PlanError> {
        build_objective(architecture, samples(data, kind, training)?, (kind, order), training)
    };
    // The loss after a warm-up must be finite on the training trajectories.
    let judges = validation.filter(|_| !warm_up).unwrap_or(data);
    let judge =
        (kind == LossKind::DelResidual).then(|| build(judges, LossKind::NextPosition, training.order));
    Ok(Stage {
        name,
        begins_with: None,
        optimiser: if warm_up { OptimiserKind::LevenbergMarquardt } else { training.optimiser },
        iterations: if warm_up { training.warm_up } else { training.iterations },
        objective: build_objective(architecture, own, (kind, order), training)?,
        validation: validation.map(|data| build(data, kind, order)).transpose()?,
        judge: judge.transpose()?,
    })
}
