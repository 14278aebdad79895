//! Changes of the state of a run: in an iteration, and between stages.

use super::plan::Plan;
use super::stages::{NETWORKS, Stage};
use crate::checkpoint::{Best, Optimiser, State};
use crate::config::{AdamConfig, OptimiserKind, TrainingConfig};
use crate::training::{Adam, AdamSettings, Free, Levenberg, Objective, Progress, Schedule};

impl Optimiser {
    fn new(stage: &Stage, weights: Vec<f64>, training: &TrainingConfig) -> Self {
        let objective = &*stage.objective;
        match stage.optimiser {
            OptimiserKind::LevenbergMarquardt => {
                Self::Levenberg(Levenberg::new(objective, weights).with_decay(training.weight_decay))
            }
            OptimiserKind::Adam => Self::Adam(Adam::new(objective, weights, adam_settings(training))),
        }
    }

    fn iterate(&mut self, objective: &dyn Objective) -> Progress {
        match self {
            Self::Levenberg(levenberg) => levenberg.iterate(objective),
            Self::Adam(adam) => adam.iterate(objective),
        }
    }

    /// The current weights.
    pub fn weights(&self) -> &[f64] {
        match self {
            Self::Levenberg(levenberg) => &levenberg.weights,
            Self::Adam(adam) => &adam.weights,
        }
    }

    /// The training loss; for Adam the mean over the batches of the last iteration.
    pub fn loss(&self) -> f64 {
        match self {
            Self::Levenberg(levenberg) => levenberg.loss,
            Self::Adam(adam) => adam.loss,
        }
    }
}

fn adam_settings(training: &TrainingConfig) -> AdamSettings {
    let AdamConfig { learning_rate, batch, plateau_factor, plateau_patience } = training.adam;
    let schedule = Schedule::Plateau { factor: plateau_factor, patience: plateau_patience };
    AdamSettings { learning_rate, batch, schedule, decay: 0.0, seed: training.seed }
}

impl Best {
    /// The current weights with their losses. A stage that learns from all logs keeps the held-back loss of the
    /// previous stage.
    fn new(stage: &Stage, optimiser: &Optimiser, (iteration, before): (u64, Option<f64>)) -> Self {
        let weights = optimiser.weights();
        let loss = |objective: &Option<Box<dyn Objective>>| {
            objective.as_ref().map(|part| part.held_back_loss(weights))
        };
        Self {
            weights: weights.to_vec(),
            iteration,
            train: optimiser.loss(),
            validation: loss(&stage.validation).or(before),
            next_position: loss(&stage.judge),
            solves_nothing: false,
        }
    }

    /// The criterion that decides between weights: the error of the next position if the stage has a separate judge,
    /// else the validation loss, else the training loss.
    pub(super) fn score(&self, stage: &Stage) -> f64 {
        let validation = self.validation.filter(|_| stage.validation.is_some());
        self.next_position.or(validation).unwrap_or(self.train)
    }
}

/// One line of the history.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Iterations done, over all stages.
    pub iteration: u64,
    /// Name of the stage.
    pub stage: String,
    /// Training time so far, s.
    pub seconds: f64,
    /// Training loss.
    pub train: f64,
    /// Validation loss: the loss on held-back trajectories.
    pub validation: Option<f64>,
}

impl State {
    /// The state before the first iteration; `None` for a plan without stages.
    pub fn new(plan: &Plan) -> Option<Self> {
        Self::from_start(plan, plan.initial.clone(), (0, 0))
    }

    /// The state before the first stage from start number `start`, after this many iterations of earlier fits.
    pub(super) fn from_start(plan: &Plan, weights: Vec<f64>, (start, iteration): (u64, u64)) -> Option<Self> {
        let (optimiser, best) = Self::enter(plan, plan.stages.first()?, weights, (iteration, None));
        let (alone, earlier) = (None, None);
        Some(Self { stage: 0, in_stage: 0, iteration, seconds: 0.0, optimiser, best, alone, start, earlier })
    }

    fn enter(
        plan: &Plan,
        stage: &Stage,
        mut weights: Vec<f64>,
        before: (u64, Option<f64>),
    ) -> (Optimiser, Best) {
        if let Some((start, numbers)) = &stage.begins_with {
            let places = weights.get_mut(*start..).unwrap_or_default();
            places.iter_mut().zip(numbers).for_each(|(place, number)| *place = *number);
        }
        let optimiser = Optimiser::new(stage, weights, &plan.config.training);
        let best = Best::new(stage, &optimiser, before);
        (optimiser, best)
    }

    /// Goes on to the next stage with the best weights of this one; returns false if this is the last.
    pub fn next_stage(&mut self, plan: &Plan) -> bool {
        let Some(stage) = plan.stages.get(self.stage + 1) else { return false };
        let weights = std::mem::take(&mut self.best.weights);
        if stage.name == NETWORKS {
            self.alone = Some(weights.clone());
        }
        let before = (self.iteration, self.best.validation);
        (self.optimiser, self.best) = Self::enter(plan, stage, weights, before);
        (self.stage, self.in_stage) = (self.stage + 1, 0);
        true
    }

    /// Moves the best numbers of a loss over windows along what the logs leave free, back to where the plan begins.
    pub(super) fn hold_what_is_free(&mut self, plan: &Plan) {
        let (Some(windows), Some(stage)) = (&plan.windows, plan.stages.get(self.stage)) else { return };
        // Numbers that were fitted to torques have a prior of their own.
        if self.iteration == 0 || plan.torques().is_some() {
            return;
        }
        let names = plan.architecture.number_names();
        let named = (0..names.len()).filter(|position| names[*position].is_some());
        let named: Vec<usize> = named.chain(names.len()..windows.layout.end()).collect();
        let free = Free { objective: &*stage.objective, positions: &named, initial: &plan.given };
        let weights = &self.best.weights;
        let found = match windows.part(&plan.architecture) {
            Some(part) => {
                free.least_motion_of_part(weights, (&part, &part.settled(&weights[..windows.layout.end()])))
            }
            None => free.least_motion(weights),
        };
        if let Some((weights, loss)) = found {
            (self.best.weights, self.best.train) = (weights, loss);
        }
    }

    /// Does one iteration; returns the new losses if it succeeded.
    pub(super) fn iterate(&mut self, stage: &Stage) -> (Progress, Option<Best>) {
        let progress = self.optimiser.iterate(&*stage.objective);
        if progress != Progress::Lower {
            return (progress, None);
        }
        self.iteration += 1;
        self.in_stage += 1;
        let now = Best::new(stage, &self.optimiser, (self.iteration, self.best.validation));
        // The scores of a stage may be infinite at first. A lower score always wins. With a separate judge an equal
        // score wins, too, so that a stage in which all scores are infinite ends with its last weights.
        let (score, best) = (now.score(stage), self.best.score(stage));
        if score < best || (stage.judge.is_some() && score == best) {
            self.best = now.clone();
        }
        (progress, Some(now))
    }
}
