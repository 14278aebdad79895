//! Steps along a log in the chip's arithmetic: the effect of single precision, for a model of any size.

use super::report::Steps;
use leastaction_core::discrete::Order;
use leastaction_core::forces::ControlKind;
use leastaction_learning::data::{Dataset, Rows, Trajectory};
use leastaction_learning::evaluate::finished;
use leastaction_learning::training::Solved;
use leastaction_models::parallel;
use leastaction_replica::{Control, Motion, Replica, ReplicaError, Step};

/// Steps a model along a log: one step from every pair of positions, and whole trajectories from the second sample on.
pub fn steps(chip: &Replica, order: Order, log: &Dataset) -> Result<Steps, ReplicaError> {
    let step = Step { order, h: log.h as f32 };
    let tracks: Vec<_> =
        log.trajectories.iter().map(|t| Track::new(chip, step, t, log)).collect::<Result<_, _>>()?;
    let one_steps = parallel::map(tracks.len(), &|k| tracks[k].one_steps());
    let solved: Vec<f64> = one_steps.iter().flatten().flatten().copied().collect();
    let one_step = Solved {
        mean_square: (!solved.is_empty()).then(|| solved.iter().sum::<f64>() / solved.len() as f64),
        unsolved: one_steps.iter().map(Vec::len).sum::<usize>() - solved.len(),
    };
    let runs = parallel::map(tracks.len(), &|k| tracks[k].run());
    let (runs, motions) = finished(&runs, log);
    Ok(Steps::new(one_step, (&runs, &motions), log.trajectories.len()))
}

/// A trajectory in single precision.
struct Track<'l> {
    chip: &'l Replica<'l>,
    step: Step,
    logged: &'l Trajectory,
    q: Vec<Vec<f32>>,
    v: Option<Vec<Vec<f32>>>,
    /// Forces over every step, at its start and at its end.
    tau: Vec<[Vec<f32>; 2]>,
}

impl<'l> Track<'l> {
    fn new(
        chip: &'l Replica,
        step: Step,
        logged: &'l Trajectory,
        log: &Dataset,
    ) -> Result<Self, ReplicaError> {
        let u = logged.u.as_ref().map_or_else(|| vec![vec![0.0; log.n]; logged.samples()], singles);
        let mut actuators = chip.actuators(step.h)?;
        u.first().map_or(Ok(()), |first| actuators.take_past(first))?;
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

    /// Begins a motion from positions k − 1 and k.
    fn after_positions(&self, k: usize) -> Result<Box<dyn Motion + '_>, ReplicaError> {
        self.chip.motion_between(self.step, [&self.q[k - 1], &self.q[k]], self.control(k - 1))
    }

    /// Mean squared errors of every position except the first two, each predicted from the two before it; `None` if a
    /// step cannot be solved.
    fn one_steps(&self) -> Vec<Option<f64>> {
        (1..self.logged.samples().saturating_sub(1)).map(|k| self.one_step(k).ok()).collect()
    }

    fn one_step(&self, k: usize) -> Result<f64, ReplicaError> {
        let mut motion = self.after_positions(k)?;
        motion.step(self.control(k))?;
        let squares = motion.q().iter().zip(&self.logged.q[k + 1]).map(|(q, logged)| {
            let error = f64::from(*q) - logged;
            error * error
        });
        Ok(squares.sum::<f64>() / self.q[k].len() as f64)
    }

    /// All positions, flat, the first two as logged; NaN from the first step that cannot be solved.
    fn run(&self) -> Vec<f64> {
        let mut positions: Vec<f64> = self.logged.q.iter().take(2).flatten().copied().collect();
        let _stopped_early = self.extend(&mut positions);
        positions.resize(self.logged.q.as_flat().len(), f64::NAN);
        positions
    }

    fn extend(&self, positions: &mut Vec<f64>) -> Result<(), ReplicaError> {
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

/// Rows, rounded to single precision.
fn singles(rows: &Rows) -> Vec<Vec<f32>> {
    rows.iter().map(|row| row.iter().map(|x| *x as f32).collect()).collect()
}
