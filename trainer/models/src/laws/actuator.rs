//! Actuator of a model, which turns commands into forces.

use leastaction_core::forces::{self, ControlKind, Lag};
use leastaction_core::model::{ActuatorBytes, ModelError};
use serde::Serialize;

/// Gain, offset, delay and lag of a drive: τ_i = g_i y_i + o_i with T ẏ_i = u_i(t − d) − y_i; without a lag, y_i(t) = u_i(t − d).
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Actuator {
    /// Gain g of every coordinate, not 0, N or N m per unit of command.
    pub gain: Vec<f64>,
    /// Offset o of every coordinate, N or N m.
    pub offset: Vec<f64>,
    /// Delay d ≥ 0, s.
    pub delay: f64,
    /// Time constant T ≥ 0 of the lag, s; 0: none.
    pub lag: f64,
}

/// Lagging commands y at every sample of a log, \[samples\]\[n\], flat; empty without a lag.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LaggingCommands {
    n: usize,
    y: Vec<f64>,
    /// The lag over a step; `None` without a lag.
    lag: Option<Lag<f64>>,
}

impl LaggingCommands {
    /// y_i at sample k, or at the last one; NaN if there is none.
    fn at(&self, k: usize, i: usize) -> f64 {
        let last = (self.y.len() / self.n.max(1)).saturating_sub(1);
        self.y.get(k.min(last) * self.n + i).copied().unwrap_or(f64::NAN)
    }
}

impl Actuator {
    /// Returns the actuator whose command is the force: g = 1, o = 0, d = T = 0, on n coordinates.
    pub fn ideal(n: usize) -> Self {
        Self { gain: vec![1.0; n], offset: vec![0.0; n], delay: 0.0, lag: 0.0 }
    }

    /// Whether the command is the force.
    pub fn is_ideal(&self) -> bool {
        [self.delay, self.lag] == [0.0; 2]
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
        let numbers = |k: usize| checked.pairs().map(|pair| pair[k].into()).collect();
        Ok(Self {
            gain: numbers(0),
            offset: numbers(1),
            delay: checked.delay().into(),
            lag: checked.lag().into(),
        })
    }

    /// Bytes for a model file: d, then g and o of every coordinate, then T unless it is 0, in single precision; empty if the command is the
    /// force.
    pub fn to_bytes(&self) -> Vec<u8> {
        if self.is_ideal() {
            return Vec::new();
        }
        let pairs = self.gain.iter().zip(&self.offset).flat_map(|(gain, offset)| [*gain, *offset]);
        let lag = Some(self.lag).filter(|lag| *lag as f32 != 0.0);
        std::iter::once(self.delay).chain(pairs).chain(lag).flat_map(|x| (x as f32).to_le_bytes()).collect()
    }

    /// Lagging commands along a log of `samples` samples on n coordinates; y begins at the command that precedes the log, at rest.
    /// `command` gives u_i at a sample; negative samples precede the first one.
    pub fn lagging(
        &self,
        (h, kind): (f64, ControlKind),
        (samples, n): (usize, usize),
        command: impl Fn(isize, usize) -> f64,
    ) -> LaggingCommands {
        let (whole, lag) = self.lag_at_step(h);
        let Some(lag) = lag else { return LaggingCommands::default() };
        let mut y: Vec<f64> = (0..n).map(|i| command(-(whole as isize) - 1, i)).collect();
        for (k, i) in (1..samples).flat_map(|k| (0..n).map(move |i| (k - 1, i))) {
            let before = y[k * n + i];
            y.push(lagged(&lag, kind, before, around(whole, k, |k| command(k, i))).end);
        }
        LaggingCommands { n, y, lag: Some(lag) }
    }

    /// Returns τ_i at the start and at the end of the step of h seconds from sample k on, with τ_i linear between them.
    /// This force has the same impulse and moment as the force that acts, as in core ([`forces::Actuator`], [`Lag`]).
    ///
    /// `command` gives u_i at a sample; negative samples precede the first one. `lagging` are the
    /// [`Actuator::lagging`] commands of that log.
    pub fn over_step(
        &self,
        (h, kind): (f64, ControlKind),
        (k, i): (usize, usize),
        lagging: &LaggingCommands,
        command: impl Fn(isize) -> f64,
    ) -> [f64; 2] {
        let (whole, delay) = self.steps(h);
        let commands = around(whole, k, command);
        if self.lag > 0.0 {
            let line = lagging.lag.map(|lag| lagged(&lag, kind, lagging.at(k, i), commands).line());
            return line.unwrap_or([f64::NAN; 2]).map(|y| self.output(i, y));
        }
        let own = forces::Actuator::<f64, 1> { gain: [self.gain(i)], offset: [self.offset(i)], delay };
        let [before, now, next] = commands.map(|u| [u]);
        let forces::Control { start: [start], end: [end] } = match kind {
            ControlKind::Held => own.held(&before, &now),
            ControlKind::Linear => own.linear(&before, &now, &next),
        };
        [start, end]
    }

    /// Returns τ_i at sample k from the command that acts there; if the command changes at the sample, the new one
    /// counts. The arguments are those of [`Actuator::over_step`].
    pub fn at_sample(
        &self,
        (h, kind): (f64, ControlKind),
        (k, i): (usize, usize),
        lagging: &LaggingCommands,
        command: impl Fn(isize) -> f64,
    ) -> f64 {
        if self.lag > 0.0 {
            return self.output(i, lagging.at(k, i));
        }
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

    /// Whole steps of the delay, and the lag behind the rest of it, for steps of h seconds; `None` without a lag.
    fn lag_at_step(&self, h: f64) -> (usize, Option<Lag<f64>>) {
        let (whole, delay) = self.steps(h);
        (whole, (self.lag > 0.0).then(|| Lag::new(self.lag / h, delay)))
    }

    /// Delay of a command as whole steps of h seconds and a fraction of a step.
    fn steps(&self, h: f64) -> (usize, f64) {
        let steps = if self.delay > 0.0 { self.delay / h } else { 0.0 };
        (steps as usize, steps.fract())
    }
}

/// Commands around step k that are `whole` steps late: the one before it, those at its beginning and at its end.
fn around(whole: usize, k: usize, command: impl Fn(isize) -> f64) -> [f64; 3] {
    [0, 1, 2].map(|late| command((k + late) as isize - (whole + 1) as isize))
}

/// The lagging command over a step that begins at y.
fn lagged(lag: &Lag<f64>, kind: ControlKind, y: f64, commands: [f64; 3]) -> forces::Lagging<f64> {
    match kind {
        ControlKind::Held => lag.held(y, commands[0], commands[1]),
        ControlKind::Linear => lag.linear(y, commands),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP: f64 = 0.01;

    fn driven(lag: f64) -> Actuator {
        Actuator { gain: vec![2.0, -0.5], offset: vec![0.25, 0.125], delay: 0.013, lag }
    }

    #[test]
    fn a_lag_is_behind_the_numbers_of_the_file() {
        let (with, without) = (driven(0.008).to_bytes(), driven(0.0).to_bytes());
        assert_eq!((with.len(), without.len()), (24, 20));
        assert_eq!(with[..20], without[..]);
        let found = Actuator::from_bytes(&with, 2).unwrap();
        assert_eq!((found.lag, found.offset), (f64::from(0.008_f32), vec![0.25, 0.125]));
        assert_eq!(Actuator::from_bytes(&without, 2).unwrap().lag, 0.0);
        let alone = Actuator { lag: 0.008, ..Actuator::ideal(2) };
        assert!(!alone.is_ideal() && alone.to_bytes().len() == 24);
    }

    /// A log begins at rest, where y is the first command; the force of a log at rest is that of its command, and ends of steps are those of
    /// y at the samples for commands that change slowly.
    #[test]
    fn a_log_begins_at_its_first_command() {
        let command = |k: isize, i: usize| if k < 5 { 1.5 } else { -2.0 + i as f64 };
        for kind in [ControlKind::Held, ControlKind::Linear] {
            let (own, step) = (driven(0.008), (STEP, kind));
            let lagging = own.lagging(step, (20, 2), command);
            let force = |k: usize, i: usize| own.over_step(step, (k, i), &lagging, |k| command(k, i));
            for i in 0..2 {
                assert_eq!(force(0, i), [own.output(i, 1.5); 2], "{kind:?}");
                assert_eq!(own.at_sample(step, (3, i), &lagging, |k| command(k, i)), own.output(i, 1.5));
                let at = |k: usize| own.at_sample(step, (k, i), &lagging, |k| command(k, i));
                // 1.3 steps of delay after the change, y goes towards the new command by the same part in every step.
                let left = |k: usize| at(k) - own.output(i, -2.0 + i as f64);
                assert!((left(12) / left(11) - (-STEP / own.lag).exp()).abs() < 1e-9, "{kind:?}");
                assert!(at(6) == own.output(i, 1.5) || kind == ControlKind::Linear);
                let [start, end] = force(15, i);
                let whole = own.lag * (left(15) - left(16));
                let impulse = STEP * own.output(i, -2.0 + i as f64) + whole;
                assert!((0.5 * STEP * (start + end) - impulse).abs() < 1e-12, "{kind:?}");
            }
        }
    }
}
