//! `leastaction-papers lgnn`.

use super::compared::Compared;
use super::selection::{Selection, cases, given, number_or};
use clap::Args;
use leastaction::cli::{Done, Output};
use leastaction_papers::LGNN;
use leastaction_papers::lgnn::{Case, Options, tasks};

/// LGNN (Bhattoo et al., MLST 2023): pendulums on rods and rings of springs from accelerations, transferred to other numbers of them.
///
/// Runs every case that the options leave open and prints its errors beside those of the authors' program: geometric means of the rollout
/// error and of the energy violation. Data and truth are exact motion. With -o also writes a page with pictures.
///
/// The models that the paper compares with (GNS, LGN, LNN) are trained by its authors' recipe: Adam with 10,000 epochs. A row is marked if
/// its training ran out of time or diverged.
///
/// Example: leastaction-papers lgnn --case pendulum --json
#[derive(Args)]
pub struct Lgnn {
    /// Only this experiment.
    #[arg(long)]
    case: Option<Case>,
    /// Maximum number of Levenberg-Marquardt iterations: 200, or 60 with --quick.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    iterations: Option<u32>,
    /// Number of starts of the rollouts: 100, or 10 with --quick; fewer for large systems.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    starts: Option<u32>,
    /// Learn networks without a simple law (uniform field, polynomial of the squared distance, viscous drag) beside them; without --case,
    /// some cases are learned both ways.
    #[arg(long)]
    networks_alone: bool,
    #[command(flatten)]
    compared: Compared,
    #[command(flatten)]
    selection: Selection,
}

/// Cases that are also learned by networks without laws, if no case is named.
const WITHOUT_LAWS: [Case; 4] = [Case::Pendulum, Case::Spring, Case::Hybrid, Case::HybridForce];

impl Lgnn {
    /// Learns, rolls out and prints.
    pub fn run(self, output: Output) -> Done {
        let seed = self.selection.seed;
        let usual = if self.selection.quick { Options::quick(seed) } else { Options::new(seed) };
        let options = Options {
            iterations: number_or(self.iterations, usual.iterations),
            starts: number_or(self.starts, usual.starts),
            networks_alone: self.networks_alone,
            ..usual
        };
        let limits = Some(self.compared.limits(self.selection.quick));
        let limits = limits.filter(|_| self.compared.are_wanted(self.case.is_none()));
        let (seeds, arguments) = (self.selection.seeds as usize, self.arguments());
        let mut all = tasks(&cases(self.case), (&options, limits), seeds, &arguments);
        if self.case.is_none() && !self.networks_alone {
            let options = Options { networks_alone: true, ..options };
            all.extend(tasks(&WITHOUT_LAWS, (&options, None), seeds, &arguments));
        }
        self.selection.run(&LGNN, all, output)
    }

    /// Command-line options other than case and seed.
    fn arguments(&self) -> String {
        [
            given("iterations", self.iterations),
            given("starts", self.starts),
            self.compared.arguments(),
            self.selection.arguments(),
        ]
        .concat()
    }
}
