//! Steps along a log in the chip's arithmetic: what single precision costs, for a model of any size.

use super::report::{left_out, row};
use leastaction_chip::{Chip, ChipError, Control, Motion, Step};
use leastaction_core::discrete::Order;
use leastaction_core::forces::ControlKind;
use leastaction_learning::data::{Dataset, Rows, Trajectory};
use leastaction_learning::evaluate::{finished, integration_errors};
use leastaction_learning::parallel;
use serde::Serialize;
use std::fmt;

/// Errors of the chip's steps.
#[derive(Serialize)]
pub struct OnChip {
    /// Of the steps that can be solved; none: none could.
    pub one_step_mse: Option<f64>,
    /// Steps that cannot.
    pub one_step_unsolved: usize,
    /// Of the rollouts that reach the end, here and below; none: none did.
    pub rollout_mse: Option<f64>,
    pub rollout_median: Option<f64>,
    pub rollout_mse_100: Option<f64>,
    /// Rollouts that do not.
    pub rollouts_broken_off: usize,
}

impl OnChip {
    /// Steps a model along a log: from every pair of positions, and over whole trajectories from the second sample.
    pub fn measure(chip: &Chip, order: Order, log: &Dataset) -> Result<Self, ChipError> {
        let step = Step { order, h: log.h as f32 };
        let tracks: Vec<_> =
            log.trajectories.iter().map(|t| Track::new(chip, step, t, log)).collect::<Result<_, _>>()?;
        let one_steps = parallel::map(tracks.len(), &|k| tracks[k].one_steps());
        let solved: Vec<f64> = one_steps.iter().flatten().flatten().copied().collect();
        let runs = parallel::map(tracks.len(), &|k| tracks[k].run());
        let (runs, motions) = finished(&runs, log);
        let errors = (!runs.is_empty()).then(|| integration_errors(&runs, &motions));
        Ok(Self {
            one_step_mse: (!solved.is_empty()).then(|| solved.iter().sum::<f64>() / solved.len() as f64),
            one_step_unsolved: one_steps.iter().map(Vec::len).sum::<usize>() - solved.len(),
            rollout_mse: errors.as_ref().map(|errors| errors.mean),
            rollout_median: errors.as_ref().map(|errors| errors.median),
            rollout_mse_100: errors.as_ref().map(|errors| errors.first_100),
            rollouts_broken_off: log.trajectories.len() - runs.len(),
        })
    }
}

/// A trajectory in single precision.
struct Track<'l> {
    chip: &'l Chip<'l>,
    step: Step,
    logged: &'l Trajectory,
    q: Vec<Vec<f32>>,
    v: Option<Vec<Vec<f32>>>,
    /// The force over every step, at its start and at its end.
    tau: Vec<[Vec<f32>; 2]>,
}

impl<'l> Track<'l> {
    fn new(chip: &'l Chip, step: Step, logged: &'l Trajectory, log: &Dataset) -> Result<Self, ChipError> {
        let u = logged.u.as_ref().map_or_else(|| vec![vec![0.0; log.n]; logged.samples()], singles);
        let mut actuators = chip.actuators(step.h)?;
        let pairs = u.iter().zip(u.iter().skip(1));
        let tau = pairs.map(|(start, end)| {
            let control = match log.control_kind() {
                ControlKind::Held => actuators.held(start),
                ControlKind::Linear => actuators.linear(start, end),
            };
            control.map(|Control { start, end }| [start.to_vec(), end.to_vec()])
        });
        let tau = tau.collect::<Result<_, _>>()?;
        Ok(Self { chip, step, logged, q: singles(&logged.q), v: logged.v.as_ref().map(singles), tau })
    }

    fn control(&self, k: usize) -> Control<'_> {
        let [start, end] = &self.tau[k];
        Control { start, end }
    }

    /// From positions k − 1 and k.
    fn after_positions(&self, k: usize) -> Result<Box<dyn Motion + '_>, ChipError> {
        self.chip.motion_between(self.step, [&self.q[k - 1], &self.q[k]], self.control(k - 1))
    }

    /// Mean squared error of every position but the first two, from the two before it.
    fn one_steps(&self) -> Vec<Option<f64>> {
        (1..self.logged.samples().saturating_sub(1)).map(|k| self.one_step(k).ok()).collect()
    }

    fn one_step(&self, k: usize) -> Result<f64, ChipError> {
        let mut motion = self.after_positions(k)?;
        motion.step(self.control(k))?;
        let squares = motion.q().iter().zip(&self.logged.q[k + 1]).map(|(q, logged)| {
            let error = f64::from(*q) - logged;
            error * error
        });
        Ok(squares.sum::<f64>() / self.q[k].len() as f64)
    }

    /// All positions, flat, the first two as logged; not a number from a step on that cannot be solved.
    fn run(&self) -> Vec<f64> {
        let mut positions: Vec<f64> = self.logged.q.iter().take(2).flatten().copied().collect();
        let _stopped_early = self.extend(&mut positions);
        positions.resize(self.logged.q.as_flat().len(), f64::NAN);
        positions
    }

    fn extend(&self, positions: &mut Vec<f64>) -> Result<(), ChipError> {
        let mut motion = match &self.v {
            Some(v) => self.chip.motion_at(self.step, &self.q[1], &v[1])?,
            None => self.after_positions(1)?,
        };
        for k in 1..self.logged.samples().saturating_sub(1) {
            motion.step(self.control(k))?;
            positions.extend(motion.q().iter().map(|q| f64::from(*q)));
        }
        Ok(())
    }
}

/// The rows, rounded to single precision.
fn singles(rows: &Rows) -> Vec<Vec<f32>> {
    rows.iter().map(|row| row.iter().map(|x| *x as f32).collect()).collect()
}

impl fmt::Display for OnChip {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(f, "on the chip, in single precision")?;
        row(f, "  position, one step ahead", self.one_step_mse)?;
        left_out(f, self.one_step_unsolved, "steps cannot be solved")?;
        row(f, "  position, whole trajectories", self.rollout_mse)?;
        row(f, "    median over trajectories", self.rollout_median)?;
        row(f, "    first 100 steps", self.rollout_mse_100)?;
        left_out(f, self.rollouts_broken_off, "trajectories break off at a step that cannot be solved")
    }
}
