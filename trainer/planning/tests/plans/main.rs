//! Plans from configurations: problems solved, limits kept, and what is wrong said.

mod configuration;
mod motions;

use leastaction_planning::{Machine, Plan, PlanConfig, PlanError, Task, plan};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// Folder of the problems that other programs solve, too.
fn problems() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/peers/control")
}

/// A problem with these lines added to, or put in place of, those of its file.
fn problem(name: &str, changed: impl Fn(&str) -> String) -> Result<(Machine, Task), PlanError> {
    let file = problems().join(format!("{name}.toml"));
    let text = changed(&std::fs::read_to_string(&file).unwrap());
    let mut config = PlanConfig::parse(&text, &file)?;
    config.model = problems().join(&config.model);
    let machine = Machine::of_description(&config.model)?;
    let task = Task::new(&config, &machine)?;
    Ok((machine, task))
}

fn solved(machine: &Machine, task: &Task) -> Plan {
    plan(machine, task, None, (&AtomicBool::new(false), &())).unwrap()
}
