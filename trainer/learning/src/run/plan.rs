//! What a run does, from a configuration and data: the stages, each with its losses.

use super::fingerprint;
use super::notice::{Notice, prepared};
use super::{range, ringing};
use crate::architecture::{Architecture, BodiesArchitecture, Family, GraphArchitecture, ModularArchitecture};
use crate::config::{Config, ModelConfig, OptimiserKind, ShapeError, TrainingConfig};
use crate::data::{Dataset, Doubt, control_name};
use crate::training::{LossKind, Objective, SampleError, Samples, objective};
use leastaction_core::discrete::Order;
use leastaction_core::forces::ControlKind;
use leastaction_core::model::{CoordinateRange, ModelError, TrainedStep};
use thiserror::Error;

/// A run that cannot begin.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PlanError {
    /// The data has another number of coordinates than the model.
    #[error(
        "[model] coordinates names {model} coordinates, but the data has {data}; name every coordinate of q, in order"
    )]
    Coordinates {
        /// Of the model.
        model: usize,
        /// Of the data.
        data: usize,
    },
    /// The data has another number of coordinates than the tree.
    #[error(
        "[model] tree = {tree:?} has {model} coordinates, one after the other those of {elements}, but the data has {data}; name \
         the tree that the data is of, its elements in the order of q"
    )]
    Tree {
        /// What it is called.
        tree: String,
        /// Its elements.
        elements: String,
        /// Of the tree.
        model: usize,
        /// Of the data.
        data: usize,
    },
    /// The data has another number of coordinates than the graph.
    #[error(
        "[model] graph = {graph:?} has {model} coordinates, {dimension} of each node, but the data has {data}; name the graph that \
         the data is of, its nodes in the order of q"
    )]
    Graph {
        /// What it is called.
        graph: String,
        /// Coordinates of a node.
        dimension: usize,
        /// Of the graph.
        model: usize,
        /// Of the data.
        data: usize,
    },
    /// The data has another number of coordinates than there are bodies.
    #[error(
        "[model] has {model} bodies, one a coordinate, but the data has {data} coordinates; name the bodies in the order of q, or \
         set chain = {data}"
    )]
    Bodies {
        /// Of the model.
        model: usize,
        /// Of the data.
        data: usize,
    },
    /// Masses that nothing determines.
    #[error(
        "[[model.{types}]]: every mass of the {of} is learned, but no sample is forced (u is zero or missing), and free motion does \
         not show a common factor of all masses; give one type a known mass, as mass = 1.0, or log motion under a known force"
    )]
    Masses {
        /// The key of the types.
        types: &'static str,
        /// Tree or graph.
        of: &'static str,
    },
    /// The trees or graphs and their types cannot be.
    #[error("{0}")]
    Shape(#[from] ShapeError),
    /// A DEL-residual loss without any force.
    #[error(
        "no sample is forced (u is zero or missing), and without a force the DEL residual is least for L = 0, which is \
         no model; log motion under a known force, or set loss = \"next-position\""
    )]
    Unforced,
    /// The data lacks what the loss needs.
    #[error("{0}; add it to the data, or set loss = \"next-position\", which needs positions alone")]
    Samples(#[from] SampleError),
    /// The log and the configuration say different things of the control.
    #[error(
        "[data] control = {:?}, but the log says that its u is {stated} between samples; set control = {stated:?}, or leave it out",
        control_name(*.asked), stated = control_name(*.stated)
    )]
    Control {
        /// By the configuration.
        asked: ControlKind,
        /// By the log.
        stated: ControlKind,
    },
    /// The data holds a number that cannot be one.
    #[error("{0}")]
    Data(Doubt),
    /// The shape does not fit in itself or the data.
    #[error("[model]: {0}")]
    Model(#[from] ModelError),
}

/// One part of a run.
pub(super) struct Stage {
    /// In the history.
    pub name: &'static str,
    /// How it is minimised.
    pub optimiser: OptimiserKind,
    /// Iterations at most.
    pub iterations: u64,
    /// Over the training trajectories.
    pub objective: Box<dyn Objective>,
    /// Over those held back.
    pub validation: Option<Box<dyn Objective>>,
    /// What decides between weights, where it is another loss: of the DEL residual the error of the next position. Noise lowers the
    /// residual of a Lagrangian that is too small, by which nothing moves as logged, or no step can be solved.
    pub judge: Option<Box<dyn Objective>>,
}

/// Everything that a run is determined by.
pub struct Plan {
    pub(super) config: Config,
    pub(super) architecture: Architecture,
    /// What training begins with.
    pub(super) initial: Vec<f64>,
    pub(super) trained_step: Option<TrainedStep>,
    /// What the data covered, training and validation.
    pub(super) range: Vec<CoordinateRange>,
    /// Some positions of the data, for what is said of the trained model.
    pub(super) positions: Vec<Vec<f64>>,
    pub(super) data_fingerprint: u64,
    pub(super) stages: Vec<Stage>,
    notices: Vec<Notice>,
}

impl Plan {
    /// Splits the data and builds the losses.
    ///
    /// # Errors
    /// [`PlanError`]: the data and the configuration do not fit each other.
    pub fn new(config: Config, data: &Dataset) -> Result<Self, PlanError> {
        let (architecture, initial) = config.beginning()?;
        check_coordinates(&architecture, data)?;
        let (data, mut notices) = prepared(data, &config, &architecture)?;
        let parts = split(&data, config.data.validation, &mut notices);
        // A known friction is a known force.
        let forced = parts.0.is_forced() || architecture.friction.shows_scale();
        check_gauge(&architecture, forced)?;
        let scale = forced
            || architecture.modular().is_some_and(ModularArchitecture::shows_scale)
            || architecture.graph().is_some_and(GraphArchitecture::shows_scale)
            || architecture.bodies().is_some_and(BodiesArchitecture::shows_scale);
        let laws = architecture.graph().and_then(GraphArchitecture::laws_alone);
        let enough = enough_triples(&parts.0, architecture.learned_parameters()?);
        let mut kinds = kinds(&config.training, laws.is_some(), (scale, enough.is_some()), &mut notices)?;
        let first = laws.map_or_else(|| architecture.clone(), Architecture::from);
        if goes_on(&config) {
            // A warm-up would leave trained weights for ones that are better on another loss.
            kinds.retain(|(name, _)| *name != WARM_UP);
        }
        let stages = kinds
            .into_iter()
            .map(|(name, kind)| {
                let shape = if name == WARM_UP { &first } else { &architecture };
                stage((name, kind), &config.training, (shape, enough), &parts)
            })
            .collect::<Result<_, _>>()?;
        let TrainingConfig { loss, order, .. } = config.training;
        let step = |order| TrainedStep { order, h: data.h as f32, control: data.control_kind() };
        Ok(Self {
            initial,
            trained_step: Order::from_number(order).filter(|_| loss.is_discrete()).map(step),
            range: range::of(&architecture, &data),
            positions: ringing::positions(&data),
            data_fingerprint: fingerprint::of_data(&data, loss),
            stages,
            notices,
            config,
            architecture,
        })
    }

    /// What the user should know.
    pub fn notices(&self) -> &[Notice] {
        &self.notices
    }

    /// Samples of the last stage, in training and in validation.
    pub fn samples(&self) -> (usize, usize) {
        let last = self.stages.last();
        let validation = last.and_then(|stage| stage.validation.as_ref());
        (last.map_or(0, |stage| stage.objective.samples()), validation.map_or(0, |part| part.samples()))
    }

    /// Numbers in the weight block.
    pub fn parameters(&self) -> usize {
        self.architecture.parameters().unwrap_or(0)
    }

    /// Numbers in the weight block that training changes.
    pub fn learned_parameters(&self) -> usize {
        self.architecture.learned_parameters().unwrap_or(0)
    }

    /// Iterations of all stages.
    pub fn iterations(&self) -> u64 {
        self.stages.iter().map(|stage| stage.iterations).fold(0, u64::saturating_add)
    }
}

fn check_coordinates(architecture: &Architecture, data: &Dataset) -> Result<(), PlanError> {
    let (model, data) = (architecture.n(), data.n);
    match &architecture.family {
        _ if model == data => Ok(()),
        Family::Rigid(_) => Err(PlanError::Coordinates { model, data }),
        Family::Bodies(_) => Err(PlanError::Bodies { model, data }),
        Family::Graph(graph) => {
            let (graph, dimension) = (graph.graph()?.name.clone(), graph.dimension());
            Err(PlanError::Graph { graph, dimension, model, data })
        }
        Family::Modular(modular) => {
            let names =
                modular.kinds().filter_map(|kind| modular.types.get(kind)).map(|kind| kind.name.as_str());
            let (tree, elements) = (modular.tree_name().to_owned(), names.collect::<Vec<_>>().join(", "));
            Err(PlanError::Tree { tree, elements, model, data })
        }
    }
}

/// Refuses what free motion does not determine.
fn check_gauge(architecture: &Architecture, forced: bool) -> Result<(), PlanError> {
    let (types, of, open) = match &architecture.family {
        Family::Rigid(_) => return Ok(()),
        Family::Modular(modular) => ("types", "tree", modular.learns_every_mass()),
        Family::Graph(graph) => ("node_types", "graph", !graph.shows_scale()),
        Family::Bodies(bodies) => ("bodies", "tree", !bodies.shows_scale()),
    };
    if open && !forced { Err(PlanError::Masses { types, of }) } else { Ok(()) }
}

/// Whether training begins with trained weights.
fn goes_on(config: &Config) -> bool {
    matches!(&config.model, ModelConfig::Modular(modular) if modular.from.is_some())
}

/// Training and validation trajectories: of the latter the fraction, rounded, but at least one, from the end.
fn split(data: &Dataset, fraction: f64, notices: &mut Vec<Notice>) -> (Dataset, Option<Dataset>) {
    let count = data.trajectories.len();
    if fraction == 0.0 {
        return (data.clone(), None);
    }
    if count < 2 {
        notices.push(Notice::NoValidation);
        return (data.clone(), None);
    }
    let held_back = ((fraction * count as f64).round() as usize).clamp(1, count - 1);
    let (training, validation) = data.split(count - held_back);
    (training, Some(validation))
}

/// Residual components a weight that a warm-up on the next position takes.
const WARM_UP_ROWS: usize = 4;

/// How many triples are enough to begin with: an iteration costs as many times less. `None` where there are hardly more.
fn enough_triples(data: &Dataset, weights: usize) -> Option<usize> {
    let all: usize = data.trajectories.iter().map(|trajectory| trajectory.samples().saturating_sub(2)).sum();
    let count = (WARM_UP_ROWS * weights).div_ceil(data.n.max(1));
    (all > 2 * count).then_some(count)
}

/// The stages and their losses. `laws`: whether simple laws are learned before the networks beside them; `scale`: whether that of
/// L is known, by a force or otherwise; `fewer`: whether a part of the samples is enough to begin with.
fn kinds(
    training: &TrainingConfig,
    laws: bool,
    (scale, fewer): (bool, bool),
    notices: &mut Vec<Notice>,
) -> Result<Vec<(&'static str, LossKind)>, PlanError> {
    if !scale && training.loss == LossKind::DelResidual {
        return Err(PlanError::Unforced);
    }
    if !scale {
        notices.push(Notice::UnknownScale);
    }
    let mut kinds = vec![("training", training.loss)];
    let first = match training.loss {
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

/// The name of the first stage of two.
pub(super) const WARM_UP: &str = "warm-up";

/// All samples that a loss is over.
fn samples(data: &Dataset, kind: LossKind) -> Result<Samples, SampleError> {
    match kind {
        LossKind::Acceleration => Samples::accelerations(data),
        LossKind::NextState => Samples::next_states(data),
        LossKind::DelResidual | LossKind::NextPosition => Ok(Samples::triples(data)),
    }
}

/// `enough`: triples of a warm-up on the next position.
fn stage(
    (name, kind): (&'static str, LossKind),
    training: &TrainingConfig,
    (architecture, enough): (&Architecture, Option<usize>),
    (data, validation): &(Dataset, Option<Dataset>),
) -> Result<Stage, PlanError> {
    let warm_up = name == WARM_UP;
    // At order 2 the DEL residual is explicit, and so finite whatever the initial weights.
    let order = if warm_up && kind != LossKind::NextPosition { 2 } else { training.order };
    let mut own = samples(data, kind)?;
    if let Some(count) = enough.filter(|_| warm_up && kind == LossKind::NextPosition) {
        own = own.shuffled(0).range(0..count);
    }
    let build = |data: &Dataset, kind: LossKind, order: u8| -> Result<Box<dyn Objective>, PlanError> {
        Ok(objective(architecture, samples(data, kind)?, kind, order)?)
    };
    // The loss that follows a warm-up must be finite on the training trajectories.
    let judges = validation.as_ref().filter(|_| !warm_up).unwrap_or(data);
    let judge =
        (kind == LossKind::DelResidual).then(|| build(judges, LossKind::NextPosition, training.order));
    Ok(Stage {
        name,
        optimiser: if warm_up { OptimiserKind::LevenbergMarquardt } else { training.optimiser },
        iterations: if warm_up { training.warm_up } else { training.iterations },
        objective: objective(architecture, own, kind, order)?,
        validation: validation.as_ref().map(|data| build(data, kind, order)).transpose()?,
        judge: judge.transpose()?,
    })
}
