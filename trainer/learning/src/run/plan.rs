//! The plan of a run: its stages, each with its losses, from a configuration and data.

mod checks;
mod error;

pub use error::PlanError;

use super::fingerprint;
use super::folds::Fold;
use super::lengths;
use super::log_scales;
use super::notice::{Notice, prepared};
use super::origin::at_origin;
use super::rest_width;
use super::stages::{self, Scope, Stage, Windowed};
use super::starts::FURTHER;
use super::{TorqueReport, range, ringing, torques};
use crate::checkpoint::{Checkpoint, State, Trained, open};
use crate::config::{Config, OptimiserKind, TrainingConfig, TrainingLoss};
use crate::data::{Dataset, MIN_SAMPLES};
use crate::torques::SplitErrors;
use crate::training::{LossKind, Progress};
use crate::windows::{self, CalibrationLayout, Integrator, Noise, WindowLogs, first_guess};
use checks::{check_coordinates, check_gauge, check_servo, check_state_noise, check_torque_calibration};
use leastaction_core::discrete::Order;
use leastaction_core::model::{CoordinateRange, TrainedStep};
use leastaction_models::config::{Origin, Source};
use leastaction_models::{Architecture, Model};
use std::time::Duration;

/// The plan of a run, which determines the run completely.
pub struct Plan {
    pub(super) config: Config,
    pub(super) architecture: Architecture,
    /// Initial weights.
    pub(super) initial: Vec<f64>,
    /// Numbers that the configuration begins with, before any fit: what the data leave free stays near them.
    pub(super) given: Vec<f64>,
    pub(super) trained_step: Option<TrainedStep>,
    /// Range of the data, training and validation.
    pub(super) range: Vec<CoordinateRange>,
    /// Positions sampled from the data, for checks of the trained model.
    pub(super) positions: Vec<Vec<f64>>,
    pub(super) data_fingerprint: u64,
    /// Model whose energies the initial weights reproduce, if there is one.
    pub(super) origin: Option<Origin>,
    /// Data of a loss over windows.
    pub(super) windows: Option<Windowed>,
    pub(super) stages: Vec<Stage>,
    /// Number of starts after the first, for a fit of rigid bodies that ends badly; 0 for other fits.
    pub(super) further_starts: u64,
    /// Logs on which the model's torques are evaluated, with the number of training trajectories; `None` unless torques
    /// are the loss.
    driven: Option<(Dataset, usize)>,
    notices: Vec<Notice>,
    preparation: Duration,
}

impl Plan {
    /// Splits the data and builds the losses.
    ///
    /// # Errors
    /// [`PlanError`] if the data and the configuration do not fit each other.
    pub fn new(config: Config, data: &Dataset) -> Result<Self, PlanError> {
        Self::of(config, data, Scope::Whole)
    }

    /// The plan for a few iterations on the training part of a fold, from the initial weights or from an earlier
    /// result. The held-back part is only used to evaluate the result.
    ///
    /// # Errors
    /// See [`Plan::new`].
    pub(super) fn of_fold(config: Config, fold: &Fold, goes_on: bool) -> Result<Self, PlanError> {
        Self::of(config, &fold.data, Scope::Fold { training: fold.training, goes_on })
    }

    /// The loss that the stages of a configuration minimise, given these data.
    ///
    /// # Errors
    /// See [`Plan::new`].
    pub(super) fn loss(config: &Config, data: &Dataset) -> Result<TrainingLoss, PlanError> {
        let (architecture, _) = config.beginning()?;
        check_coordinates(&architecture, data)?;
        let (data, _) = prepared(data, config, &architecture)?;
        Ok(loss_of(config, &architecture, &data).0)
    }

    fn of(mut config: Config, data: &Dataset, scope: Scope) -> Result<Self, PlanError> {
        let (mut architecture, mut initial) = config.beginning()?;
        check_coordinates(&architecture, data)?;
        let described = config.model.notes(&open)?.into_iter().map(Notice::Described);
        let (data, changed) = prepared(data, &config, &architecture)?;
        let mut notices: Vec<Notice> = described.chain(changed).collect();
        let loss = settle_loss(&mut config, &architecture, &data, &mut notices);
        check_state_noise(&config.training, loss)?;
        check_torque_calibration(&config, &architecture, loss)?;
        check_servo(&architecture, loss)?;
        let training = match scope {
            Scope::Whole => {
                split(&data, (config.data.validation, fewest_samples(&config, loss, data.h)), &mut notices)
            }
            Scope::Fold { training, .. } => training,
        };
        let widths = rest_width::open(&architecture);
        log_scales::follow(&mut architecture, &mut initial, (&data, training))?;
        let fits_torques = loss == TrainingLoss::Torque || loss.of_samples().is_none();
        if fits_torques && !matches!(scope, Scope::Fold { goes_on: true, .. }) {
            rest_width::choose(&mut architecture, (&widths, &mut initial), (&data, training), &config)?;
        }
        let mut given = initial.clone();
        // The bodies of an arm are fitted separately, before any stage.
        let of_samples =
            loss.of_samples().filter(|kind| *kind != LossKind::Torque || architecture.family.arm().is_none());
        let (stages, windows) = match of_samples {
            Some(kind) => {
                let parts = data.split(training);
                let held_back = (!parts.1.trajectories.is_empty()).then_some(parts.1);
                check_gauge(&architecture, is_forced(&architecture, &parts.0))?;
                let parts = (&parts.0, held_back.as_ref());
                (stages::of_samples((&config, scope), kind, &architecture, parts, &mut notices)?, None)
            }
            None => {
                check_gauge(&architecture, is_forced(&architecture, &data))?;
                let of = (&data, training);
                let (stages, windows) =
                    stages::of_windows((&config, scope), &architecture, of, &mut notices)?;
                if !matches!(scope, Scope::Fold { goes_on: true, .. }) {
                    let begins = (&stages[..], &windows, initial);
                    initial = begin_windows(&config, &architecture, of, begins, &mut notices)?;
                }
                (stages, Some(windows))
            }
        };
        let origin = config.model.origin(&open)?;
        if let Some(origin) = &origin {
            initial = at_origin((&architecture, initial), &data, origin)?;
            let layout = windows.as_ref().map(|windows| windows.layout);
            initial.extend(layout.into_iter().flat_map(|layout| layout.initial_at(&origin.0.facts.actuator)));
        }
        if origin.is_some() {
            given.clone_from(&initial);
        } else if let Some(windows) = &windows {
            given.extend(windows.layout.initial());
        }
        let step = |order| TrainedStep { order, h: data.h as f32, control: data.control_kind() };
        let TrainingConfig { order, integrator, .. } = config.training;
        let has_step = loss.is_discrete() || integrator == Some(Integrator::Del);
        let is_new = config.model.source() == Source::Nothing && origin.is_none() && scope == Scope::Whole;
        let of_bodies = is_new && architecture.family.bodies().is_some();
        Ok(Self {
            further_starts: if of_bodies { FURTHER } else { 0 },
            initial,
            given,
            trained_step: Order::from_number(order).filter(|_| has_step).map(step),
            range: range::of(&architecture, &data),
            positions: ringing::positions(&data.trajectories),
            data_fingerprint: fingerprint::of_data(&data, loss),
            origin,
            windows,
            stages,
            driven: (loss == TrainingLoss::Torque).then_some((data, training)),
            notices,
            preparation: Duration::ZERO,
            config,
            architecture,
        })
    }

    /// Trains in memory, without a folder, and returns the result; `None` if no stage reaches a finite loss.
    pub fn train(&self) -> Option<Trained> {
        let mut state = self.last_state()?;
        state.hold_what_is_free(self);
        let trained = Trained::from(Checkpoint::new(self, &state));
        trained.best.is_a_model().then_some(trained)
    }

    /// The state at the end of training; `None` for a plan without stages.
    pub(super) fn last_state(&self) -> Option<State> {
        let mut state = State::new(self)?;
        while let Some(stage) = self.stages.get(state.stage) {
            let over = state.in_stage >= stage.iterations;
            let over = over || state.iterate(stage).0 != Progress::Lower;
            if over && !state.next_stage(self) && !state.begin_again(self) {
                break;
            }
        }
        Some(state)
    }

    /// Layout of the learned sensor and actuator numbers in the parameter vector of a loss over windows.
    pub(super) fn calibration(&self) -> Option<CalibrationLayout> {
        self.windows.as_ref().map(|windows| windows.layout)
    }

    /// Notices for the user.
    pub fn notices(&self) -> &[Notice] {
        &self.notices
    }

    /// Torque errors of a trained model; `None` if torques are not the loss.
    pub(super) fn torque_errors(&self, model: &Model) -> Option<SplitErrors> {
        let (data, training) = self.driven.as_ref()?;
        SplitErrors::along(model, (data, *training), self.config.training.cut_off)
    }

    /// The report on an arm's fit to torques, if there was such a fit.
    pub(super) fn torques(&self) -> Option<&TorqueReport> {
        self.notices.iter().find_map(|notice| match notice {
            Notice::Torques(report) => Some(report),
            _ => None,
        })
    }

    /// Number of training samples of the last stage, and of validation samples.
    pub fn samples(&self) -> (usize, usize) {
        let judges = self.stages.iter().rev().find_map(|stage| stage.validation.as_ref());
        let last = self.stages.last().map_or(0, |stage| stage.objective.samples());
        (last, judges.map_or(0, |part| part.samples()))
    }

    /// The plan, with the time that reading, choices and first fits took.
    #[must_use]
    pub fn prepared_in(self, preparation: Duration) -> Self {
        Self { preparation, ..self }
    }

    /// Time that reading, choices and first fits took, as told by [`Plan::prepared_in`].
    pub fn preparation(&self) -> Duration {
        self.preparation
    }

    /// Size of the weight block.
    pub fn parameters(&self) -> usize {
        self.architecture.parameters().unwrap_or(0)
    }

    /// Number of entries in the weight block that training changes.
    pub fn learned_parameters(&self) -> usize {
        self.architecture.learned_parameters().unwrap_or(0)
    }

    /// Number of iterations of all stages.
    pub fn iterations(&self) -> u64 {
        self.stages.iter().map(|stage| stage.iterations).fold(0, u64::saturating_add)
    }
}

/// Whether a known force acts; known friction counts as a known force.
pub(super) fn is_forced(architecture: &Architecture, data: &Dataset) -> bool {
    // The force of a servo of unknown stiffness is not known.
    let is_known = !architecture.group_laws.has_servos() && data.is_forced();
    is_known || architecture.group_laws.shows_scale()
}

/// Least number of samples of a trajectory that the loss can learn from: those of a window.
fn fewest_samples(config: &Config, loss: TrainingLoss, h: f64) -> usize {
    let window = config.training.window.filter(|_| loss == TrainingLoss::Windows);
    window.map_or(MIN_SAMPLES, |window| lengths::steps(window, h) + 1)
}

/// Number of training trajectories. The rest is held back from the end: a fraction of the trajectories with at least
/// `fewest` samples, rounded, but at least one of them. Shorter trajectories are neither learned from nor judge.
fn split(data: &Dataset, (fraction, fewest): (f64, usize), notices: &mut Vec<Notice>) -> usize {
    let all = data.trajectories.len();
    let long: Vec<usize> = (0..all).filter(|k| data.trajectories[*k].samples() >= fewest).collect();
    let count = long.len();
    if (1..all).contains(&count) {
        notices.push(Notice::ShortLogs { short: all - count, all, seconds: (fewest - 1) as f64 * data.h });
    }
    if fraction == 0.0 {
        return all;
    }
    if count < 2 {
        notices.push(Notice::NoValidation);
        return all;
    }
    let held_back = ((fraction * count as f64).round() as usize).clamp(1, count - 1);
    long[count - held_back]
}

/// Starting weights for training over windows. An arm starts from a fit to torques, rigid bodies start from a fit to
/// smoothed states, and correcting networks start without effect.
fn begin_windows(
    config: &Config,
    architecture: &Architecture,
    (data, training): (&Dataset, usize),
    (stages, windows, mut initial): (&[Stage], &Windowed, Vec<f64>),
    notices: &mut Vec<Notice>,
) -> Result<Vec<f64>, PlanError> {
    if let Some(arm) = architecture.family.arm().filter(|_| !architecture.group_laws.has_servos()) {
        let fitted = torques::fitted((architecture, arm), &initial, (data, training), config)?;
        initial = fitted.weights;
        notices.push(Notice::Torques(fitted.report));
        initial.extend(windows.layout.initial_at(&fitted.actuator));
    } else if let Some(stage) = stages.first() {
        let logs = WindowLogs::new(&data.split(training).0);
        let guess = first_guess(architecture, &logs, initial, &*stage.objective)?;
        initial = guess.weights;
        if !guess.shows_scale && !notices.contains(&Notice::UnknownScale) {
            notices.push(Notice::UnknownScale);
        }
    }
    if config.model.source() != Source::Weights {
        let numbers = architecture.corrections.without_effect();
        initial.splice(architecture.corrections_place(), numbers);
    }
    Ok(initial)
}

/// The loss to minimise. Writes the loss, the window length and the integrator into the configuration: friction that sticks and end stops
/// are followed by the steps that solve them.
fn settle_loss(
    config: &mut Config,
    architecture: &Architecture,
    data: &Dataset,
    notices: &mut Vec<Notice>,
) -> TrainingLoss {
    let (loss, noise) = loss_of(config, architecture, data);
    config.training.loss = Some(loss);
    if loss.of_samples().is_none() {
        let window = *config.training.window.get_or_insert_with(|| lengths::usual(data));
        notices.extend(noise.map(|noise| Notice::Noisy { noise, window }));
        if architecture.group_laws.have_contacts() {
            config.training.integrator.get_or_insert(Integrator::Del);
        }
    }
    loss
}

/// The loss to minimise: that of the configuration, or else windows if positions are noisy (returned with their noise),
/// or else the next position.
fn loss_of(config: &Config, architecture: &Architecture, data: &Dataset) -> (TrainingLoss, Option<Noise>) {
    let training = &config.training;
    let of_noise = training.state_noise.map(|_| TrainingLoss::Acceleration);
    let of_torques = architecture.family.arm().map(|_| TrainingLoss::Torque);
    // Nothing tells the force of a servo at a sample, only where it moves the joints.
    let of_servos = (architecture.group_laws.has_servos()).then_some(TrainingLoss::Windows);
    if let Some(loss) = training.loss.or(of_noise).or(of_servos).or(of_torques) {
        return (loss, None);
    }
    let takes_windows = architecture.has_steps() && training.optimiser == OptimiserKind::LevenbergMarquardt;
    let noise = windows::noise_of(data).filter(|_| takes_windows);
    let is_windowed = noise.is_some() || !config.calibration.is_default() || training.integrator.is_some();
    (if is_windowed { TrainingLoss::Windows } else { TrainingLoss::NextPosition }, noise)
}
