//! A training run in a folder of its own: it can be interrupted at any time and goes on bit for bit.
//!
//! The folder has `checkpoint.postcard` (written atomically: an interruption or a full disk leaves the last one),
//! `history.csv` (one line an iteration: `iteration,stage,seconds,train,validation`), `config.toml` and, at the end,
//! `loss.svg`.
//!
//! **What the data must show.** Positions and controls alone determine the motion, but not always the scale of L: a
//! Lagrangian and any multiple of it move alike unless a known force acts. Without a forced sample the DEL residual is
//! least for L = 0, so that loss is refused; the other losses give energies up to one common factor, which
//! [`Notice::UnknownScale`] says.

mod checkpoint;
mod fingerprint;
mod folder;
mod notice;
mod plan;
mod range;
mod state;
#[cfg(test)]
mod tests;

pub use checkpoint::{CheckpointError, Trained};
pub use notice::Notice;
pub use plan::{Plan, PlanError};
pub use state::{Best, Row};

use crate::atomic::remedy;
use crate::config::TrainingConfig;
use crate::parallel;
use crate::training::{Objective, Progress};
use checkpoint::Checkpoint;
use folder::{Folder, History};
use plan::Stage;
use state::State;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use thiserror::Error;

/// What is told while training goes on.
pub trait Monitor {
    /// After every iteration.
    fn row(&mut self, row: &Row);
    /// Something went wrong that training survives.
    fn warning(&mut self, message: &str);
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// All iterations are done.
    Iterations,
    /// No step lowers the loss any more.
    Converged,
    /// The training loss is at its target.
    Target,
    /// The validation loss has not fallen for long.
    Patience,
    /// The time is over.
    Time,
    /// Stopped from outside.
    Interrupted,
}

impl Ending {
    /// In a word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Iterations => "iterations",
            Self::Converged => "converged",
            Self::Target => "target",
            Self::Patience => "patience",
            Self::Time => "time",
            Self::Interrupted => "interrupted",
        }
    }
}

/// A run that cannot begin or go on.
#[derive(Debug, Error)]
pub enum RunError {
    /// There is already something in the folder.
    #[error("{} already exists; go on with --resume, start anew with --force, or choose another folder", folder.display())]
    Exists {
        /// The folder.
        folder: PathBuf,
    },
    /// The checkpoint does not allow to go on.
    #[error("cannot resume: {0}")]
    Checkpoint(#[from] CheckpointError),
    /// The folder cannot be written to.
    #[error("{}: {error}; {}, or choose another folder", folder.display(), remedy(error))]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// What the operating system said.
        error: io::Error,
    },
    /// The last state could not be saved.
    #[error(
        "{}: cannot save iteration {iteration}: {error}; the checkpoint of iteration {saved} is intact: {} and go on from there \
         with --resume", folder.display(), remedy(error)
    )]
    Save {
        /// The folder.
        folder: PathBuf,
        /// That could not be saved.
        iteration: u64,
        /// That was saved last.
        saved: u64,
        /// What the operating system said.
        error: io::Error,
    },
    /// The loss cannot be evaluated.
    #[error(
        "the {stage} loss cannot be evaluated at the weights of iteration {iteration}: the step cannot be solved there; {advice}"
    )]
    Stuck {
        /// Name of the stage.
        stage: &'static str,
        /// Where.
        iteration: u64,
        /// What to look at.
        advice: String,
    },
    /// The threads could not be started.
    #[error("[training] threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

/// A run, ready to train.
pub struct Run {
    plan: Plan,
    folder: Folder,
    history: History,
    state: State,
    pool: Option<rayon::ThreadPool>,
    /// Iteration, and when, of the last checkpoint.
    saved: (u64, Instant),
}

impl Run {
    /// Begins in a folder, which must be empty or not exist; `force` replaces the run in it.
    ///
    /// # Errors
    /// [`RunError`] where the folder is in use or cannot be written.
    pub fn begin(plan: Plan, path: &Path, force: bool) -> Result<Self, RunError> {
        let folder = Folder { path: path.to_owned() };
        if folder.is_used() && !force {
            return Err(RunError::Exists { folder: folder.path });
        }
        let failed = |error| RunError::Folder { folder: path.to_owned(), error };
        folder.clear().map_err(failed)?;
        let pool = pool(plan.config.training.threads)?;
        let state = within(pool.as_ref(), || State::new(&plan)).ok_or_else(|| stuck(&plan, "first", 0))?;
        Checkpoint::new(&plan, &state).write(&folder.checkpoint()).map_err(failed)?;
        Self::open(plan, folder, state, pool).map_err(failed)
    }

    /// Goes on where the run in a folder was saved last.
    ///
    /// # Errors
    /// [`RunError`] where there is no checkpoint, or it is of another configuration or other data.
    pub fn resume(plan: Plan, path: &Path) -> Result<Self, RunError> {
        let folder = Folder { path: path.to_owned() };
        let checkpoint = Checkpoint::read(&folder.checkpoint())?;
        checkpoint.check(&plan)?;
        let pool = pool(plan.config.training.threads)?;
        let failed = |error| RunError::Folder { folder: path.to_owned(), error };
        Self::open(plan, folder, checkpoint.state, pool).map_err(failed)
    }

    fn open(plan: Plan, folder: Folder, state: State, pool: Option<rayon::ThreadPool>) -> io::Result<Self> {
        folder.write_config(&plan.config)?;
        let history = History::open(&folder, state.iteration)?;
        let saved = (state.iteration, Instant::now());
        Ok(Self { plan, folder, history, state, pool, saved })
    }

    /// The plan.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Iterations done.
    pub fn iteration(&self) -> u64 {
        self.state.iteration
    }

    /// Seconds of training so far.
    pub fn seconds(&self) -> f64 {
        self.state.seconds
    }

    /// The best weights so far, with their losses.
    pub fn best(&self) -> &Best {
        &self.state.best
    }

    /// The loss curve that [`Run::train`] draws.
    pub fn loss_curve(&self) -> PathBuf {
        self.folder.loss_curve()
    }

    /// Trains to the end, or until `stop` is set; then saves and draws the loss curve.
    ///
    /// # Errors
    /// [`RunError::Stuck`] where the loss cannot be evaluated, [`RunError::Save`] where the last state cannot be saved.
    pub fn train(&mut self, monitor: &mut dyn Monitor, stop: &AtomicBool) -> Result<Ending, RunError> {
        let started = Instant::now();
        let before = self.state.seconds;
        let ending = loop {
            if let Some(ending) = self.ending(stop) {
                break Ok(ending);
            }
            let progress = self.iterate(monitor, &|| before + started.elapsed().as_secs_f64());
            match progress {
                Progress::Lower => self.save_sometimes(monitor),
                Progress::Converged if self.next_stage() => {}
                Progress::Converged => break Ok(Ending::Converged),
                Progress::Stuck => break Err(self.stuck()),
            }
        };
        self.save()?;
        let unsolved = self.unsolved();
        if self.plan.stages.last().is_some_and(|stage| unsolved == stage.objective.samples()) {
            return Err(self.stuck());
        }
        self.say_what_was_not_learned(unsolved, monitor);
        if let Err(error) = self.folder.draw(&self.history.rows) {
            monitor.warning(&error.to_string());
        }
        ending
    }

    /// Training samples that count as predicted by a constant velocity with the best weights.
    fn unsolved(&self) -> usize {
        self.plan.stages.last().map_or(0, |stage| self.unsolved_of(&*stage.objective))
    }

    fn unsolved_of(&self, objective: &dyn Objective) -> usize {
        within(self.pool.as_ref(), || objective.unsolved(&self.state.best.weights))
    }

    /// What went wrong without an error.
    fn say_what_was_not_learned(&self, unsolved: usize, monitor: &mut dyn Monitor) {
        if self.state.iteration > 0 && self.state.best.iteration == 0 {
            monitor.warning("nothing was learned: no iteration was better than the initial weights");
        }
        let Some(stage) = self.plan.stages.last() else { return };
        let mut say = |unsolved: usize, name: &str, objective: &dyn Objective| {
            if unsolved > 0 {
                monitor.warning(&format!(
                    "{unsolved} of {} {name} samples cannot be solved with the best weights: they count as predicted by a constant \
                     velocity",
                    objective.samples()
                ));
            }
        };
        say(unsolved, "training", &*stage.objective);
        if let Some(validation) = &stage.validation {
            say(self.unsolved_of(&**validation), "held-back", &**validation);
        }
    }

    fn stage(&self) -> Option<&Stage> {
        self.plan.stages.get(self.state.stage)
    }

    fn stuck(&self) -> RunError {
        stuck(&self.plan, self.stage().map_or("", |stage| stage.name), self.state.iteration)
    }

    /// Why no further iteration should be done; moves on to the next stage where this one is over.
    fn ending(&mut self, stop: &AtomicBool) -> Option<Ending> {
        if stop.load(Ordering::Relaxed) {
            return Some(Ending::Interrupted);
        }
        while self.stage().is_some_and(|stage| self.state.in_stage >= stage.iterations) {
            if !self.next_stage() {
                return Some(Ending::Iterations);
            }
        }
        let TrainingConfig { target, patience, max_seconds, .. } = &self.plan.config.training;
        let State { seconds, iteration, optimiser, best, .. } = &self.state;
        let last = self.state.stage + 1 == self.plan.stages.len();
        if max_seconds.is_some_and(|limit| *seconds >= limit) {
            Some(Ending::Time)
        } else if last && target.is_some_and(|target| optimiser.loss() <= target) {
            Some(Ending::Target)
        } else if last && patience.is_some_and(|patience| iteration - best.iteration > patience) {
            Some(Ending::Patience)
        } else {
            None
        }
    }

    fn next_stage(&mut self) -> bool {
        let Self { plan, state, pool, .. } = self;
        within(pool.as_ref(), || state.next_stage(plan))
    }

    fn iterate(&mut self, monitor: &mut dyn Monitor, seconds: &dyn Fn() -> f64) -> Progress {
        let Self { plan, state, pool, .. } = self;
        let Some(stage) = plan.stages.get(state.stage) else { return Progress::Converged };
        let (progress, losses) = within(pool.as_ref(), || state.iterate(stage));
        state.seconds = seconds();
        if let Some(Best { iteration, train, validation, .. }) = losses {
            let row =
                Row { iteration, stage: stage.name.to_owned(), seconds: state.seconds, train, validation };
            monitor.row(&row);
            if let Err(error) = self.history.push(row) {
                monitor.warning(&format!(
                    "the history cannot be written ({error}); training goes on and tries again"
                ));
            }
        }
        progress
    }

    fn save_sometimes(&mut self, monitor: &mut dyn Monitor) {
        let TrainingConfig { checkpoint_iterations, checkpoint_seconds, .. } = self.plan.config.training;
        let (iteration, at) = self.saved;
        let due = self.state.iteration - iteration >= checkpoint_iterations
            || at.elapsed().as_secs_f64() >= checkpoint_seconds;
        if due && let Err(error) = self.save() {
            monitor.warning(&format!("{error}. Training goes on and tries again"));
            self.saved.1 = Instant::now();
        }
    }

    fn save(&mut self) -> Result<(), RunError> {
        let State { iteration, .. } = self.state;
        let written = Checkpoint::new(&self.plan, &self.state).write(&self.folder.checkpoint());
        let (saved, folder) = (self.saved.0, &self.folder.path);
        written.map_err(|error| RunError::Save { folder: folder.clone(), iteration, saved, error })?;
        self.saved = (iteration, Instant::now());
        Ok(())
    }
}

fn stuck(plan: &Plan, stage: &'static str, iteration: u64) -> RunError {
    RunError::Stuck { stage, iteration, advice: notice::advice(plan.notices()) }
}

/// Threads of our own; `None` for as many as there are processors.
fn pool(threads: usize) -> Result<Option<rayon::ThreadPool>, rayon::ThreadPoolBuildError> {
    (threads > 0).then(|| parallel::threads(threads)).transpose()
}

/// Does something on these threads.
fn within<T: Send>(pool: Option<&rayon::ThreadPool>, work: impl FnOnce() -> T + Send) -> T {
    match pool {
        Some(pool) => pool.install(work),
        None => work(),
    }
}
