//! Choice of a paper's tasks, the place for their results, and the printed output.

use clap::{Args, ValueEnum};
use leastaction::cli::arguments::seed;
use leastaction::cli::{Done, Failure, Output, folder, object, print};
use leastaction_learning::checksummed::ReadError;
use leastaction_papers::folder::{FolderError, Results};
use leastaction_papers::record::{Finished, Record};
use leastaction_papers::task::{Shard, Task, run_all};
use leastaction_papers::{PageError, Paper, table};
use serde_json::{Map, Value};
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// Options of every paper's command.
#[derive(Args)]
pub struct Selection {
    /// Only tasks with this text in their names; given several times, with any of the texts. --list prints the names.
    #[arg(long, value_name = "TEXT")]
    only: Vec<String>,
    /// Print the names of the tasks and run none.
    #[arg(long)]
    list: bool,
    /// Seed of the initial weights and, if the data is generated, of the data.
    #[arg(long, default_value_t = 0, value_parser = seed, allow_negative_numbers = true)]
    pub seed: u64,
    /// Run every task with N seeds, from --seed on: medians are printed, with the smallest and the largest value.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub seeds: u32,
    /// Fewer rows, iterations and starts, for a first look.
    #[arg(long)]
    pub quick: bool,
    /// Number of tasks run side by side; those that measure times come last, alone.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=MOST_JOBS))]
    jobs: u32,
    /// Only every Nth task from the Ith on, for many machines; `leastaction-papers merge` joins their results.
    #[arg(long, value_name = "I/N", default_value = "1/1")]
    shard: Shard,
    /// Folder for a page with all tables and pictures, the same as CSV and JSON, and the results of every task: an interrupted run
    /// continues where it stopped.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// Largest number of tasks side by side; each takes a thread.
const MOST_JOBS: i64 = 1024;

impl Selection {
    /// The only one of these options that changes results, as it stands on the command line.
    pub fn arguments(&self) -> String {
        if self.quick { " --quick".to_owned() } else { String::new() }
    }

    /// Seeds of the tasks.
    pub fn seeds(&self) -> impl Iterator<Item = u64> {
        (self.seed..).take(self.seeds as usize)
    }

    /// Runs the chosen tasks, writes and prints.
    pub fn run(&self, paper: &Paper, tasks: Vec<Task>, output: Output) -> Done {
        let chosen = self.chosen(&tasks)?;
        if self.list {
            return print(&chosen.iter().map(|task| format!("{}\n", task.name)).collect::<String>());
        }
        let results = self.output.as_deref().map(|path| open(path, paper)).transpose()?;
        let _lock = results.as_ref().map(Results::lock).transpose().map_err(unusable)?;
        let finished =
            run_all(paper.name, &chosen, results.as_ref(), self.jobs as usize, &|line| output.note(line))
                .map_err(unusable)?;
        if let (Some(path), Some(results)) = (&self.output, &results) {
            write(paper, path, results, &tasks, output)?;
        }
        report(&finished, output)?;
        failure(&finished)
    }

    fn chosen<'t>(&self, tasks: &'t [Task]) -> Result<Vec<&'t Task>, Failure> {
        let is_chosen = |name: &str| self.only.is_empty() || self.only.iter().any(|text| name.contains(text));
        let chosen: Vec<_> = tasks.iter().filter(|task| is_chosen(&task.name)).collect();
        if chosen.is_empty() {
            let texts = self.only.join(" or ");
            return Err(Failure::Input(format!("no task has {texts} in its name; --list prints the names")));
        }
        Ok(self.shard.of(chosen))
    }
}

/// Writes the page of all stored results that belong together, including those of tasks that were not chosen now.
fn write(paper: &Paper, path: &Path, results: &Results, tasks: &[Task], output: Output) -> Done {
    let (page, others) = results.page(tasks).map_err(unusable)?;
    for file in paper.write(path, results, &page).map_err(unwritten)? {
        output.note(&format!("wrote {}", file.display()));
    }
    if others > 0 {
        let folder = results.folder().display();
        output.note(&format!("{others} results in {folder} are of other options, and not on the page"));
    }
    Ok(())
}

/// An option with its value as on the command line, after a space; empty if it was not given.
pub fn given(name: &str, value: Option<impl Display>) -> String {
    value.map_or(String::new(), |value| format!(" --{name} {value}"))
}

/// The selected case, or all cases.
pub fn cases<C: ValueEnum>(only: Option<C>) -> Vec<C> {
    only.map_or_else(|| C::value_variants().to_vec(), |only| vec![only])
}

/// A given number, or the usual one.
pub fn number_or(given: Option<u32>, usual: usize) -> usize {
    given.map_or(usual, |given| given as usize)
}

/// Opens the folder of a paper's results.
pub fn open(path: &Path, paper: &Paper) -> Result<Results, Failure> {
    folder(path)?;
    Results::open(path, paper.name).map_err(unusable)
}

/// Prints the tables, or all numbers as one JSON object: that of the only row, or the rows and their summaries.
pub fn report(finished: &[Finished], output: Output) -> Done {
    if !output.json {
        return print(&table::text(finished));
    }
    let records = || finished.iter().flat_map(|task| &task.records);
    let details = |of: fn(&&Record) -> bool| -> Vec<&Value> {
        records().filter(of).map(|record| &record.details).collect()
    };
    let (rows, sums) = (details(|record| !record.is_summary), details(|record| record.is_summary));
    if let ([row], []) = (&rows[..], &sums[..]) {
        return object(row);
    }
    let mut all = Map::new();
    all.insert("rows".to_owned(), rows.into_iter().cloned().collect());
    for sum in sums.into_iter().filter_map(Value::as_object) {
        all.extend(sum.clone());
    }
    let failed = finished.iter().filter_map(|task| Some((task.task.clone(), task.failure.clone()?.into())));
    let failed: Map<String, Value> = failed.collect();
    if !failed.is_empty() {
        all.insert("failed".to_owned(), failed.into());
    }
    object(&all)
}

/// Makes the command fail after all tasks if some of them failed.
fn failure(finished: &[Finished]) -> Done {
    let failed = table::failures(finished);
    if failed.is_empty() { Ok(()) } else { Err(Failure::Work(failed.join("\n"))) }
}

/// Converts an error of results that cannot be read or written.
pub fn unusable(error: FolderError) -> Failure {
    let message = error.to_string();
    match error {
        FolderError::File { .. } | FolderError::Interrupted(ReadError::File { .. }) => Failure::Work(message),
        _ => Failure::Input(message),
    }
}

/// Converts an error of a page that cannot be written.
pub fn unwritten(error: PageError) -> Failure {
    match error {
        PageError::Results(error) => unusable(error),
        error => Failure::Work(error.to_string()),
    }
}
