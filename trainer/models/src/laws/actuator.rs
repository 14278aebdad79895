//! Actuator of a model, which turns commands into forces.

use leastaction_core::forces::{self, ControlKind};
use leastaction_core::model::{ActuatorBytes, ModelError};
use serde::Serialize;

/// Number of bytes of the delay in a model file.
const DELAY_BYTES: usize = 4;

/// Gain, offset and delay of a drive: τ_i(t) = g_i u_i(t − d) + o_i.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Actuator {
    /// Gain g of every coordinate, not 0, N or N m per unit of command.
    pub gain: Vec<f64>,
    /// Offset o of every coordinate, N or N m.
    pub offset: Vec<f64>,
    /// Delay d ≥ 0, s.
    pub delay: f64,
}

impl Actuator {
    /// Returns the actuator whose command is the force: g = 1, o = 0, d = 0, on n coordinates.
    pub fn ideal(n: usize) -> Self {
        Self { gain: vec![1.0; n], offset: vec![0.0; n], delay: 0.0 }
    }

    /// Whether the command is the force.
    pub fn is_ideal(&self) -> bool {
        self.delay == 0.0
            && self.gain.iter().all(|gain| *gain == 1.0)
            && self.offset.iter().all(|offset| *offset == 0.0)
    }

    /// Reads the actuator from the bytes of a model file; without bytes, the command is the force on n coordinates.
    ///
    /// # Errors
    /// See [`ActuatorBytes::new`]; [`ModelError::Shape`] if it has another number of coordinates.
    pub fn from_bytes(bytes: &[u8], n: usize) -> Result<Self, ModelError> {
        if bytes.is_empty() {
            return Ok(Self::ideal(n));
        }
        let checked = ActuatorBytes::new(bytes)?;
        if checked.n() != n {
            return Err(ModelError::Shape {
                what: "coordinates of the actuator",
                found: checked.n(),
                compiled: n,
            });
        }
        let numbers = bytes.get(DELAY_BYTES..).unwrap_or_default().as_chunks::<4>().0;
        let number = |bytes: &[u8; 4]| f64::from(f32::from_le_bytes(*bytes));
        Ok(Self {
            gain: numbers.iter().step_by(2).map(number).collect(),
            offset: numbers.iter().skip(1).step_by(2).map(number).collect(),
            delay: checked.delay().into(),
        })
    }

    /// Bytes for a model file: d, then g and o of every coordinate, in single precision; empty if the command is the force.
    pub fn to_bytes(&self) -> Vec<u8> {
        if self.is_ideal() {
            return Vec::new();
        }
        let pairs = self.gain.iter().zip(&self.offset).flat_map(|(gain, offset)| [*gain, *offset]);
        std::iter::once(self.delay).chain(pairs).flat_map(|x| (x as f32).to_le_bytes()).collect()
    }

    /// Returns τ_i at the start and at the end of the step of h seconds from sample k on, with τ_i linear between them.
    /// This force has the same impulse and moment as the force that acts, as in core ([`forces::Actuator`]).
    ///
    /// `command` gives u_i at a sample; negative samples precede the first one.
    pub fn over_step(
        &self,
        (h, kind): (f64, ControlKind),
        (k, i): (usize, usize),
        command: impl Fn(isize) -> f64,
    ) -> [f64; 2] {
        let (whole, delay) = self.steps(h);
        let own = forces::Actuator::<f64, 1> { gain: [self.gain(i)], offset: [self.offset(i)], delay };
        let [before, now, next] = [0, 1, 2].map(|late| [command((k + late) as isize - (whole + 1) as isize)]);
        let forces::Control { start: [start], end: [end] } = match kind {
            ControlKind::Held => own.held(&before, &now),
            ControlKind::Linear => own.linear(&before, &now, &next),
        };
        [start, end]
    }

    /// Returns τ_i at sample k from the command that acts there; if the command changes at the sample, the new one
    /// counts.
    pub fn at_sample(
        &self,
        (h, kind): (f64, ControlKind),
        (k, i): (usize, usize),
        command: impl Fn(isize) -> f64,
    ) -> f64 {
        let (whole, part) = self.steps(h);
        let now = k as isize - whole as isize;
        let (before, now) = (command(now - 1), command(now));
        let arrived = match kind {
            ControlKind::Held if part > 0.0 => before,
            ControlKind::Held => now,
            ControlKind::Linear => now + part * (before - now),
        };
        self.output(i, arrived)
    }

    /// Force g_i u + o_i for a delayed command u, N or N m.
    pub fn output(&self, i: usize, u: f64) -> f64 {
        self.gain(i) * u + self.offset(i)
    }

    /// Gain g_i; 1 for a coordinate without an entry.
    pub fn gain(&self, i: usize) -> f64 {
        self.gain.get(i).copied().unwrap_or(1.0)
    }

    /// Offset o_i, N or N m; 0 for a coordinate without an entry.
    pub fn offset(&self, i: usize) -> f64 {
        self.offset.get(i).copied().unwrap_or(0.0)
    }

    /// Delay of a command as whole steps of h seconds and a fraction of a step.
    fn steps(&self, h: f64) -> (usize, f64) {
        let steps = if self.delay > 0.0 { self.delay / h } else { 0.0 };
        (steps as usize, steps.fract())
    }
}
