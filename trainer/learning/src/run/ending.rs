//! The end of a run, with its messages and its report.

use super::doubt::{self, ran_away};
use super::error::stuck;
use super::{Monitor, Notice, Poor, Run, RunError, report, ringing, verdict, within};
use crate::checkpoint::{Checkpoint, Trained};
use crate::report::{NamedEstimate, ReportError, named};
use crate::torques::SplitErrors;
use crate::training::Objective;
use crate::windows::Certainty;
use std::path::PathBuf;

/// The reason why a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The iteration limit is reached.
    Iterations,
    /// No step lowers the loss any more.
    Converged,
    /// No step lowers the loss any more, but learned numbers ran away: there is no minimum near them.
    RanAway,
    /// The training loss has reached its target.
    Target,
    /// The validation loss has not fallen for too many iterations.
    Patience,
    /// The time limit is reached.
    Time,
    /// Stopped from outside.
    Interrupted,
}

impl Ending {
    /// One-word name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Iterations => "iterations",
            Self::Converged => "converged",
            Self::RanAway => "runaway",
            Self::Target => "target",
            Self::Patience => "patience",
            Self::Time => "time",
            Self::Interrupted => "interrupted",
        }
    }
}

impl Run {
    /// Torque errors of the best model; `None` if the run does not learn from torques.
    pub fn torque_errors(&self) -> Option<SplitErrors> {
        let model = Trained::from(Checkpoint::new(&self.plan, &self.state)).model();
        within(self.pool.as_ref(), || self.plan.torque_errors(&model))
    }

    /// The way in which the best model, with these [torque errors](Self::torque_errors), is no better than a trivial
    /// one; `None` if it is better, if nothing can be compared, or if no iteration was asked for.
    pub fn poor(&self, torques: Option<&SplitErrors>) -> Option<Poor> {
        if self.plan.config.training.iterations == 0 && torques.is_none() {
            return None;
        }
        within(self.pool.as_ref(), || verdict::verdict(&self.plan, &self.state, torques))
    }

    /// Path of the loss curve that [`Run::train`] draws.
    pub fn loss_curve(&self) -> PathBuf {
        self.folder.loss_curve()
    }

    /// Path of the report that [`Run::train`] writes; `None` if there is none.
    pub fn report(&self) -> Option<PathBuf> {
        Some(self.folder.report()).filter(|file| file.exists())
    }

    /// Messages on results that are doubtful or useless although no error occurred.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    pub(super) fn warn(&mut self, message: String, monitor: &mut dyn Monitor) {
        monitor.warning(&message);
        self.warnings.push(message);
    }

    /// The end of training at the least loss that was found, which is no minimum if numbers ran away.
    pub(super) fn converged(&self) -> Ending {
        if ran_away(&self.plan, &self.state).is_some() { Ending::RanAway } else { Ending::Converged }
    }

    /// Precision of the best numbers, as the report states it; `None` if the run does not learn over windows.
    pub fn certainty(&self) -> Option<Certainty> {
        within(self.pool.as_ref(), || report::certainty(&self.plan, &self.state))
    }

    /// Named numbers of the best model with their standard errors, as the report states them; empty if the run does not learn over windows,
    /// or learns from torques.
    pub fn numbers(&self) -> Vec<NamedEstimate> {
        let layout = self.plan.calibration().filter(|_| self.plan.torques().is_none());
        let of = |layout| Some(named(&self.certainty()?, (&self.plan.architecture, &layout)));
        layout.and_then(of).unwrap_or_default()
    }

    /// Moves the best numbers along what the logs leave free, back to where the run begins.
    pub(super) fn hold_what_is_free(&mut self) {
        let Self { plan, state, pool, .. } = self;
        within(pool.as_ref(), || state.hold_what_is_free(plan));
    }

    /// The error of a loss that cannot be evaluated.
    pub(super) fn stuck(&self) -> RunError {
        stuck(&self.plan, self.stage().map_or("", |stage| stage.name), self.state.iteration)
    }

    /// Writes the report page, if the run learned over windows.
    pub(super) fn write_report(&self) -> Result<(), ReportError> {
        match within(self.pool.as_ref(), || report::html(&self.plan, &self.state))? {
            Some(page) => Ok(crate::atomic::write(&self.folder.report(), page.as_bytes())?),
            None => Ok(()),
        }
    }

    /// Number of training samples that cannot be solved with the best weights and thus count as predicted by a constant
    /// velocity, and the number of all training samples; `None` before the last stage.
    pub(super) fn unsolved(&self) -> Option<(usize, usize)> {
        let stage = self.stage().filter(|_| self.is_in_last_stage())?;
        let weights = &self.state.best.weights;
        let solved = within(self.pool.as_ref(), || stage.objective.solved(weights));
        Some((solved.unsolved, stage.objective.samples()))
    }

    pub(super) fn is_in_last_stage(&self) -> bool {
        self.state.stage + 1 == self.plan.stages.len()
    }

    /// Number of held-back samples that cannot be solved with the best weights.
    fn unsolved_of_held_back(&self, held_back: &dyn Objective) -> usize {
        // The parameters of single samples are those of training samples, so they are set anew.
        let weights = || held_back.enter(self.state.best.weights.clone());
        within(self.pool.as_ref(), || held_back.solved(&weights()).unsolved)
    }

    /// Warns of results that are doubtful or useless although no error occurred.
    pub(super) fn say_what_was_not_learned(&mut self, unsolved: usize, monitor: &mut dyn Monitor) {
        let ringing = ringing::notice(&self.plan, &self.state.best.weights);
        let doubts = doubt::unexplained(&self.plan, &self.state).map(Notice::Unexplained);
        let mut said: Vec<String> = ringing.iter().chain(&doubts).map(Notice::to_string).collect();
        if self.state.iteration > 0 && self.state.best.iteration == 0 {
            said.push("nothing was learned: no iteration was better than the initial weights".to_owned());
        }
        if let Some(stage) = self.plan.stages.last() {
            said.extend(of_unsolved(unsolved, "training", &*stage.objective));
            let validation = stage.validation.as_deref();
            said.extend(
                validation.and_then(|part| of_unsolved(self.unsolved_of_held_back(part), "held-back", part)),
            );
        }
        said.into_iter().for_each(|message| self.warn(message, monitor));
    }
}

/// The message on samples that cannot be solved, if there are any.
fn of_unsolved(unsolved: usize, name: &str, objective: &dyn Objective) -> Option<String> {
    (unsolved > 0).then(|| {
        format!(
            "{unsolved} of {} {name} samples cannot be solved with the best weights: they count as predicted by a constant \
             velocity",
            objective.samples()
        )
    })
}
