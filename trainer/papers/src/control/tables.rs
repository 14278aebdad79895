//! The three tables, ours beside the published rows.

use super::model::Model;
use super::plant::DoublePendulum;
use super::policy::{ControlError, Controller, Maker, Robot};
use super::published;
use super::robustness::{Column, share};
use super::rows::{Columns, Row};
use super::scores::{POLICY_SECONDS, SwingUp, policy_course, swing_up_course, time_up};
use leastaction_models::parallel;
use std::ops::Range;

/// A table of the competition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Table {
    /// One policy for every state: the time up in 60 s with 15 disturbances.
    Policy,
    /// One swing-up from hanging.
    Single,
    /// Swing-ups of a machine that is not what the controller thinks.
    Robustness,
}

impl Table {
    /// Name on the command line and in results.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Policy => "policy",
            Self::Single => "single",
            Self::Robustness => "robustness",
        }
    }
}

/// Rows of a table for a robot: the published ones, then those of our controllers with each of the models. The policy is run once for every
/// seed; robustness takes the first, and a single swing-up none. `note` hears what has been done.
///
/// # Errors
/// [`ControlError`] if a controller cannot be prepared.
pub fn rows(
    table: Table,
    robot: Robot,
    (controllers, models): (&[Controller], &[Model]),
    seeds: &Range<u64>,
    note: &(dyn Fn(&str) + Sync),
) -> Result<Vec<Row>, ControlError> {
    let mut rows = published_rows(table, robot);
    for controller in controllers {
        for model in models {
            note(&format!("{}, {}, {}: preparing", robot.name(), controller.name(), model.name));
            let replica = model.replica()?;
            let maker = controller.prepare(robot, &model.believed(&replica), note)?;
            let said = |what: &str| note(&format!("{}, {}: {what}", robot.name(), controller.name()));
            let (scores, columns) = match table {
                Table::Policy => policy(robot, &maker, seeds, &said),
                Table::Single => single(robot, &maker),
                Table::Robustness => robustness(robot, &maker, seeds.start, &said),
            };
            rows.push(row(table, robot, (controller.name(), Some(model.name)), &scores, columns));
        }
    }
    Ok(rows)
}

type Scored = (Vec<f64>, Columns);

fn policy(robot: Robot, maker: &Maker, seeds: &Range<u64>, said: &(dyn Fn(&str) + Sync)) -> Scored {
    let pendulum = DoublePendulum::competition();
    let count = (seeds.end - seeds.start) as usize;
    let scores = parallel::map(count, &|k| {
        let seed = seeds.start + k as u64;
        let course = policy_course(&pendulum, robot, &mut *maker(), seed, POLICY_SECONDS);
        let score = time_up(&course, POLICY_SECONDS);
        said(&format!("seed {seed}, score {score:.3}"));
        score
    });
    let least = scores.iter().copied().fold(f64::INFINITY, f64::min);
    let most = scores.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (scores, policy_columns(Some(least), Some(most)))
}

fn single(robot: Robot, maker: &Maker) -> Scored {
    let course = swing_up_course(&DoublePendulum::competition(), robot, &mut *maker());
    let found = SwingUp::of(&course);
    let costs = [found.energy, found.torque_cost, found.smoothness, found.velocity_cost];
    (vec![found.score()], single_columns(found.time, costs.map(Some)))
}

fn robustness(robot: Robot, maker: &Maker, seed: u64, said: &(dyn Fn(&str) + Sync)) -> Scored {
    let shares = Column::ALL.map(|column| {
        let share = share(column, robot, maker, seed);
        said(&format!("{} {share:.3}", column.name()));
        share
    });
    (vec![mean(&shares)], robustness_columns(&shares))
}

fn policy_columns(least: Option<f64>, most: Option<f64>) -> Columns {
    Columns(vec![("score_least", least), ("score_most", most)])
}

fn single_columns(time: Option<f64>, [energy, torque, smoothness, velocity]: [Option<f64>; 4]) -> Columns {
    Columns(vec![
        ("swing_up_s", time),
        ("energy", energy),
        ("torque_cost", torque),
        ("smoothness", smoothness),
        ("velocity_cost", velocity),
    ])
}

fn robustness_columns(shares: &[f64; 6]) -> Columns {
    Columns(Column::ALL.iter().zip(shares).map(|(column, share)| (column.name(), Some(*share))).collect())
}

/// Published rows of a table.
fn published_rows(table: Table, robot: Robot) -> Vec<Row> {
    let of = |name, score: f64, columns| row(table, robot, (name, None), &[score], columns);
    match table {
        Table::Policy => {
            let ours = published::POLICY.iter().filter(|row| row.0 == robot);
            ours.map(|(_, name, score)| of(*name, *score, policy_columns(None, None))).collect()
        }
        Table::Single => {
            let ours = published::SINGLE.iter().filter(|row| row.0 == robot);
            ours.map(|(_, name, score, time)| of(*name, *score, single_columns(*time, [None; 4]))).collect()
        }
        Table::Robustness => {
            let ours = published::ROBUSTNESS.iter().filter(|row| row.0 == robot);
            ours.map(|(_, name, shares)| of(*name, mean(shares), robustness_columns(shares))).collect()
        }
    }
}

/// A row; one without a model is published.
fn row(
    table: Table,
    robot: Robot,
    (controller, model): (&'static str, Option<&'static str>),
    scores: &[f64],
    columns: Columns,
) -> Row {
    Row {
        table: table.name(),
        robot: robot.name(),
        controller,
        model,
        published: model.is_none(),
        seeds: scores.len(),
        score_mean: mean(scores),
        score_std: deviation(scores),
        columns,
    }
}

fn mean(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / x.len() as f64
}

/// Standard deviation of a sample; `None` of a single number.
fn deviation(x: &[f64]) -> Option<f64> {
    let mean = mean(x);
    let squares: f64 = x.iter().map(|x| (x - mean) * (x - mean)).sum();
    (x.len() > 1).then(|| (squares / (x.len() - 1) as f64).sqrt())
}
