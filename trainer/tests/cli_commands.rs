//! The command as people use it: exit codes, files, messages, interruption.

#[path = "cli_commands/actuators.rs"]
mod actuators;
#[path = "cli_commands/adapt.rs"]
mod adapt;
#[path = "cli_commands/arms.rs"]
mod arms;
#[path = "cli_commands/bags.rs"]
mod bags;
#[path = "cli_commands/changes.rs"]
mod changes;
#[path = "cli_commands/control.rs"]
mod control;
#[path = "cli_commands/corrections.rs"]
mod corrections;
#[path = "cli_commands/descriptions.rs"]
mod descriptions;
#[path = "cli_commands/doctor.rs"]
mod doctor;
#[path = "cli_commands/doubtful_logs.rs"]
mod doubtful_logs;
#[path = "cli_commands/drift.rs"]
mod drift;
#[path = "cli_commands/files.rs"]
mod files;
#[path = "cli_commands/folders.rs"]
mod folders;
#[path = "cli_commands/follow.rs"]
mod follow;
#[path = "cli_commands/friction.rs"]
mod friction;
#[path = "cli_commands/generate.rs"]
mod generate;
#[path = "cli_commands/graphs.rs"]
mod graphs;
#[path = "cli_commands/import.rs"]
mod import;
#[path = "cli_commands/interrupt.rs"]
mod interrupt;
#[path = "cli_commands/layouts.rs"]
mod layouts;
#[path = "cli_commands/lerobot.rs"]
mod lerobot;
#[path = "cli_commands/logs.rs"]
mod logs;
#[path = "cli_commands/named_columns.rs"]
mod named_columns;
#[path = "cli_commands/on_a_board.rs"]
mod on_a_board;
#[path = "cli_commands/on_chip.rs"]
mod on_chip;
#[path = "cli_commands/readings.rs"]
mod readings;
#[path = "cli_commands/replaced.rs"]
mod replaced;
#[path = "cli_commands/resume.rs"]
mod resume;
#[path = "cli_commands/simulate.rs"]
mod simulate;
#[path = "cli_commands/stops.rs"]
mod stops;
#[path = "cli_commands/support.rs"]
mod support;
#[path = "cli_commands/swing_up.rs"]
mod swing_up;
#[path = "cli_commands/train.rs"]
mod train;
#[path = "cli_commands/trees.rs"]
mod trees;
#[path = "cli_commands/unsolved.rs"]
mod unsolved;

/// Program under test.
const PROGRAM: &str = env!("CARGO_BIN_EXE_leastaction");

#[test]
fn reproduce_names_the_command_of_the_papers() {
    let bench = support::Bench::new();
    for words in ["symo --quick", "--help"] {
        let named = format!("leastaction-papers {words}");
        bench.run(&format!("reproduce {words}")).bad(2, &[&named]);
    }
    let help = bench.run("--help").good();
    assert!(!help.stdout.contains("reproduce"), "{}", help.stdout);
}
