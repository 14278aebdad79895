//! Experiments of the papers, with our models beside theirs: tasks give records, which become tables and pages.
//!
//! Each paper's module has its protocol ([`modlanet`], [`lgnn`], [`symo`], [`chnn`]); [`hardware`] has that of logs
//! recorded on robots, [`control`] a competition on a double pendulum; `baselines` are the models that the papers compare with. The command is `leastaction-papers`.

mod baselines;
pub mod chnn;
mod compared;
pub mod control;
pub mod folder;
pub mod hardware;
mod interrupted;
pub mod lgnn;
pub mod modlanet;
mod papers;
mod published;
pub mod record;
mod rollouts;
pub mod symo;
pub mod table;
pub mod task;
mod training;

pub use papers::{CHNN, HARDWARE, LGNN, MODLANET, Overview, PAPERS, PageError, Paper, SYMO};
pub use training::Limits;

/// Name of a system with its number of elements: 2-pendulum.
pub fn numbered(system: &str, count: usize) -> String {
    format!("{count}-{}", system.trim_start_matches("n-"))
}

/// Name of a value on the command line.
fn option_name(value: &impl clap::ValueEnum) -> String {
    value.to_possible_value().map_or(String::new(), |value| value.get_name().to_owned())
}

/// Returns each item once, in the order of first occurrence.
fn distinct<'t>(all: impl Iterator<Item = &'t str>) -> Vec<&'t str> {
    let mut seen: Vec<&str> = Vec::new();
    for one in all {
        if !seen.contains(&one) {
            seen.push(one);
        }
    }
    seen
}
