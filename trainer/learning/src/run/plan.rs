//! What a run does, from a configuration and data: the stages, each with its losses.

use super::fingerprint;
use super::notice::{Notice, prepared};
use super::origin::at_origin;
use super::stages::{self, Stage, Windowed};
use super::{TorqueError, TorqueReport, range, ringing, torques};
use crate::architecture::{Architecture, Family};
use crate::checkpoint::{Checkpoint, State, Trained};
use crate::config::{Config, OptimiserKind, Origin, ShapeError, TrainingConfig, TrainingLoss};
use crate::data::{Dataset, Doubt, control_name};
use crate::training::{LossKind, Progress, SampleError};
use crate::windows::{self, CalibrationLayout, Integrator, TooShort, WindowLogs, first_guess};
use leastaction_arms::fit::FitError;
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
    /// The data has another number of coordinates than the arm.
    #[error(
        "[model] urdf has {model} joints, in this order: {joints}; but the data has {data} coordinates; name the columns of all joints in \
         that order"
    )]
    Arm {
        /// Names of the joints.
        joints: String,
        /// Of the model.
        model: usize,
        /// Of the data.
        data: usize,
    },
    /// A loss of torques without torques.
    #[error(
        "an arm, and whatever has loss = \"torque\", is learned from the torques of its drives, and the data has none (u is zero or missing); \
         add them under [data.columns]"
    )]
    NoTorques,
    /// An arm that cannot be fitted to the torques.
    #[error("{0}")]
    Fit(#[from] FitError),
    /// A log that does not become samples of torques.
    #[error("{0}")]
    Torques(#[from] TorqueError),
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
    /// Only accelerations at noisy states are learned with them.
    #[error(
        "[training] state_noise takes loss = \"acceleration\" and optimiser = \"levenberg-marquardt\"; of noisy positions over time \
         loss = \"windows\" finds the states itself"
    )]
    StateNoise,
    /// Nothing to choose from.
    #[error("[data.columns] names no columns of u to choose from")]
    NoColumns,
    /// Only windows learn sensors and actuators.
    #[error("[calibration] is learned over windows; set [training] loss = \"windows\", or leave it out")]
    Calibration,
    /// Only over windows, of coordinates that can have them, networks are tried.
    #[error(
        "[training] try_networks: networks correct models of coordinates, which a graph has not, over windows; set loss = \"windows\", or \
         leave it out"
    )]
    Networks,
    /// Only windows are integrated.
    #[error("[training] integrator is of windows; set loss = \"windows\", or leave it out")]
    Integrator,
    /// Only Levenberg–Marquardt eliminates start states.
    #[error("loss = \"windows\" takes optimiser = \"levenberg-marquardt\"")]
    WindowOptimiser,
    /// No trajectory is as long as a window.
    #[error("[training] window: {0}")]
    Window(#[from] TooShort),
    /// The data holds a number that cannot be one.
    #[error("{0}")]
    Data(Doubt),
    /// The shape does not fit in itself or the data.
    #[error("[model]: {0}")]
    Model(#[from] ModelError),
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
    /// The model whose energies the initial weights are, where there is one.
    pub(super) origin: Option<Origin>,
    /// What a loss over windows learns from.
    pub(super) windows: Option<Windowed>,
    pub(super) stages: Vec<Stage>,
    notices: Vec<Notice>,
}

impl Plan {
    /// Splits the data and builds the losses.
    ///
    /// # Errors
    /// [`PlanError`]: the data and the configuration do not fit each other.
    pub fn new(mut config: Config, data: &Dataset) -> Result<Self, PlanError> {
        let (architecture, mut initial) = config.beginning()?;
        check_coordinates(&architecture, data)?;
        let (data, mut notices) = prepared(data, &config, &architecture)?;
        let loss = choose_loss(&mut config, &architecture, &data, &mut notices);
        check_state_noise(&config.training, loss)?;
        let training = split(&data, config.data.validation, &mut notices);
        // Bodies of an arm are found one by one, before any stage.
        let of_samples =
            loss.of_samples().filter(|kind| *kind != LossKind::Torque || architecture.arm().is_none());
        let (stages, windows) = match of_samples {
            Some(kind) => {
                let parts = data.split(training);
                let held_back = (!parts.1.trajectories.is_empty()).then_some(parts.1);
                check_gauge(&architecture, is_forced(&architecture, &parts.0))?;
                let parts = (&parts.0, held_back.as_ref());
                (stages::of_samples(&config, kind, &architecture, parts, &mut notices)?, None)
            }
            None => {
                check_gauge(&architecture, is_forced(&architecture, &data))?;
                let of = (&data, training);
                let (stages, windows) = stages::of_windows(&config, &architecture, of, &mut notices)?;
                if let Some(arm) = architecture.arm() {
                    let of = (&data, training);
                    let fitted = torques::fitted((&architecture, arm), &initial, of, &config)?;
                    initial = fitted.weights;
                    notices.push(Notice::Torques(fitted.report));
                    let begins = fitted.calibrated.iter();
                    initial.extend(begins.flat_map(|calibrated| windows.layout.initial_at(calibrated)));
                } else if let Some(stage) = stages.first() {
                    let logs = WindowLogs::new(&data.split(training).0);
                    initial = first_guess(&architecture, &logs, initial, &*stage.objective)?;
                }
                if !config.model.has_trained_networks() {
                    let numbers = architecture.corrections.without_effect();
                    let start = architecture.corrections_start();
                    initial.splice(start..start + architecture.corrections.count(), numbers);
                }
                (stages, Some(windows))
            }
        };
        let origin = config.model.origin()?;
        if let Some(origin) = &origin {
            initial = at_origin((&architecture, initial), &data, origin)?;
            let layout = windows.as_ref().map(|windows| windows.layout);
            initial.extend(layout.into_iter().flat_map(|layout| layout.initial_at(&origin.calibrated)));
        }
        let step = |order| TrainedStep { order, h: data.h as f32, control: data.control_kind() };
        let TrainingConfig { order, integrator, .. } = config.training;
        let has_step = loss.is_discrete() || integrator == Some(Integrator::Del);
        Ok(Self {
            initial,
            trained_step: Order::from_number(order).filter(|_| has_step).map(step),
            range: range::of(&architecture, &data),
            positions: ringing::positions(&data),
            data_fingerprint: fingerprint::of_data(&data, loss),
            origin,
            windows,
            stages,
            notices,
            config,
            architecture,
        })
    }

    /// What training ends with, in memory alone; `None` where no stage has a finite loss.
    pub fn train(&self) -> Option<Trained> {
        let trained = Trained::from(Checkpoint::new(self, &self.last_state()?));
        trained.best.is_a_model().then_some(trained)
    }

    /// The state that training ends in; `None` for a plan without stages.
    pub(super) fn last_state(&self) -> Option<State> {
        let mut state = State::new(self)?;
        while let Some(stage) = self.stages.get(state.stage) {
            let over = state.in_stage >= stage.iterations;
            if (over || state.iterate(stage).0 != Progress::Lower) && !state.next_stage(self) {
                break;
            }
        }
        Some(state)
    }

    /// Where what is learned of sensors and actuators is, among the numbers of a loss over windows.
    pub(super) fn calibration(&self) -> Option<CalibrationLayout> {
        self.windows.as_ref().map(|windows| windows.layout)
    }

    /// What the user should know.
    pub fn notices(&self) -> &[Notice] {
        &self.notices
    }

    /// How well an arm explains the torques that it was fitted to.
    pub(super) fn torques(&self) -> Option<&TorqueReport> {
        self.notices.iter().find_map(|notice| match notice {
            Notice::Torques(report) => Some(report),
            _ => None,
        })
    }

    /// Samples of the last stage, and those that judge.
    pub fn samples(&self) -> (usize, usize) {
        let judges = self.stages.iter().rev().find_map(|stage| stage.validation.as_ref());
        let last = self.stages.last().map_or(0, |stage| stage.objective.samples());
        (last, judges.map_or(0, |part| part.samples()))
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
        Family::Arm(arm) => {
            let joints = arm.bodies.iter().map(|body| body.name.as_str()).collect::<Vec<_>>().join(", ");
            Err(PlanError::Arm { joints, model, data })
        }
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

/// Whether a known force acts, as a known friction does.
pub(super) fn is_forced(architecture: &Architecture, data: &Dataset) -> bool {
    data.is_forced() || architecture.friction.shows_scale()
}

/// Refuses noisy states where they are not learned.
fn check_state_noise(training: &TrainingConfig, loss: TrainingLoss) -> Result<(), PlanError> {
    let takes = (loss, training.optimiser) == (TrainingLoss::Acceleration, OptimiserKind::LevenbergMarquardt);
    if takes || training.state_noise.is_none() { Ok(()) } else { Err(PlanError::StateNoise) }
}

/// Refuses what free motion does not determine.
fn check_gauge(architecture: &Architecture, forced: bool) -> Result<(), PlanError> {
    let (types, of, open) = match &architecture.family {
        Family::Rigid(_) => return Ok(()),
        Family::Modular(modular) => ("types", "tree", modular.learns_every_mass()),
        Family::Graph(graph) => ("node_types", "graph", !graph.shows_scale()),
        Family::Bodies(bodies) => ("bodies", "tree", !bodies.shows_scale()),
        // Only torques show them.
        Family::Arm(arm) => {
            return if arm.shows_scale() || forced { Ok(()) } else { Err(PlanError::NoTorques) };
        }
    };
    if open && !forced { Err(PlanError::Masses { types, of }) } else { Ok(()) }
}

/// How many trajectories are trained on; the others, from the end, are held back: the fraction, rounded, but at least one.
fn split(data: &Dataset, fraction: f64, notices: &mut Vec<Notice>) -> usize {
    let count = data.trajectories.len();
    if fraction == 0.0 {
        return count;
    }
    if count < 2 {
        notices.push(Notice::NoValidation);
        return count;
    }
    count - ((fraction * count as f64).round() as usize).clamp(1, count - 1)
}

/// What is minimised, which the configuration then says: what it says, or else windows where positions are noisy, and the next position.
fn choose_loss(
    config: &mut Config,
    architecture: &Architecture,
    data: &Dataset,
    notices: &mut Vec<Notice>,
) -> TrainingLoss {
    let training = &mut config.training;
    let of_noise = training.state_noise.map(|_| TrainingLoss::Acceleration);
    let of_torques = architecture.arm().map(|_| TrainingLoss::Torque);
    let chosen = training.loss.or(of_noise).or(of_torques).unwrap_or_else(|| {
        let takes_windows =
            architecture.has_steps() && training.optimiser == OptimiserKind::LevenbergMarquardt;
        match windows::noise_of(data).filter(|_| takes_windows) {
            Some(noise) => {
                notices.push(Notice::Noisy { noise, window: training.window });
                TrainingLoss::Windows
            }
            None if !config.calibration.is_default() || training.integrator.is_some() => {
                TrainingLoss::Windows
            }
            None => TrainingLoss::NextPosition,
        }
    });
    training.loss = Some(chosen);
    chosen
}
