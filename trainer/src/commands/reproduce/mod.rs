//! `leastaction reproduce`.

mod chnn;
mod compared;
mod lgnn;
mod merge;
mod modlanet;
mod selection;
mod symo;

use super::Done;
use super::output::Output;
use clap::{Args, Subcommand};

/// Repeat the papers' experiments, ours beside theirs.
#[derive(Args)]
pub struct Reproduce {
    #[command(subcommand)]
    paper: Paper,
}

#[derive(Subcommand)]
enum Paper {
    Chnn(chnn::Chnn),
    Lgnn(lgnn::Lgnn),
    Modlanet(modlanet::Modlanet),
    Symo(symo::Symo),
    Merge(merge::Merge),
}

impl Reproduce {
    /// Learns and prints.
    pub fn run(self, output: Output) -> Done {
        match self.paper {
            Paper::Chnn(chnn) => chnn.run(output),
            Paper::Lgnn(lgnn) => lgnn.run(output),
            Paper::Modlanet(modlanet) => modlanet.run(output),
            Paper::Symo(symo) => symo.run(output),
            Paper::Merge(merge) => merge.run(output),
        }
    }
}
