//! Models that `leastaction train` learns from the files of an axis, predicted by the steps that a chip does.

use super::models::Learned;
use super::stretch::Stretch;
use crate::hardware::configured::{End, trained};
use crate::task::{TaskError, Tell};
use leastaction::look::Look;
use leastaction_core::discrete::Order;
use leastaction_learning::config::Config;
use leastaction_models::Model;
use leastaction_replica::{Control, ModelFile, Replica, Step};
use std::path::PathBuf;

/// Trains with the configuration that `leastaction look` writes for the stretches, with its table of friction or another one.
pub fn learn(
    stretches: &[&Stretch],
    friction: Option<&str>,
    quick: bool,
    tell: &Tell,
) -> Result<Learned, TaskError> {
    let folder = tempfile::tempdir()?;
    let at = folder.path().join("axis.toml");
    let files: Vec<PathBuf> = stretches.iter().map(|stretch| stretch.file.clone()).collect();
    let proposed = Look::at(&files)?.configuration(&at)?.text;
    let text = friction.map_or(Ok(proposed.clone()), |friction| with_friction(&proposed, friction))?;
    let End { trained, parameters, .. } = trained(Config::parse(&text, &at)?, (folder.path(), quick), tell)?;
    Ok(Learned { parameters, axis: None, ..of_model(&trained.model())? })
}

/// The configuration with another table of friction.
fn with_friction(text: &str, friction: &str) -> Result<String, TaskError> {
    const KEY: &str = "friction = ";
    let line = text.lines().find(|line| line.starts_with(KEY)).ok_or("look proposes no friction")?;
    Ok(text.replacen(line, &format!("{KEY}{friction}"), 1))
}

/// The predictor of a model: its file in the chip's arithmetic.
fn of_model(model: &Model) -> Result<Learned, TaskError> {
    let file = ModelFile::new(&model.to_bytes()?)?;
    // A file that gives no motion here gives none later.
    file.replica(None)?;
    let predict = move |stretch: &Stretch, parts: usize| -> Result<Vec<f64>, TaskError> {
        roll_out(&file.replica(None)?, stretch, parts)
    };
    Ok(Learned { predict: Box::new(predict), parameters: 0, axis: None })
}

/// Positions from the start of a stretch on, each force held as by a controller; every step of the log in `parts` steps.
fn roll_out(chip: &Replica, stretch: &Stretch, parts: usize) -> Result<Vec<f64>, TaskError> {
    // A model that was learned by Runge–Kutta steps states none; a chip takes those of order 2 by default.
    let order = chip.trained_step().map_or(Order::Two, |step| step.order);
    let step = Step { order, h: (stretch.h / parts as f64) as f32 };
    let mut actuators = chip.actuators(step.h)?;
    let [q, v] = stretch.start.map(|x| [x as f32]);
    let mut motion = chip.motion_at(step, &q, &v)?;
    let forces = stretch.forces();
    forces.first().map_or(Ok(()), |u| actuators.take_past(&[*u as f32]))?;
    let mut positions = vec![f64::from(q[0])];
    for u in forces {
        for _ in 0..parts {
            let Control { start, end } = actuators.held(&[*u as f32])?;
            motion.step(Control { start, end })?;
        }
        positions.extend(motion.q().iter().map(|q| f64::from(*q)));
    }
    Ok(positions)
}
