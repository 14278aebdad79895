//! The command as people use it: exit codes, files, messages, interruption.

#[path = "cli_commands/baselines.rs"]
mod baselines;
#[path = "cli_commands/files.rs"]
mod files;
#[path = "cli_commands/generate.rs"]
mod generate;
#[path = "cli_commands/graphs.rs"]
mod graphs;
#[path = "cli_commands/import.rs"]
mod import;
#[path = "cli_commands/interrupt.rs"]
mod interrupt;
#[path = "cli_commands/on_a_board.rs"]
mod on_a_board;
#[path = "cli_commands/reproduce.rs"]
mod reproduce;
#[path = "cli_commands/resume.rs"]
mod resume;
#[path = "cli_commands/simulate.rs"]
mod simulate;
#[path = "cli_commands/support.rs"]
mod support;
#[path = "cli_commands/train.rs"]
mod train;
#[path = "cli_commands/trees.rs"]
mod trees;
