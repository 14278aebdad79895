use super::Control;
use crate::scalar::Real;
use serde::{Deserialize, Serialize};

/// Course of a command between two samples.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ControlKind {
    /// u_k acts from t_k to t_{k+1}, as with a controller.
    #[default]
    Held,
    /// Linear between u_k and u_{k+1}, as sampled by a force sensor.
    Linear,
}

/// Actuator of every coordinate, from the command u to the acting force τ: τ(t) = g u(t − d) + o.
///
/// Here the delay d is at most one step h, 0 ≤ d/h ≤ 1; [`Lag`](super::Lag) is a lag behind it. For a longer delay, the
/// caller takes older commands for the whole steps and leaves the remaining fraction to the actuator. g = 1, o = 0 and d = 0 mean no actuator at all.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Actuator<R, const N: usize> {
    /// Gain g, not 0: N or N m per unit of command.
    pub gain: [R; N],
    /// Offset o, N or N m.
    pub offset: [R; N],
    /// Delay d/h, in [0, 1], of all coordinates.
    pub delay: R,
}

impl<R: Real, const N: usize> Actuator<R, N> {
    /// Ideal actuator: τ = u at once.
    pub fn ideal() -> Self {
        Self { gain: [R::one(); N], offset: [R::zero(); N], delay: R::zero() }
    }

    /// Force of a command that has arrived: g u + o.
    pub fn output(&self, u: &[R; N]) -> [R; N] {
        core::array::from_fn(|i| self.gain[i] * u[i] + self.offset[i])
    }

    /// Command that brings a force about: (τ − o)/g.
    pub fn command(&self, tau: &[R; N]) -> [R; N] {
        core::array::from_fn(|i| (tau[i] - self.offset[i]) / self.gain[i])
    }

    /// The force over the step that begins when `u` is commanded, with `before` commanded one step earlier; both are held.
    ///
    /// The force jumps at t + d. The step uses the linear force with the same impulse ∫τ dt and moment ∫tτ dt
    /// instead. For a smooth command this keeps order 2. A step of order 4 keeps order 3 (order 4 without a jump
    /// inside the step), but only order 2 if a law is nonlinear in τ, such as friction that grows with the load. If
    /// that matters, take two steps, of d and of h − d.
    pub fn held(&self, before: &[R; N], u: &[R; N]) -> Control<R, N> {
        let (early, late) = (self.output(before), self.output(u));
        let d = self.delay;
        // Linear fit of a jump from a to b at d ∈ [0, 1]: mean d a + (1 − d) b, slope 6d(1 − d)(b − a).
        self.control(|i| {
            let (a, b) = (early[i], late[i]);
            (a * d + b * (R::one() - d), R::constant(6.0) * d * (R::one() - d) * (b - a))
        })
    }

    /// The force over the step between two samples `start` and `end`, with `before` the sample before them; commands are linear between
    /// samples. Like the jump in [`Actuator::held`], the bend at t + d is replaced by the linear force of the same impulse and moment,
    /// which keeps orders 2 and 4 for a smooth command.
    pub fn linear(&self, before: &[R; N], start: &[R; N], end: &[R; N]) -> Control<R, N> {
        let [before, start, end] = [before, start, end].map(|u| self.output(u));
        let (d, late) = (self.delay, R::one() - self.delay);
        self.control(|i| {
            let (early_rate, rate) = (start[i] - before[i], end[i] - start[i]);
            // τ(s) = start + (s − d)·rate after the bend; before it, for a time d, the rate is `early_rate`.
            let bend = early_rate - rate;
            let mean = start[i] + rate * (R::one().half() - d) - bend * d * d.half();
            let slope = rate + bend * d * d * (R::one() + late + late);
            (mean, slope)
        })
    }

    /// Control from the mean and the slope of each coordinate over the step.
    fn control(&self, of: impl Fn(usize) -> (R, R)) -> Control<R, N> {
        let mut control = Control::none();
        for (i, (start, end)) in control.start.iter_mut().zip(&mut control.end).enumerate() {
            let (mean, slope) = of(i);
            (*start, *end) = (mean - slope.half(), mean + slope.half());
        }
        control
    }
}
