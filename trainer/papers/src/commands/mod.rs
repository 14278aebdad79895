//! The command line: one file and one variant of [`Command`] per paper.

mod chnn;
mod compared;
mod control;
mod hardware;
mod lgnn;
mod merge;
mod modlanet;
mod selection;
mod symo;

use clap::{Parser, Subcommand};
use leastaction::cli::Output;
use std::process::ExitCode;

/// Repeat the experiments of the papers that leastaction builds on, our models beside theirs.
///
/// Results go to stdout, messages to stderr. Exit codes: 0 success; 1 the work failed; 2 wrong usage or unreadable input.
#[derive(Parser)]
#[command(name = "leastaction-papers", version, max_term_width = 110)]
struct Cli {
    /// Print one JSON object on stdout and nothing else there.
    #[arg(long, global = true)]
    json: bool,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Chnn(chnn::Chnn),
    Control(control::Control),
    Hardware(hardware::Hardware),
    Lgnn(lgnn::Lgnn),
    Modlanet(modlanet::Modlanet),
    Symo(symo::Symo),
    Merge(merge::Merge),
}

/// Reads the command line and runs its command.
pub fn main() -> ExitCode {
    let cli = Cli::parse();
    let output = Output { json: cli.json, ..Output::default() };
    let done = match cli.command {
        Command::Chnn(chnn) => chnn.run(output),
        Command::Control(control) => control.run(output),
        Command::Hardware(hardware) => hardware.run(output),
        Command::Lgnn(lgnn) => lgnn.run(output),
        Command::Modlanet(modlanet) => modlanet.run(output),
        Command::Symo(symo) => symo.run(output),
        Command::Merge(merge) => merge.run(output),
    };
    done.map_or_else(|failure| output.fail(&failure), |()| ExitCode::SUCCESS)
}
