//! A training run in a folder of its own. It can be interrupted at any time and resumes bit for bit.
//!
//! The folder holds `checkpoint.postcard` (written atomically: an interruption or a full disk leaves the previous one intact),
//! `history.csv` (one line per iteration: `iteration,stage,seconds,train,validation`), `config.toml` and, at the end, `loss.svg` and, for a
//! loss over windows, `report.html` ([`crate::report`]). While a run trains, the folder is locked. A run that replaces another leaves the
//! other's files alone until its own loss is finite.
//!
//! **What the data must show.** Positions and controls alone determine the motion, but not always the scale of L: a
//! Lagrangian and any multiple of it give the same motion unless a known force acts. Without a forced sample the DEL
//! residual is smallest for L = 0, so that loss is refused. The other losses give energies up to one common factor;
//! [`Notice::UnknownScale`] says so.

mod choose;
mod doubt;
mod ending;
mod error;
mod fingerprint;
mod folder;
#[cfg(test)]
mod folder_tests;
mod folds;
#[cfg(test)]
mod friction_tests;
mod held_back;
mod lengths;
mod log_scales;
mod notice;
mod origin;
mod plan;
mod range;
mod report;
mod rest_width;
mod resume;
mod ringing;
#[cfg(test)]
mod robots;
mod stages;
mod starts;
#[cfg(test)]
mod starts_tests;
mod state;
#[cfg(test)]
mod tests;
mod torques;
mod tried;
mod verdict;

pub use choose::{ChoiceError, Choices, Chosen, choose};
pub use doubt::{RanAway, Unexplained};
pub use ending::Ending;
pub use error::RunError;
pub use folds::{Fold, folds};
pub use held_back::error_at_start;
pub use lengths::Lengths;
pub use notice::Notice;
pub use plan::{Plan, PlanError};
pub use resume::ResumeError;
pub use state::Row;
pub use torques::{TorqueError, TorqueReport};
pub use tried::Tried;
pub use verdict::Poor;

use crate::checkpoint::{Best, Checkpoint, State};
use crate::config::TrainingConfig;
use crate::lock::Lock;
use crate::training::Progress;
use error::stuck;
use folder::{Folder, History};
use leastaction_models::parallel;
use stages::Stage;
use std::io;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Receives messages while training goes on.
pub trait Monitor {
    /// Called after every iteration.
    fn row(&mut self, row: &Row);
    /// Called on a problem that does not stop training.
    fn warning(&mut self, message: &str);
}

/// A run, ready to train.
pub struct Run {
    plan: Plan,
    folder: Folder,
    history: History,
    state: State,
    pool: Option<rayon::ThreadPool>,
    /// Iteration of the last checkpoint; `None` as long as this run has written none and the folder may hold another
    /// run's checkpoint.
    saved: Option<u64>,
    /// Time of the last attempt to write a checkpoint.
    tried: Instant,
    /// Messages on the result.
    warnings: Vec<String>,
    _lock: Lock,
}

impl Run {
    /// Begins in a folder that is empty or does not exist. `force` replaces the run in the folder, as soon as this run has a finite loss.
    ///
    /// # Errors
    /// [`RunError`] if the folder is in use or cannot be written.
    pub fn begin(plan: Plan, path: &Path, force: bool) -> Result<Self, RunError> {
        let folder = Folder { path: path.to_owned() };
        let exists = || RunError::Exists { folder: path.to_owned() };
        let refused = || folder.is_used() && !force;
        // A folder in which there was never a run is left without a lock file.
        if refused() && !folder.has_lock() {
            return Err(exists());
        }
        let lock = folder.lock()?;
        if refused() {
            return Err(exists());
        }
        let replaces = folder.has_run();
        if let Some(name) = folder.foreign().filter(|_| !replaces) {
            return Err(RunError::NoRun { folder: folder.path, name });
        }
        let pool = pool(plan.config.training.threads)?;
        let state = within(pool.as_ref(), || State::new(&plan)).ok_or_else(|| stuck(&plan, "first", 0))?;
        let history = History::new();
        let mut run = Self {
            plan,
            folder,
            history,
            state,
            pool,
            saved: None,
            tried: Instant::now(),
            warnings: Vec::new(),
            _lock: lock,
        };
        if !replaces {
            run.save()?;
        }
        Ok(run)
    }

    /// Resumes the run in a folder from its last checkpoint.
    ///
    /// # Errors
    /// [`RunError`] if there is no checkpoint, or if it belongs to another configuration or other data.
    pub fn resume(plan: Plan, path: &Path) -> Result<Self, RunError> {
        let folder = Folder { path: path.to_owned() };
        let read = || Checkpoint::read(&folder.checkpoint()).map_err(ResumeError::from);
        // Without a checkpoint no lock file is left behind; once the lock is held, no other run writes a checkpoint.
        read()?;
        let lock = folder.lock()?;
        let checkpoint = read()?;
        checkpoint.check(&plan)?;
        let pool = pool(plan.config.training.threads)?;
        let state = checkpoint.state;
        folder.write_config(&plan.config).map_err(|error| folder.failed(error))?;
        let history = History::open(&folder, state.iteration).map_err(|error| folder.failed(error))?;
        let saved = Some(state.iteration);
        let (tried, warnings) = (Instant::now(), Vec::new());
        Ok(Self { plan, folder, history, state, pool, saved, tried, warnings, _lock: lock })
    }

    /// The plan.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Number of iterations done.
    pub fn iteration(&self) -> u64 {
        self.state.iteration
    }

    /// The iteration that was saved last; `None` while the folder still holds the run that is to be replaced.
    pub fn saved(&self) -> Option<u64> {
        self.saved
    }

    /// Training time so far, s.
    pub fn seconds(&self) -> f64 {
        self.state.seconds
    }

    /// The best weights so far, with their losses.
    pub fn best(&self) -> &Best {
        &self.state.best
    }

    /// Trains to the end, or until `stop` is set; then saves the run and draws the loss curve.
    ///
    /// # Errors
    /// [`RunError::Stuck`] if the loss cannot be evaluated, [`RunError::Save`] if the last state cannot be saved.
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
                Progress::Converged if self.next_stage() || self.begin_again() => {}
                Progress::Converged => break Ok(self.converged()),
                Progress::Stuck => break Err(self.stuck()),
            }
        };
        let unsolved = self.unsolved();
        self.state.best.solves_nothing = unsolved.is_some_and(|(unsolved, samples)| unsolved == samples);
        let is_interrupted = matches!(ending, Ok(Ending::Interrupted));
        if !is_interrupted {
            self.hold_what_is_free();
        }
        let is_a_model = self.state.best.is_a_model();
        if self.saved.is_some() || is_a_model && !(is_interrupted && self.state.iteration == 0) {
            self.save()?;
        }
        if !is_a_model && !is_interrupted {
            return Err(self.stuck());
        }
        self.say_what_was_not_learned(unsolved.map_or(0, |(unsolved, _)| unsolved), monitor);
        if self.saved.is_some()
            && let Err(error) = self.folder.draw(&self.history.rows)
        {
            monitor.warning(&error.to_string());
        }
        if self.saved.is_some()
            && is_a_model
            && let Err(error) = self.write_report()
        {
            monitor.warning(&format!("{}: {error}", self.folder.report().display()));
        }
        ending
    }

    fn stage(&self) -> Option<&Stage> {
        self.plan.stages.get(self.state.stage)
    }

    /// The reason to stop, if any; moves on to the next stage if this one is over.
    fn ending(&mut self, stop: &AtomicBool) -> Option<Ending> {
        if stop.load(Ordering::Relaxed) {
            return Some(Ending::Interrupted);
        }
        while self.stage().is_some_and(|stage| self.state.in_stage >= stage.iterations) {
            if !self.next_stage() && !self.begin_again() {
                return Some(Ending::Iterations);
            }
        }
        let TrainingConfig { target, patience, max_seconds, .. } = &self.plan.config.training;
        let State { seconds, iteration, optimiser, best, .. } = &self.state;
        let last = self.is_in_last_stage();
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
        let waited = self.tried.elapsed().as_secs_f64() >= checkpoint_seconds;
        let due = match self.saved {
            Some(saved) => waited || self.state.iteration - saved >= checkpoint_iterations,
            None => self.is_worth_the_earlier_run(),
        };
        if due && let Err(error) = self.save() {
            monitor.warning(&format!("{error}. Training goes on and tries again"));
        }
    }

    /// Whether the loss of the last stage (not only that of a warm-up) is finite and the best weights solve at least
    /// one training sample.
    fn is_worth_the_earlier_run(&self) -> bool {
        self.state.best.is_a_model() && self.unsolved().is_some_and(|(unsolved, all)| unsolved < all)
    }

    fn save(&mut self) -> Result<(), RunError> {
        let State { iteration, .. } = self.state;
        let written = Checkpoint::new(&self.plan, &self.state).write(&self.folder.checkpoint());
        self.tried = Instant::now();
        match self.saved {
            None => written.and_then(|()| self.write_rest()).map_err(|error| self.folder.failed(error))?,
            Some(saved) => written.map_err(|error| {
                let folder = self.folder.path.clone();
                RunError::Save { folder, iteration, saved, error }
            })?,
        }
        self.saved = Some(iteration);
        Ok(())
    }

    /// Writes the files that accompany the first checkpoint, in place of an earlier run's.
    fn write_rest(&mut self) -> io::Result<()> {
        self.folder.remove_pictures()?;
        self.folder.write_config(&self.plan.config)?;
        self.history.write(&self.folder)
    }
}

/// A thread pool of this run's own; `None` stands for the default pool, one thread per processor.
fn pool(threads: usize) -> Result<Option<rayon::ThreadPool>, rayon::ThreadPoolBuildError> {
    (threads > 0).then(|| parallel::threads(threads)).transpose()
}

/// Does `work` on the threads of the pool.
fn within<T: Send>(pool: Option<&rayon::ThreadPool>, work: impl FnOnce() -> T + Send) -> T {
    match pool {
        Some(pool) => pool.install(work),
        None => work(),
    }
}
