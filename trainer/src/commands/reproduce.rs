//! `leastaction reproduce`: refers to the command with the papers' experiments.

use clap::Args;
use leastaction::cli::{Done, Failure};

/// The papers' experiments; they have a command of their own.
#[derive(Args)]
pub struct Reproduce {
    /// Arguments for the other command.
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
