//! `leastaction reproduce`.

mod lgnn;
mod modlanet;
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
    Lgnn(lgnn::Lgnn),
    Modlanet(modlanet::Modlanet),
    Symo(symo::Symo),
}

impl Reproduce {
    /// Learns and prints.
    pub fn run(self, output: Output) -> Done {
        match self.paper {
            Paper::Lgnn(lgnn) => lgnn.run(output),
            Paper::Modlanet(modlanet) => modlanet.run(output),
            Paper::Symo(symo) => symo.run(output),
        }
    }
}
