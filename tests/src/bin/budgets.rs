//! Compares the resources of the chip's images with their budgets: `firmware-sim/chip/run.sh --budgets`.
//!
//! Reads lines of JSON, one per image, and compares every number with the line of the same board, family and order in the file named on the
//! command line. Changes are printed; more than 2% either way fails.

use serde_json::{Map, Value};
use std::error::Error;
use std::io::{Read, stdin};
use std::process::ExitCode;

/// Largest allowed change, either way.
const TOLERANCE: f64 = 0.02;
/// Names of the numbers that have a budget.
const BUDGETED: [&str; 40] = [
    "text_bytes",
    "rodata_bytes",
    "ram_bytes",
    "load_stack_bytes",
    "acceleration_stack_bytes",
    "stack_bytes",
    "acceleration_instructions",
    "inverse_dynamics_instructions",
    "inverse_dynamics_stack_bytes",
    "step_instructions",
    "step_instructions_worst",
    "damping_instructions",
    "friction_instructions",
    "friction_with_derivatives_instructions",
    "smooth_step_instructions_1",
    "sliding_step_instructions_1",
    "smooth_rest_instructions_1",
    "stuck_step_instructions_1",
    "smooth_step_instructions_2",
    "sliding_step_instructions_2",
    "smooth_rest_instructions_2",
    "stuck_step_instructions_2",
    "smooth_braking_instructions_2",
    "braking_step_instructions_2",
    "dissipation_instructions",
    "dissipation_with_derivatives_instructions",
    "dissipation_of_two_instructions",
    "dissipation_of_two_with_derivatives_instructions",
    "potential_instructions",
    "potential_with_derivatives_instructions",
    "nodes_bytes",
    "controller_bytes",
    "follow_instructions",
    "follow_tick_instructions",
    "observe_tick_instructions",
    "firmware_bytes",
    "decide_tick_instructions",
    "decide_tick_instructions_worst",
    "iteration_instructions",
    "iteration_instructions_worst",
];

type Line = Map<String, Value>;

fn main() -> ExitCode {
    match run() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("budgets: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<bool, Box<dyn Error>> {
    let file = std::env::args().nth(1).ok_or("usage: budgets FILE < LINES")?;
    let (mut found, budgets) =
        (String::new(), std::fs::read_to_string(&file).map_err(|e| format!("{file}: {e}"))?);
    stdin().read_to_string(&mut found)?;
    let (found, budgets) = (lines(&found)?, lines(&budgets)?);
    let missing: Vec<_> =
        budgets.iter().map(image).filter(|name| !found.iter().any(|line| image(line) == *name)).collect();
    missing.iter().for_each(|name| println!("{name}: was not measured"));
    let mut within = missing.is_empty();
    for line in &found {
        within &= compare(line, budgets.iter().find(|budget| image(budget) == image(line)));
    }
    println!("{}", if within { "within the budgets" } else { "NOT within the budgets" });
    Ok(within)
}

fn lines(text: &str) -> Result<Vec<Line>, serde_json::Error> {
    text.lines().filter(|line| line.starts_with('{')).map(serde_json::from_str).collect()
}

/// Name of an image: board, family, and the order or the only thing that the image does.
fn image(line: &Line) -> String {
    let words = ["board", "family", "order", "only"].into_iter().filter_map(|name| line.get(name));
    words.map(|value| value.to_string().replace('"', "")).collect::<Vec<_>>().join(" ")
}

/// Prints changes, and returns whether they are allowed.
fn compare(line: &Line, budget: Option<&Line>) -> bool {
    let Some(budget) = budget else {
        println!("{}: has no budget", image(line));
        return false;
    };
    let measured = BUDGETED.iter().filter(|name| line.contains_key(**name) || budget.contains_key(**name));
    measured.fold(true, |within, name| {
        let number = |line: &Line| line.get(*name).and_then(Value::as_f64);
        let (Some(now), Some(was)) = (number(line), number(budget)) else {
            println!("{}: no {name}", image(line));
            return false;
        };
        if now != was {
            println!("{}: {name} {was} → {now} ({:+.1}%)", image(line), 100.0 * (now / was - 1.0));
        }
        within && (now - was).abs() <= TOLERANCE * was
    })
}
