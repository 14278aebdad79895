//! The command as people use it: exit codes, files, messages.

mod baselines;
mod control;
mod hardware;
mod results;
#[path = "../robot/mod.rs"]
mod robot;
#[path = "../../../tests/cli_commands/support.rs"]
mod support;
mod swings;

/// The program under test.
const PROGRAM: &str = env!("CARGO_BIN_EXE_leastaction-papers");
