//! Draws a table of comma-separated values on two logarithmic axes: the first column is x, the header names the curves.
//!
//!     core/benches/evaluation/instructions.sh | cargo run --release --example plot_table -- FILE.svg TITLE "y label"

use leastaction_plot::{Series, Stroke, log_log};
use std::error::Error;
use std::io::read_to_string;
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("plot_table: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, title, y_label] = arguments.as_slice() else {
        return Err("usage: plot_table FILE.svg TITLE Y_LABEL < TABLE.csv".into());
    };
    let text = read_to_string(std::io::stdin())?;
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().ok_or("no header")?.split(',').collect();
    let rows = lines.map(numbers).collect::<Result<Vec<_>, _>>()?;
    if let Some(short) = rows.iter().position(|row| row.len() != names.len()) {
        return Err(format!("line {}: not {} numbers", short + 2, names.len()).into());
    }
    let series: Vec<Series> = (1..names.len())
        .map(|k| Series::new(names[k], rows.iter().map(|row| (row[0], row[k]))).with_stroke(Stroke::Dotted))
        .collect();
    log_log(Path::new(file), title, (names[0], y_label), &series, &[1.0])?;
    Ok(())
}

fn numbers(line: &str) -> Result<Vec<f64>, String> {
    line.split(',').map(|x| x.trim().parse().map_err(|_| format!("{x:?} is not a number"))).collect()
}
