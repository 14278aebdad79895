//! `leastaction reproduce`: where the papers' experiments went.

use clap::Args;
use leastaction::cli::{Done, Failure};

/// The papers' experiments, which have a command of their own.
#[derive(Args)]
pub struct Reproduce {
    /// What is passed on.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    words: Vec<String>,
}

impl Reproduce {
    /// Names the other command.
    pub fn run(self) -> Done {
        let words = self.words.join(" ");
        Err(Failure::Input(format!(
            "the papers' experiments have a command of their own: leastaction-papers {words}\n  \
             (in the repository: cargo run --release -p leastaction-papers -- {words})"
        )))
    }
}
