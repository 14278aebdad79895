//! Options of the models that a paper compares with.

use super::selection::given;
use clap::Args;
use leastaction::cli::arguments::positive;
use leastaction_papers::Limits;
use std::time::Duration;

/// Whether and how long the models that the paper compares with are trained.
#[derive(Args)]
pub struct Compared {
    /// Also the models that the paper compares with; without --case they are there anyway.
    #[arg(long, conflicts_with = "ours_alone")]
    baselines: bool,
    /// Without them.
    #[arg(long)]
    ours_alone: bool,
    /// Epochs of those models at most; by default as many as their authors'.
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..))]
    epochs: Option<u64>,
    /// Minutes of training of each of them at most, and again of its predictions: 5, or 0.1 with --quick.
    #[arg(long, value_parser = positive)]
    minutes: Option<f64>,
}

/// Minutes of training.
const MINUTES: f64 = 5.0;
/// The same for a first look.
const QUICK_MINUTES: f64 = 0.1;
/// More minutes than anyone waits.
const LONGEST: f64 = 1e9;

impl Compared {
    /// Whether they are trained; if nothing is said, where the tables are complete.
    pub fn are_wanted(&self, is_complete: bool) -> bool {
        self.baselines || is_complete && !self.ours_alone
    }

    /// Of each model.
    pub fn limits(&self, quick: bool) -> Limits {
        let usual = if quick { QUICK_MINUTES } else { MINUTES };
        let minutes = self.minutes.unwrap_or(usual).min(LONGEST);
        Limits { epochs: self.epochs, time: Some(Duration::from_secs_f64(60.0 * minutes)) }
    }

    /// As on the command line.
    pub fn arguments(&self) -> String {
        given("epochs", self.epochs) + &given("minutes", self.minutes)
    }
}
