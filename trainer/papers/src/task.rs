//! Experiments as tasks: they are chosen by name, shared among machines, run side by side, and skipped if they have
//! been done.

use super::folder::{FolderError, Results};
use super::record::{Finished, Record};
use serde::Serialize;
use std::error::Error;
use std::path::Path;
use std::str::FromStr;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;
use thiserror::Error;

/// Reason why a task has no rows.
pub type TaskError = Box<dyn Error + Send + Sync>;

/// A function that takes lines of progress.
pub type Tell<'t> = dyn Fn(&str) + Sync + 't;

/// Work of a task. If a folder is given, it receives pictures and the state of long training, so that interrupted
/// training can continue.
pub type Work = dyn Fn(Option<&Path>, &Tell) -> Result<Vec<Record>, TaskError> + Sync;

/// A unit of work: models that are trained, and all rows that result.
pub struct Task {
    /// File name, unique among the tasks of a paper.
    pub name: String,
    /// Command that runs this task alone.
    pub command: String,
    /// Data that is learned from, in words.
    pub data: String,
    /// Everything that the result depends on.
    pub settings: String,
    /// Options shared by all tasks of a run, as on the command line. Results with other options belong on another page.
    pub options: String,
    /// Rough duration, s.
    pub expected_seconds: f64,
    /// Whether the task measures times, so that nothing else may run beside it.
    pub is_timed: bool,
    /// Work that gives the rows.
    pub run: Box<Work>,
}

/// Writes settings as a line of JSON.
pub(crate) fn json(settings: &impl Serialize) -> String {
    serde_json::to_string(settings).unwrap_or_default()
}

/// Returns a function that prints the loss of every `every`th iteration, with text before and after its number.
pub(crate) fn watch<'t>(
    tell: &'t Tell,
    every: usize,
    (before, after): (String, String),
) -> impl FnMut(usize, f64) + 't {
    move |iteration, loss| {
        if iteration.is_multiple_of(every) {
            tell(&format!("{before}iteration {iteration}{after} {loss:.2e}"));
        }
    }
}

/// Creates a task for each item and each of `seeds` seeds, starting with `first`.
pub(crate) fn with_seeds<T>(
    of: impl IntoIterator<Item = T>,
    (first, seeds): (u64, usize),
    task: impl Fn(&T, u64) -> Task,
) -> Vec<Task> {
    let seeded = |of: T| (first..).take(seeds).map(|seed| task(&of, seed)).collect::<Vec<_>>();
    of.into_iter().flat_map(seeded).collect()
}

/// A share of the tasks: share number `index`, counted from 1, of `of` shares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    index: usize,
    of: usize,
}

impl Shard {
    /// Returns the tasks of this share. All shares together contain every task once; long and short tasks are
    /// distributed evenly.
    pub fn of<T>(self, tasks: Vec<T>) -> Vec<T> {
        tasks.into_iter().skip(self.index - 1).step_by(self.of).collect()
    }
}

/// An invalid share.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("it must be I/N with 1 ≤ I ≤ N, as 2/8")]
pub struct BadShard;

impl FromStr for Shard {
    type Err = BadShard;

    fn from_str(text: &str) -> Result<Self, BadShard> {
        let (index, of) = text.split_once('/').ok_or(BadShard)?;
        let (index, of) = (index.parse().map_err(|_| BadShard)?, of.parse().map_err(|_| BadShard)?);
        if index == 0 || index > of { Err(BadShard) } else { Ok(Self { index, of }) }
    }
}

/// Runs the tasks that are not yet done, `jobs` at a time, and returns the results of all tasks, in their order.
///
/// Each result is written as soon as it is available, so an interrupted run continues where it stopped. A failed task
/// is recorded as failed, and tried again by the next run.
///
/// # Errors
/// [`FolderError`]; failing tasks are no errors.
pub fn run_all(
    paper: &str,
    tasks: &[&Task],
    results: Option<&Results>,
    jobs: usize,
    tell: &Tell,
) -> Result<Vec<Finished>, FolderError> {
    let mut all: Vec<Option<Finished>> =
        tasks.iter().map(|task| done_before(task, results)).collect::<Result<_, _>>()?;
    let open: Vec<usize> = (0..tasks.len()).filter(|k| all[*k].is_none()).collect();
    if open.len() < tasks.len() {
        tell(&format!("{} of {} tasks were done before", tasks.len() - open.len(), tasks.len()));
    }
    let (timed, others): (Vec<usize>, Vec<usize>) = open.into_iter().partition(|k| tasks[*k].is_timed);
    let progress = Progress::new(timed.iter().chain(&others).map(|k| tasks[*k].expected_seconds).sum(), jobs);
    let done = Mutex::new(Vec::new());
    for (queue, jobs) in [(others, jobs), (timed, 1)] {
        let next = AtomicUsize::new(0);
        let work = || -> Result<(), FolderError> {
            while let Some(k) = queue.get(next.fetch_add(1, Ordering::Relaxed)) {
                let finished = finish(paper, tasks[*k], results, tell)?;
                tell(&progress.after(tasks[*k], &finished));
                done.lock().unwrap_or_else(std::sync::PoisonError::into_inner).push((*k, finished));
            }
            Ok(())
        };
        std::thread::scope(|scope| {
            // This thread works as well; if no more threads can be created, the existing ones do all the work.
            let worker = |_| std::thread::Builder::new().spawn_scoped(scope, work).ok();
            let others: Vec<_> = (1..jobs.min(queue.len())).map_while(worker).collect();
            let ours = work();
            others.into_iter().fold(ours, |done, other| {
                done.and(other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
            })
        })?;
    }
    for (k, finished) in done.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner) {
        all[k] = Some(finished);
    }
    Ok(all.into_iter().flatten().collect())
}

/// Results of the task in an earlier run, unless it failed.
fn done_before(task: &Task, results: Option<&Results>) -> Result<Option<Finished>, FolderError> {
    let Some(results) = results else { return Ok(None) };
    let done = results.read(&task.name)?.filter(|finished| finished.failure.is_none());
    if done.as_ref().is_some_and(|finished| finished.settings != task.settings) {
        return Err(FolderError::Settings { file: results.file(&task.name) });
    }
    Ok(done)
}

fn finish(paper: &str, task: &Task, results: Option<&Results>, tell: &Tell) -> Result<Finished, FolderError> {
    let (clock, name) = (Instant::now(), &task.name);
    let outcome = (task.run)(results.map(Results::folder), &|line| tell(&format!("{name}: {line}")));
    let (records, failure) = match outcome {
        Ok(records) => (records, None),
        Err(error) => (Vec::new(), Some(error.to_string())),
    };
    let finished = Finished {
        paper: paper.to_owned(),
        command: task.command.clone(),
        data: task.data.clone(),
        settings: task.settings.clone(),
        options: task.options.clone(),
        seconds: clock.elapsed().as_secs_f64(),
        task: name.clone(),
        failure,
        records,
    };
    results.map_or(Ok(()), |results| results.write(&finished))?;
    Ok(finished)
}

/// Progress, and an estimate of the remaining time at the pace so far.
struct Progress {
    start: Instant,
    expected: f64,
    jobs: usize,
    /// Expected and true duration of the finished tasks, s.
    done: Mutex<[f64; 2]>,
}

impl Progress {
    fn new(expected: f64, jobs: usize) -> Self {
        Self { start: Instant::now(), expected, jobs, done: Mutex::new([0.0; 2]) }
    }

    fn after(&self, task: &Task, finished: &Finished) -> String {
        let mut done = self.done.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        done[0] += task.expected_seconds;
        done[1] += finished.seconds;
        let pace = done[1] / done[0].max(f64::MIN_POSITIVE) / self.jobs.max(1) as f64;
        let (elapsed, rest) = (self.start.elapsed().as_secs_f64(), (self.expected - done[0]).max(0.0) * pace);
        let how =
            finished.failure.as_ref().map_or(String::from("done"), |reason| format!("failed: {reason}"));
        format!(
            "{} {how} after {:.1} s; {elapsed:.0} s so far, about {rest:.0} s remain",
            finished.task, finished.seconds
        )
    }
}
