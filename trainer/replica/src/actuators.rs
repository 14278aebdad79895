use crate::{Control, ReplicaError};
use leastaction_core::forces;
use leastaction_core::forces::Actuator;
use leastaction_core::model::{ActuatorBytes, ModelError};
use std::collections::VecDeque;

/// Actuator of a file, which converts commands to the force that acts over each step: gain, offset and delay.
///
/// All commands before the first one are 0, unless [`Actuators::take_past`] sets them. Without an actuator in the file the command is the
/// force.
pub struct Actuators {
    /// Actuator of each coordinate; empty if the command is the force.
    each: Vec<Actuator<f32, 1>>,
    /// The last commands, oldest first, beginning with the one before the command that arrives next.
    past: VecDeque<Vec<f32>>,
    start: Vec<f32>,
    end: Vec<f32>,
}

impl Actuators {
    pub(crate) fn new(bytes: Option<ActuatorBytes>, n: usize, h: f32) -> Result<Self, ReplicaError> {
        let (start, end) = (vec![0.0; n], vec![0.0; n]);
        let Some(bytes) = bytes else {
            return Ok(Self { each: Vec::new(), past: VecDeque::new(), start, end });
        };
        if bytes.n() != n {
            let what = "coordinates of the actuator";
            return Err(ModelError::Shape { what, found: bytes.n(), compiled: n }.into());
        }
        let (mut each, mut whole_steps) = (Vec::new(), 0);
        let pairs = bytes.bytes().get(DELAY_BYTES..).unwrap_or_default().as_chunks::<PAIR_BYTES>().0;
        for pair in pairs {
            let own = [&bytes.delay().to_le_bytes()[..], pair].concat();
            let (late, actuator) = ActuatorBytes::new(&own)?.at_step::<1>(h)?;
            whole_steps = late;
            each.push(actuator);
        }
        let past = VecDeque::from(vec![vec![0.0; n]; usize::from(whole_steps) + 1]);
        Ok(Self { each, past, start, end })
    }

    /// Sets all earlier commands to u, for a log that begins in the middle of a motion.
    ///
    /// # Errors
    /// [`ReplicaError::Length`].
    pub fn take_past(&mut self, u: &[f32]) -> Result<(), ReplicaError> {
        ReplicaError::check_length("u", self.start.len(), u.len())?;
        self.past.iter_mut().for_each(|past| past.copy_from_slice(u));
        Ok(())
    }

    /// Force over the step that begins with the command `u` and holds it.
    ///
    /// # Errors
    /// [`ReplicaError::Length`].
    pub fn held(&mut self, u: &[f32]) -> Result<Control<'_>, ReplicaError> {
        self.over(u, u, |actuator, [before, now, _]| actuator.held(&[before], &[now]))
    }

    /// Force over the step between two samples of the command, linear between them.
    ///
    /// # Errors
    /// [`ReplicaError::Length`].
    pub fn linear(&mut self, start: &[f32], end: &[f32]) -> Result<Control<'_>, ReplicaError> {
        self.over(start, end, |actuator, [before, now, next]| actuator.linear(&[before], &[now], &[next]))
    }

    /// Applies `of` to three commands: the one before the one that has arrived, the one that has arrived, and the next.
    fn over(
        &mut self,
        start: &[f32],
        end: &[f32],
        of: impl Fn(&Actuator<f32, 1>, [f32; 3]) -> forces::Control<f32, 1>,
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
            let forces::Control { start: [start], end: [end] } = of(actuator, arrived);
            (self.start[i], self.end[i]) = (start, end);
        }
        self.past.pop_front();
        Ok(Control { start: &self.start, end: &self.end })
    }
}

/// Number of bytes of the delay in a file.
const DELAY_BYTES: usize = 4;
/// Number of bytes of a gain and its offset.
const PAIR_BYTES: usize = 8;
