//! The table, as text, JSON and comma-separated values.

use crate::commands::reproduce::modlanet::numbered;
use leastaction::reproduce::lgnn::{Case, Outcome, PARAMETERS, RolledOut};
use serde::Serialize;
use std::fmt;

/// The rows as comma-separated values with a header; empty where something was not measured.
pub fn csv(rows: &[Outcome]) -> String {
    let mut text = String::from(
        "case,system,count,drag,pull,kind,samples,parameters,train_mse,validation_mse,rollout_seconds,starts,\
         rollout_error,last_rollout_error,energy_violation,floor_rollout_error,floor_energy_violation,failed,\
         drag_error,step_microseconds,train_seconds,seed\n",
    );
    for row in rows {
        let Outcome { system, count, drag, pull, kind, samples, parameters, seed, .. } = row;
        let rolled_out = row.rolled_out.map_or_else(
            || ",".repeat(7),
            |r| {
                let ours =
                    format!("{:e},{:e},{:e}", r.rollout_error, r.last_rollout_error, r.energy_violation);
                let floor = format!("{:e},{:e}", r.floor_rollout_error, r.floor_energy_violation);
                format!("{},{},{ours},{floor},{}", r.rollout_seconds, r.starts, r.failed)
            },
        );
        let number = |x: Option<f64>| x.map_or(String::new(), |x| format!("{x:e}"));
        text += &format!(
            "{},{system},{count},{drag},{pull},{kind},{samples},{parameters},{:e},{:e},{rolled_out},{},{},{:.1},{seed}\n",
            name(row.case),
            row.train_mse,
            row.validation_mse,
            number(row.drag_error),
            number(row.step_microseconds),
            row.train_seconds,
        );
    }
    text
}

fn name(case: Case) -> String {
    clap::ValueEnum::to_possible_value(&case).map_or(String::new(), |value| value.get_name().to_owned())
}

/// All rows.
#[derive(Serialize)]
pub struct Table {
    /// In the order of the cases.
    pub rows: Vec<Outcome>,
    /// How the model grows, of [`Case::Scale`].
    #[serde(flatten)]
    pub growth: Option<Growth>,
}

/// How time and error go with the number of springs.
#[derive(Clone, Copy, Serialize)]
pub struct Growth {
    /// Slope of the logarithm of a step's time against that of the size.
    time_exponent: f64,
    /// Slope of the logarithm of the energy violation against that of the size.
    energy_violation_slope: f64,
    /// One step of 500 springs, µs.
    microseconds_per_step_500: f64,
}

impl Growth {
    fn of(rows: &[Outcome]) -> Option<Self> {
        let sizes = || rows.iter().filter(|row| row.case == Case::Scale);
        let points = |value: fn(&Outcome) -> Option<f64>| -> Option<Vec<(f64, f64)>> {
            sizes().map(|row| Some(((row.count as f64).ln(), value(row)?.ln()))).collect()
        };
        let microseconds_per_step_500 = sizes().find(|row| row.count == 500)?.step_microseconds?;
        Some(Self {
            time_exponent: slope(&points(|row| row.step_microseconds)?),
            energy_violation_slope: slope(&points(|row| Some(row.rolled_out?.energy_violation))?),
            microseconds_per_step_500,
        })
    }
}

/// Of the line of least squares.
fn slope(points: &[(f64, f64)]) -> f64 {
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let (sum, squares) = points
        .iter()
        .fold((0.0, 0.0), |(sum, squares), p| (sum + (p.0 - x) * (p.1 - y), squares + (p.0 - x) * (p.0 - x)));
    sum / squares
}

impl Table {
    /// Of these rows.
    pub fn new(rows: Vec<Outcome>) -> Self {
        Self { growth: Growth::of(&rows), rows }
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{:<14} {:<9} {:>5} {:>4} {:>7}", "system", "model", "drag", "pull", "samples")?;
        let names = ["param.", "train", "valid.", "RE", "RE end", "EV", "1e-8 RE", "1e-8 EV", "s"];
        names.iter().try_for_each(|name| write!(f, " {name:>8}"))?;
        writeln!(f)?;
        self.rows.iter().try_for_each(|row| {
            ours(f, row)?;
            extras(f, row)?;
            theirs(f, row)
        })?;
        if let Some(growth) = &self.growth {
            let Growth { time_exponent, energy_violation_slope, microseconds_per_step_500 } = growth;
            writeln!(
                f,
                "\nwith n springs: time of a step as n^{time_exponent:.2}, energy violation as n^{energy_violation_slope:.2};\n\
                 a step of 500: {microseconds_per_step_500:.1} us on one core in f64"
            )?;
        }
        writeln!(
            f,
            "\nRE, EV: geometric means over starts and times of the rollout error |q' - q| / (|q'| + |q|) and of the energy\n\
             violation |E' - E| / (|E'| + |E|); 1e-8: of exact motion from starts that are off by 1e-8 m. train, valid.: mean\n\
             squared error of accelerations, on samples learned from and held back; s: of training. authors': their program with\n\
             {} weights ({} with drag), on data and truth of its own integrator.",
            PARAMETERS[0], PARAMETERS[1],
        )
    }
}

fn ours(f: &mut fmt::Formatter, row: &Outcome) -> fmt::Result {
    let what = numbered(row.system, row.count);
    write!(f, "{what:<14} {:<9} {:>5} {:>4} {:>7}", row.kind, row.drag, row.pull, row.samples)?;
    write!(f, " {:>8} {:>8.1e} {:>8.1e}", row.parameters, row.train_mse, row.validation_mse)?;
    match &row.rolled_out {
        None => write!(f, "{}", format!(" {:>8}", "-").repeat(5))?,
        Some(RolledOut { rollout_error, last_rollout_error, energy_violation, .. }) => {
            write!(f, " {rollout_error:>8.1e} {last_rollout_error:>8.1e} {energy_violation:>8.1e}")?;
        }
    }
    if let Some(RolledOut { floor_rollout_error, floor_energy_violation, .. }) = &row.rolled_out {
        write!(f, " {floor_rollout_error:>8.1e} {floor_energy_violation:>8.1e}")?;
    }
    writeln!(f, " {:>8.1}", row.train_seconds)
}

fn extras(f: &mut fmt::Formatter, row: &Outcome) -> fmt::Result {
    if let Some(failed) = row.rolled_out.map(|r| r.failed).filter(|failed| *failed > 0) {
        writeln!(f, "{:<14} {failed} rollouts could not be followed to the end", "")?;
    }
    if let Some(error) = row.drag_error {
        writeln!(f, "{:<14} learned drag within {:.3}% of the exact one", "", 100.0 * error)?;
    }
    if let Some(step) = row.step_microseconds {
        writeln!(f, "{:<14} one step takes {step:.2} us", "")?;
    }
    Ok(())
}

fn theirs(f: &mut fmt::Formatter, row: &Outcome) -> fmt::Result {
    let (Some(re), Some(ev)) = (row.published.rollout_error, row.published.energy_violation) else {
        return Ok(());
    };
    let blank = format!(" {:>8}", "").repeat(3);
    writeln!(
        f,
        "{:<14} {:<9} {:>5} {:>4} {:>7}{blank} {re:>8.1e} {:>8} {ev:>8.1e}",
        "", "authors'", "", "", "", ""
    )
}
