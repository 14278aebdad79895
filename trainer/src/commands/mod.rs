//! The command line: one file and one variant of [`Command`] per command.

mod adapt;
mod convert;
mod demo;
mod doctor;
mod evaluate;
mod excite;
mod export;
mod generate;
mod import;
mod inspect;
mod interrupt;
mod look;
mod motion;
mod plan;
mod progress;
mod reproduce;
mod shell;
mod simulate;
mod system;
mod train;

use clap::{Parser, Subcommand};
use leastaction::cli::Output;
use std::process::ExitCode;

/// Learn the energies of a mechanical system from logged motion, ship them as a few kilobytes of weights, and step the
/// system on a microcontroller.
///
/// Results go to stdout, messages to stderr. Exit codes: 0 success; 1 the work failed; 2 wrong usage or unreadable input;
/// 130 interrupted, with everything saved.
#[derive(Parser)]
#[command(name = "leastaction", version, max_term_width = 110)]
struct Cli {
    /// Print one JSON object on stdout and nothing else there.
    #[arg(long, global = true)]
    json: bool,
    /// Show no progress, and not which command comes next.
    #[arg(short, long, global = true)]
    quiet: bool,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Generate(generate::Generate),
    Look(look::Look),
    Train(train::Train),
    Export(export::Export),
    Inspect(inspect::Inspect),
    Convert(convert::Convert),
    Simulate(Box<simulate::Simulate>),
    Demo(demo::Demo),
    Evaluate(evaluate::Evaluate),
    Adapt(adapt::Adapt),
    Excite(excite::Excite),
    Plan(plan::Plan),
    Import(import::Import),
    Doctor(doctor::Doctor),
    Completions(shell::Completions),
    #[command(name = "man")]
    Manual(shell::Manual),
    #[command(hide = true, disable_help_flag = true)]
    Reproduce(reproduce::Reproduce),
}

/// Reads the command line and runs the command.
pub fn main() -> ExitCode {
    let cli = Cli::parse();
    let output = Output { json: cli.json, quiet: cli.quiet };
    let done = match cli.command {
        Command::Generate(command) => command.run(output),
        Command::Look(command) => command.run(output),
        Command::Train(command) => command.run(output),
        Command::Export(command) => command.run(output),
        Command::Inspect(command) => command.run(output),
        Command::Convert(command) => command.run(output),
        Command::Simulate(command) => command.run(output),
        Command::Demo(command) => command.run(output),
        Command::Evaluate(command) => command.run(output),
        Command::Adapt(command) => command.run(output),
        Command::Excite(command) => command.run(output),
        Command::Plan(command) => command.run(output),
        Command::Import(command) => command.run(output),
        Command::Doctor(command) => command.run(output),
        Command::Completions(command) => command.run(output),
        Command::Manual(command) => command.run(output),
        Command::Reproduce(command) => command.run(),
    };
    done.map_or_else(|failure| output.fail(&failure), |()| ExitCode::SUCCESS)
}
