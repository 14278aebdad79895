use super::{Command, Controller, Gains, Target};
use crate::Mechanism;
use crate::angle::difference;
use crate::error::{SetupError, require};
use crate::tick::Mode;
use core::f32::consts::TAU;
use leastaction_core::continuous::ContinuousState;
use leastaction_core::discrete::StepError;
use leastaction_core::linear::add_scaled;

/// PD feedback joint by joint, with gravity compensation at the encoders' readings, without an observer: velocities are differences of
/// readings through a first-order low-pass filter.
///
/// u = V_q(q) − D(ω²e + 2ζωė), with D the diagonal of M where the motion begins. Readings are extrapolated over the delay, at constant
/// velocity, to the time when the command acts. Source: Siciliano et al., "Robotics", 2009, section 8.5.1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ByEncoders<const N: usize> {
    gains: Gains,
    inertia: [f32; N],
    angle: [bool; N],
    tick: f32,
    /// Delay from a reading to the effect of its command, s.
    delay: f32,
    /// Cut-off frequency of the velocity filter, rad/s.
    cut_off: f32,
    /// Last reading of every encoder, with the number of ticks since.
    last: [Option<(f32, f32)>; N],
    velocity: [f32; N],
}

impl<const N: usize> ByEncoders<N> {
    /// Creates a controller with ticks of h seconds, a delay (s), and a filter with the given cut-off frequency, Hz.
    ///
    /// # Errors
    /// Gains and frequencies out of their ranges.
    pub fn new(
        (gains, inertia, angle): (Gains, [f32; N], [bool; N]),
        tick: f32,
        delay: f32,
        cut_off: f32,
    ) -> Result<Self, SetupError> {
        gains.validate()?;
        require(
            "cut-off of velocities",
            cut_off,
            cut_off.is_finite() && cut_off > 0.0,
            "finite and positive, Hz",
        )?;
        let cut_off = TAU * cut_off;
        Ok(Self { gains, inertia, angle, tick, delay, cut_off, last: [None; N], velocity: [0.0; N] })
    }

    /// Takes one reading y, `ticks` ticks after the last run.
    fn take(&mut self, i: usize, y: f32, ticks: f32) {
        if let Some((last, before)) = self.last[i] {
            let time = (before + ticks) * self.tick;
            let moved = difference(&[y], &[last], &[self.angle[i]])[0];
            // Exact response of the filter to a constant difference.
            let part = 1.0 - libm::expf(-self.cut_off * time);
            self.velocity[i] += part * (moved / time - self.velocity[i]);
        }
        self.last[i] = Some((y, 0.0));
    }
}

impl<const N: usize> Controller<N> for ByEncoders<N> {
    fn read(&mut self, elapsed: u32, measured: &[Option<f32>; N]) {
        for (i, reading) in measured.iter().enumerate() {
            match (reading, &mut self.last[i]) {
                (Some(y), _) => self.take(i, *y, elapsed as f32),
                (None, Some((_, ticks))) => *ticks += elapsed as f32,
                (None, None) => {}
            }
        }
    }

    fn command<M: Mechanism<N>>(
        &mut self,
        model: &M,
        target: &Target<N>,
        _: &ContinuousState<f32, N>,
    ) -> Result<Command<N>, StepError<f32>> {
        let read = self.last.map(|last| last.map_or(0.0, |(y, _)| y));
        let age = self.last.map(|last| self.delay + last.map_or(0.0, |(_, ticks)| ticks * self.tick));
        let ahead = core::array::from_fn(|i| age[i] * self.velocity[i]);
        let q = add_scaled(&read, 1.0, &ahead);
        let error = difference(&q, &target.q, &self.angle);
        let Gains { frequency, damping } = self.gains;
        let gravity = model.inverse_dynamics(&q, &[0.0; N], &[0.0; N])?;
        let u = core::array::from_fn(|i| {
            let rate = self.velocity[i] - target.v[i];
            gravity[i] - self.inertia[i] * frequency * (frequency * error[i] + 2.0 * damping * rate)
        });
        Ok(Command { u, mode: Mode::Track })
    }
}
