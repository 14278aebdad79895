//! Draws the pictures of the book's page on friction from real logs: `friction_pictures DIR IMAGES`, with the folders of
//! `leastaction-papers hardware` in DIR.

use leastaction_learning::data::{Rows, read_measured};
use leastaction_learning::torque::linear::Design;
use leastaction_learning::torque::{Preparation, Samples};
use leastaction_papers::hardware::Machine;
use leastaction_plot::{Angle, Panel, Phase, Series, Stroke, phase_portrait, time_series};
use nalgebra::DMatrix;
use std::error::Error;
use std::path::{Path, PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    let paths: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [data, images] = &paths[..] else { return Err("usage: friction_pictures DIR IMAGES".into()) };
    by_direction(&data.join("emps/train.csv"), &images.join("friction-by-direction.svg"))?;
    at_rest(&data.join("ur10e"), &images.join("friction-at-rest.svg"))
}

fn samples(file: &Path, machine: Machine, how: &Preparation) -> Result<Samples, Box<dyn Error>> {
    Ok(Samples::prepare(&read_measured(file, &machine.columns())?, how)?)
}

/// Least-squares factors of the columns.
fn factors(columns: &[Vec<f64>], target: &[f64]) -> Result<Vec<f64>, Box<dyn Error>> {
    let matrix = DMatrix::from_fn(target.len(), columns.len(), |row, column| columns[column][row]);
    let design = Design { matrix, target: target.to_vec(), coordinates: 1 };
    Ok(design.solve().ok_or("no samples")?.numbers)
}

fn column(rows: &Rows, i: usize) -> Vec<f64> {
    rows.column(i).collect()
}

fn sum(columns: &[Vec<f64>], factors: &[f64]) -> Vec<f64> {
    let of = |k: usize| columns.iter().zip(factors).map(|(column, factor)| factor * column[k]).sum();
    (0..columns.first().map_or(0, Vec::len)).map(of).collect()
}

/// The force of an axis less that of its inertia, over the velocity, beside two laws of friction.
fn by_direction(file: &Path, picture: &Path) -> Result<(), Box<dyn Error>> {
    let how = Preparation { cut_off: 20.0, every: 10, ..Preparation::default() };
    let Samples { v, a, tau, .. } = samples(file, Machine::Emps, &how)?;
    let [v, a, tau] = [&v, &a, &tau].map(|rows| column(rows, 0));
    let forth = |at: f64| v.iter().map(|v| if v * at > 0.0 { *v } else { 0.0 }).collect::<Vec<f64>>();
    let signs: Vec<f64> = v.iter().map(|v| v.signum()).collect();
    let ones = vec![1.0; v.len()];
    let alike = [a.clone(), v.clone(), signs.clone(), ones.clone()];
    let turned = [a.clone(), forth(1.0), forth(-1.0), signs, ones];
    let (alike, turned) = (factors(&alike, &tau)?, factors(&turned, &tau)?);
    let friction = v.iter().zip(&tau).zip(&a).map(|((v, tau), a)| (*v, tau - turned[0] * a));
    let fastest = v.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let line = |of: &dyn Fn(f64) -> f64| {
        (0..=400).map(|k| fastest * (k as f64 / 200.0 - 1.0)).map(|v| (v, of(v))).collect::<Vec<_>>()
    };
    let by_direction = |v: f64| turned[if v > 0.0 { 1 } else { 2 }] * v + turned[3] * v.signum() + turned[4];
    let same = |v: f64| alike[1] * v + alike[2] * v.signum() + alike[3];
    let series = [
        Series::new("force − inertia", friction).with_stroke(Stroke::Points),
        Series::new("one law for both directions", line(&same)).with_stroke(Stroke::Dashed),
        Series::new("friction by direction", line(&by_direction)),
    ];
    let phase = Phase { x_label: "velocity (m/s)", y_label: "force (N)", angle: Angle::No };
    phase_portrait(picture, "EMPS: the axis is braked more strongly on its way back", phase, &series)?;
    println!(
        "EMPS: viscous {:.0} N s/m forwards, {:.0} backwards; alike {:.0}",
        turned[1], turned[2], alike[1]
    );
    Ok(())
}

/// The current of a wrist joint that moves from point to point and rests, beside predictions by two laws of friction.
fn at_rest(folder: &Path, picture: &Path) -> Result<(), Box<dyn Error>> {
    const JOINT: usize = 5;
    const WIDTH: f64 = 0.003;
    let how = Preparation { step: 0.0107, cut_off: 10.0, every: 1, margin: 0.214 };
    let read = |name: &str| samples(&folder.join(format!("ur-{name}.csv")), Machine::Ur10e, &how);
    let regressors = |samples: &Samples, width: f64| {
        let [v, a] = [&samples.v, &samples.a].map(|rows| column(rows, JOINT));
        let t = v.iter().map(|v| (v / width).tanh()).collect();
        [a, v, t, vec![1.0; samples.count()]]
    };
    let kept = |samples: &Samples| samples.clone().with_friction_at_rest(&[WIDTH; 6]);
    let (train, test) = (read("20_02_12-50sec_12harm")?, read("20_01_17-ptp_10_points")?);
    let current = column(&train.tau, JOINT);
    let smooth = sum(&regressors(&test, 0.02), &factors(&regressors(&train, 0.02), &current)?);
    let sticks =
        sum(&regressors(&kept(&test), WIDTH), &factors(&regressors(&kept(&train), WIDTH), &current)?);
    let measured = column(&test.tau, JOINT);
    let shown = |values: &[f64]| {
        let all = test.t.iter().copied().zip(values.iter().copied());
        all.filter(|(t, _)| (4.0..24.0).contains(t)).collect::<Vec<_>>()
    };
    let series = [
        Series::new("measured", shown(&measured)).with_stroke(Stroke::Wide),
        Series::new("friction by the velocity alone", shown(&smooth)).with_stroke(Stroke::Dashed),
        Series::new("friction that stays at rest", shown(&sticks)),
    ];
    time_series(picture, "UR10e, joint 6, from point to point", &[Panel::new("current (A)", &series)])?;
    let error = |found: &[f64]| {
        let squares: f64 = found.iter().zip(&measured).map(|(a, b)| (a - b) * (a - b)).sum();
        (squares / found.len() as f64).sqrt()
    };
    println!(
        "UR10e, joint 6: {:.3} A by the velocity alone, {:.3} A with friction at rest",
        error(&smooth),
        error(&sticks)
    );
    Ok(())
}
