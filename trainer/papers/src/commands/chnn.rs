//! `leastaction-papers chnn`.

use super::selection::{Selection, given, number_or};
use clap::Args;
use leastaction::cli::{Done, Output};
use leastaction_papers::CHNN;
use leastaction_papers::chnn::{COUNTS, Options, tasks};

/// CHNN and CLNN (Finzi et al., NeurIPS 2020): chains of pendulums from short trajectories of positions and velocities.
///
/// 800 trajectories of 5 states, 100 test starts; prints the geometric mean of the relative rollout error beside the paper's. With -o also
/// writes a page.
///
/// Example: leastaction-papers chnn --pendulums 5 --json
#[derive(Args)]
pub struct Chnn {
    /// Only the chain with this number of pendulums: 2, 3 or 5 in the paper.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=5))]
    pendulums: Option<u8>,
    /// Maximum number of Levenberg-Marquardt iterations: 200, or 60 with --quick.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    iterations: Option<u32>,
    /// Number of training trajectories.
    #[arg(long, default_value_t = 800, value_parser = clap::value_parser!(u32).range(10..))]
    trajectories: u32,
    /// Number of starts of the rollouts: 100, or 20 with --quick.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    starts: Option<u32>,
    #[command(flatten)]
    selection: Selection,
}

impl Chnn {
    /// Learns, rolls out and prints.
    pub fn run(self, output: Output) -> Done {
        let seed = self.selection.seed;
        let usual = if self.selection.quick { Options::quick(seed) } else { Options::new(seed) };
        let options = Options {
            iterations: number_or(self.iterations, usual.iterations),
            starts: number_or(self.starts, usual.starts),
            trajectories: self.trajectories as usize,
            ..usual
        };
        let counts = self.pendulums.map_or_else(|| COUNTS.to_vec(), |only| vec![usize::from(only)]);
        let tasks = tasks(&counts, &options, self.selection.seeds as usize, &self.arguments());
        self.selection.run(&CHNN, tasks, output)
    }

    /// Command-line options other than chain and seed.
    fn arguments(&self) -> String {
        [
            given("iterations", self.iterations),
            given("trajectories", Some(self.trajectories).filter(|trajectories| *trajectories != 800)),
            given("starts", self.starts),
            self.selection.arguments(),
        ]
        .concat()
    }
}
