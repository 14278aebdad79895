//! Options for the models that a paper compares with.

use super::selection::given;
use clap::Args;
use leastaction::cli::arguments::positive;
use leastaction_papers::Limits;
use std::time::Duration;

/// Training of the models that the paper compares with: whether, and for how long.
#[derive(Args)]
pub struct Compared {
    /// Also train the models that the paper compares with; the default without --case.
    #[arg(long, conflicts_with = "ours_alone")]
    baselines: bool,
    /// Leave out the models that the paper compares with.
    #[arg(long)]
    ours_alone: bool,
    /// Maximum number of epochs of the models compared with; by default their authors' number.
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..))]
    epochs: Option<u64>,
    /// Maximum training time of each of these models, and again of its predictions, in minutes: 5, or 0.1 with --quick.
    #[arg(long, value_parser = positive)]
    minutes: Option<f64>,
}

/// Default minutes of training.
const MINUTES: f64 = 5.0;
/// Default minutes of training for a first look.
const QUICK_MINUTES: f64 = 0.1;
/// Upper bound of the minutes, longer than anyone waits.
const LONGEST: f64 = 1e9;

impl Compared {
    /// Whether these models are trained; by default they are if the tables are to be complete.
    pub fn are_wanted(&self, is_complete: bool) -> bool {
        self.baselines || is_complete && !self.ours_alone
    }

    /// Limits of the training of each model.
    pub fn limits(&self, quick: bool) -> Limits {
        let usual = if quick { QUICK_MINUTES } else { MINUTES };
        let minutes = self.minutes.unwrap_or(usual).min(LONGEST);
        Limits { epochs: self.epochs, time: Some(Duration::from_secs_f64(60.0 * minutes)) }
    }

    /// Options as on the command line.
    pub fn arguments(&self) -> String {
        given("epochs", self.epochs) + &given("minutes", self.minutes)
    }
}
