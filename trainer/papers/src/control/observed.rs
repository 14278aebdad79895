//! States that a controller estimates: velocities from positions, and the present from measurements that are late.

use super::plant::{DoublePendulum, State};
use super::policy::{Maker, Policy, Robot, TICK};
use std::collections::VecDeque;

/// Largest number of ticks by which a measurement may be late, 0.2 s.
const LATEST: usize = 100;
/// Change of a position that shows the first command's effect, rad.
const MOVED: f64 = 1e-9;

/// A law that is asked with an estimated state.
///
/// Velocities are those of the positions, whose noise is that of the encoders alone: v = (q − q₋)/h + ½h a, the model's acceleration a under the last
/// command. A run that begins at rest tells the delay of its measurements by the first command: as long as nothing has moved, all that was
/// commanded is on its way. The model then carries the measured state through the commands that it does not show yet.
pub struct Observed<'m> {
    law: Box<dyn Policy + 'm>,
    pendulum: DoublePendulum,
    robot: Robot,
    run: Option<Run>,
}

/// Memory of a run.
struct Run {
    /// Time and positions of the last call.
    last: (f64, [f64; 2]),
    /// Commands of the last ticks, the newest first.
    commands: VecDeque<f64>,
    late: Late,
}

/// Number of ticks by which measurements are late.
#[derive(Clone, Copy)]
enum Late {
    /// Nothing has moved since the run began.
    AtLeast(usize),
    /// The first command has shown.
    Known(usize),
}

impl<'m> Observed<'m> {
    /// Policies of a maker that are asked with states that are estimated by a model.
    pub fn maker(law: Maker<'m>, pendulum: DoublePendulum, robot: Robot) -> Maker<'m> {
        Box::new(move || Box::new(Self { law: law(), pendulum, robot, run: None }))
    }
}

impl Run {
    /// A run that begins.
    fn new(t: f64, q: [f64; 2], v: [f64; 2]) -> Self {
        let late = if v == [0.0; 2] { Late::AtLeast(0) } else { Late::Known(0) };
        Self { last: (t, q), commands: VecDeque::new(), late }
    }

    /// Whether a call is one tick after the last.
    fn goes_on(&self, t: f64) -> bool {
        (t - self.last.0 - TICK).abs() < 0.5 * TICK
    }

    /// Number of ticks by which the measurement of the next tick is late.
    fn late(&mut self, q: [f64; 2]) -> usize {
        let moved = || q.iter().zip(self.last.1).any(|(q, last)| (q - last).abs() > MOVED);
        self.late = match self.late {
            Late::AtLeast(ticks) if moved() => Late::Known(ticks),
            Late::AtLeast(ticks) if ticks < LATEST => {
                let sent = self.commands.iter().any(|u| *u != 0.0);
                Late::AtLeast(if sent { ticks + 1 } else { 0 })
            }
            known => known,
        };
        let (Late::AtLeast(ticks) | Late::Known(ticks)) = self.late;
        ticks
    }
}

impl Observed<'_> {
    /// The state now, from the positions of this call and of the last.
    fn estimate(&self, run: &Run, late: usize, q: [f64; 2]) -> State {
        let command = |ago: usize| self.robot.torques(run.commands.get(ago).copied().unwrap_or_default());
        let slope = |i: usize| (q[i] - run.last.1[i]) / TICK;
        let mean = [q[0], q[1], slope(0), slope(1)];
        let a = self.pendulum.acceleration(mean, command(late));
        let v = |i: usize| slope(i) + 0.5 * TICK * a[i];
        let measured = [q[0], q[1], v(0), v(1)];
        (0..late).rev().fold(measured, |x, ago| self.pendulum.step(x, command(ago), TICK))
    }
}

impl Policy for Observed<'_> {
    fn reset(&mut self) {
        self.law.reset();
        self.run = None;
    }

    fn torque(&mut self, t: f64, q: [f64; 2], v: [f64; 2]) -> f64 {
        let mut run = self.run.take().filter(|run| run.goes_on(t)).unwrap_or_else(|| Run::new(t, q, v));
        let [q1, q2, v1, v2] = if run.commands.is_empty() {
            [q[0], q[1], v[0], v[1]]
        } else {
            let late = run.late(q);
            self.estimate(&run, late, q)
        };
        let u = self.law.torque(t, [q1, q2], [v1, v2]);
        run.commands.push_front(u);
        run.commands.truncate(LATEST + 1);
        run.last = (t, q);
        self.run = Some(run);
        u
    }
}
