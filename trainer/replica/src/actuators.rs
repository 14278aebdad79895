use crate::{Control, ReplicaError};
use leastaction_core::forces;
use leastaction_core::forces::{Actuator, Lag, Lagging};
use leastaction_core::model::{ActuatorBytes, ModelError};
use std::collections::VecDeque;

/// Actuator of a file, which converts commands to the force that acts over each step: gain, offset, delay and lag.
///
/// All commands before the first one are 0, and so is the lagging command, unless [`Actuators::take_past`] sets them. Without an
/// actuator in the file the command is the force.
pub struct Actuators {
    /// Actuator of each coordinate; empty if the command is the force.
    each: Vec<Actuator<f32, 1>>,
    /// The last commands, oldest first, beginning with the one before the command that arrives next.
    past: VecDeque<Vec<f32>>,
    /// The lag, with the lagging command y at the end of the last step.
    lag: Option<(Lag<f32>, Vec<f32>)>,
    start: Vec<f32>,
    end: Vec<f32>,
}

impl Actuators {
    pub(crate) fn new(bytes: Option<ActuatorBytes>, n: usize, h: f32) -> Result<Self, ReplicaError> {
        let (start, end) = (vec![0.0; n], vec![0.0; n]);
        let Some(bytes) = bytes else {
            return Ok(Self { each: Vec::new(), past: VecDeque::new(), lag: None, start, end });
        };
        if bytes.n() != n {
            let what = "coordinates of the actuator";
            return Err(ModelError::Shape { what, found: bytes.n(), compiled: n }.into());
        }
        let (whole, delay) = bytes.delay_at_step(h)?;
        let own = |[gain, offset]: [f32; 2]| Actuator { gain: [gain], offset: [offset], delay };
        let each = bytes.pairs().map(own).collect();
        let lag = (bytes.lag() > 0.0).then(|| (Lag::new(bytes.lag() / h, delay), vec![0.0; n]));
        let past = VecDeque::from(vec![vec![0.0; n]; usize::from(whole) + 1]);
        Ok(Self { each, past, lag, start, end })
    }

    /// Sets all earlier commands and the lagging command to u, for a log that begins in the middle of a motion.
    ///
    /// # Errors
    /// [`ReplicaError::Length`].
    pub fn take_past(&mut self, u: &[f32]) -> Result<(), ReplicaError> {
        ReplicaError::check_length("u", self.start.len(), u.len())?;
        let y = self.lag.iter_mut().map(|(_, y)| y);
        self.past.iter_mut().chain(y).for_each(|past| past.copy_from_slice(u));
        Ok(())
    }

    /// Force over the step that begins with the command `u` and holds it.
    ///
    /// # Errors
    /// [`ReplicaError::Length`].
    pub fn held(&mut self, u: &[f32]) -> Result<Control<'_>, ReplicaError> {
        let force =
            |actuator: &Actuator<f32, 1>, [before, now, _]: [f32; 3]| actuator.held(&[before], &[now]);
        self.over(u, u, force, |lag, y, [before, now, _]| lag.held(y, before, now))
    }

    /// Force over the step between two samples of the command, linear between them.
    ///
    /// # Errors
    /// [`ReplicaError::Length`].
    pub fn linear(&mut self, start: &[f32], end: &[f32]) -> Result<Control<'_>, ReplicaError> {
        let force = |actuator: &Actuator<f32, 1>, u: [f32; 3]| {
            let [before, now, next] = u.map(|u| [u]);
            actuator.linear(&before, &now, &next)
        };
        self.over(start, end, force, |lag, y, commands| lag.linear(y, commands))
    }

    /// Applies `of`, or `lagging` if there is a lag, to three commands: the one before the one that has arrived, the one that has arrived,
    /// and the next.
    fn over(
        &mut self,
        start: &[f32],
        end: &[f32],
        of: impl Fn(&Actuator<f32, 1>, [f32; 3]) -> forces::Control<f32, 1>,
        lagging: impl Fn(&Lag<f32>, f32, [f32; 3]) -> Lagging<f32>,
    ) -> Result<Control<'_>, ReplicaError> {
        for x in [start, end] {
            ReplicaError::check_length("u", self.start.len(), x.len())?;
        }
        if self.each.is_empty() {
            self.start.copy_from_slice(start);
            self.end.copy_from_slice(end);
            return Ok(Control { start: &self.start, end: &self.end });
        }
        self.past.push_back(start.to_vec());
        let command = |k: usize, i: usize| self.past.get(k).and_then(|u| u.get(i)).or(end.get(i));
        for (i, actuator) in self.each.iter().enumerate() {
            let arrived = [0, 1, 2].map(|k| command(k, i).copied().unwrap_or(0.0));
            let force = match &mut self.lag {
                None => of(actuator, arrived),
                Some((lag, y)) => {
                    let (force, [end]) = actuator.lagging(|_| lagging(lag, y[i], arrived));
                    y[i] = end;
                    force
                }
            };
            let forces::Control { start: [start], end: [end] } = force;
            (self.start[i], self.end[i]) = (start, end);
        }
        self.past.pop_front();
        Ok(Control { start: &self.start, end: &self.end })
    }
}
