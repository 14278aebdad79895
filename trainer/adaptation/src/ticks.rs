//! Ticks of a log, as a controller would see them.

use crate::AdaptationError;
use leastaction_core::forces::ControlKind;
use leastaction_data::{Dataset, Rows, Trajectory};
use leastaction_models::Model;
use leastaction_replica::{Actuators, Instant, Replica};

/// Motion and forces at every tick of a trajectory, row by row.
pub struct Ticks {
    /// Positions and velocities.
    pub q: Vec<Vec<f32>>,
    pub v: Vec<Vec<f32>>,
    /// Commands behind the delays of the drives, and their forces; means of those before and after each tick.
    pub command: Vec<Vec<f32>>,
    pub force: Vec<Vec<f32>>,
}

impl Ticks {
    /// Reads a trajectory of a log with the actuator of the model.
    pub fn new(
        (model, chip): (&Model, &Replica),
        data: &Dataset,
        trajectory: &Trajectory,
    ) -> Result<Self, AdaptationError> {
        if data.n != model.n() {
            return Err(AdaptationError::Coordinates { found: data.n, expected: model.n() });
        }
        let u = trajectory.u.as_ref().ok_or(AdaptationError::NoCommands { id: trajectory.id })?;
        let force = forces(chip.actuators(data.h as f32)?, u, data.control_kind())?;
        let command = force.iter().map(|force| commands(model, force)).collect();
        Ok(Self { q: rows(&trajectory.q), v: speeds(trajectory, data.h), command, force })
    }

    /// State and forces at a tick.
    pub fn at(&self, k: usize) -> Instant<'_> {
        Instant { q: &self.q[k], v: &self.v[k], command: &self.command[k], force: &self.force[k] }
    }

    /// Number of ticks.
    pub fn len(&self) -> usize {
        self.q.len()
    }
}

/// Velocities of a trajectory: those of the log, else the slopes of its positions.
pub fn speeds(trajectory: &Trajectory, h: f64) -> Vec<Vec<f32>> {
    trajectory.v.as_ref().map_or_else(|| velocities(&trajectory.q, h), rows)
}

fn rows(of: &Rows) -> Vec<Vec<f32>> {
    of.iter().map(|row| row.iter().map(|x| *x as f32).collect()).collect()
}

/// Forces at the ticks: means of the end of the step before and the begin of the next.
fn forces(mut actuators: Actuators, u: &Rows, kind: ControlKind) -> Result<Vec<Vec<f32>>, AdaptationError> {
    let u = rows(u);
    let mut before: Option<Vec<f32>> = None;
    let mut forces = Vec::with_capacity(u.len());
    if let Some(first) = u.first() {
        actuators.take_past(first)?;
    }
    for (k, now) in u.iter().enumerate() {
        let next = u.get(k + 1).unwrap_or(now);
        let control = match kind {
            ControlKind::Held => actuators.held(now)?,
            ControlKind::Linear => actuators.linear(now, next)?,
        };
        let mean = |(start, before): (&f32, &f32)| 0.5 * (start + before);
        let past = before.as_deref().unwrap_or(control.start);
        forces.push(control.start.iter().zip(past).map(mean).collect());
        before = Some(control.end.to_vec());
    }
    Ok(forces)
}

/// Commands with these forces, τ = gu + o; 0 for a drive without gain.
fn commands(model: &Model, force: &[f32]) -> Vec<f32> {
    let actuator = &model.facts.actuator;
    let of = |(i, force): (usize, &f32)| {
        let number = |of: &[f64], default: f64| of.get(i).copied().unwrap_or(default) as f32;
        let (gain, offset) = (number(&actuator.gain, 1.0), number(&actuator.offset, 0.0));
        if gain == 0.0 { 0.0 } else { (force - offset) / gain }
    };
    force.iter().enumerate().map(of).collect()
}

/// Slopes of the parabolas through five samples; at the ends, those of the nearest five.
fn velocities(q: &Rows, h: f64) -> Vec<Vec<f32>> {
    let last = q.len().saturating_sub(1);
    let at = |k: usize| {
        let middle = k.clamp(2, last.saturating_sub(2).max(2));
        let row = |k: usize| q.get(k.min(last)).unwrap_or_default();
        let [a, b, c, d] = [middle - 2, middle - 1, middle + 1, middle + 2].map(row);
        let slope = |i: usize| (2.0 * (d[i] - a[i]) + (c[i] - b[i])) / (10.0 * h);
        (0..q.width()).map(|i| slope(i) as f32).collect()
    };
    (0..q.len()).map(at).collect()
}
