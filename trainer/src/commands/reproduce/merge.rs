//! `leastaction reproduce merge`.

use super::selection::{open, report};
use crate::commands::Done;
use crate::commands::output::{Failure, Output};
use clap::Args;
use leastaction::reproduce::PAPERS;
use leastaction::reproduce::folder::Results;
use std::path::PathBuf;

/// Join what several runs gave: shares of one paper from many machines, or papers.
///
/// Example: leastaction reproduce merge share-1 share-2 share-3 -o all
#[derive(Args)]
pub struct Merge {
    /// The folders that were given to -o.
    #[arg(required = true, value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// Where all goes: the pages, the same as CSV and JSON, and what every task gave.
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
            for part in parts {
                results.join(&Results::open(part, paper.name)?)?;
            }
            let finished = results.all()?;
            for file in paper.write(&self.output, &results, &finished)? {
                output.note(&format!("wrote {}", file.display()));
            }
            all.extend(finished);
        }
        if all.is_empty() {
            let names = self.folders.iter().map(|folder| folder.display().to_string());
            let names = names.collect::<Vec<_>>().join(", ");
            return Err(Failure::Input(format!(
                "{names}: no results of `leastaction reproduce … -o DIR` there"
            )));
        }
        report(&all, output)
    }
}
