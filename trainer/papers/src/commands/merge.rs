//! `leastaction-papers merge`.

use super::selection::{open, report, unusable, unwritten};
use clap::Args;
use leastaction::cli::{Done, Failure, Output};
use leastaction_papers::PAPERS;
use leastaction_papers::folder::Results;
use std::path::PathBuf;

/// Join the results of several runs: shares of one paper from many machines, or several papers.
///
/// Example: leastaction-papers merge share-1 share-2 share-3 -o all
#[derive(Args)]
pub struct Merge {
    /// Folders that were given to -o.
    #[arg(required = true, value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// Folder for everything: the pages, the same as CSV and JSON, and the results of every task.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

impl Merge {
    /// Joins, writes and prints.
    pub fn run(self, output: Output) -> Done {
        let mut all = Vec::new();
        for paper in PAPERS {
            let parts: Vec<&PathBuf> =
                self.folders.iter().filter(|folder| folder.join(paper.name).is_dir()).collect();
            if parts.is_empty() {
                continue;
            }
            let results = open(&self.output, paper)?;
            let _lock = results.lock().map_err(unusable)?;
            for part in parts {
                let part = Results::open(part, paper.name).map_err(unusable)?;
                results.join(&part).map_err(unusable)?;
            }
            let finished = results.all().map_err(unusable)?;
            for file in paper.write(&self.output, &results, &finished).map_err(unwritten)? {
                output.note(&format!("wrote {}", file.display()));
            }
            all.extend(finished);
        }
        if all.is_empty() {
            let names = self.folders.iter().map(|folder| folder.display().to_string());
            let names = names.collect::<Vec<_>>().join(", ");
            return Err(Failure::Input(format!(
                "{names}: no results of `leastaction-papers … -o DIR` there"
            )));
        }
        report(&all, output)
    }
}
