use super::Control;
use crate::scalar::Real;
use serde::{Deserialize, Serialize};

/// What happens to a command between two samples.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ControlKind {
    /// u_k acts from t_k to t_{k+1}: what a controller does.
    #[default]
    Held,
    /// Linear between u_k and u_{k+1}: what a sensor of the force samples.
    Linear,
}

/// The actuator of every coordinate: from the command u to the force τ that acts, τ(t) = g u(t − d) + o.
///
/// The delay d is a fraction of a step h here, 0 ≤ d/h ≤ 1; a longer one is whole steps, by which the caller takes older
/// commands, and this rest. g = 1, o = 0 and d = 0 is no actuator at all.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Actuator<R, const N: usize> {
    /// g, not 0: N per unit of command, or N m.
    pub gain: [R; N],
    /// o, N or N m.
    pub offset: [R; N],
    /// d/h, in [0, 1], of all coordinates.
    pub delay: R,
}

impl<R: Real, const N: usize> Actuator<R, N> {
    /// τ = u at once.
    pub fn ideal() -> Self {
        Self { gain: [R::one(); N], offset: [R::zero(); N], delay: R::zero() }
    }

    /// g u + o: the force of a command that has arrived.
    pub fn output(&self, u: &[R; N]) -> [R; N] {
        core::array::from_fn(|i| self.gain[i] * u[i] + self.offset[i])
    }

    /// (τ − o)/g: the command that brings a force about.
    pub fn command(&self, tau: &[R; N]) -> [R; N] {
        core::array::from_fn(|i| (tau[i] - self.offset[i]) / self.gain[i])
    }

    /// The force over the step that begins when `u` is commanded, `before` having been commanded one step earlier, both held.
    ///
    /// It jumps at t + d. The step sees the linear force of the same impulse ∫τ dt and moment ∫tτ dt. For a smooth command this
    /// keeps order 2; a step of order 4 keeps order 3 (4 without a jump inside the step), and 2 under a law that is nonlinear
    /// in τ, such as friction that grows with the load. Where that matters, take two steps, of d and of h − d.
    pub fn held(&self, before: &[R; N], u: &[R; N]) -> Control<R, N> {
        let (early, late) = (self.output(before), self.output(u));
        let d = self.delay;
        // Of a jump at d ∈ [0, 1]: mean d a + (1 − d) b, and slope 6d(1 − d)(b − a).
        self.control(|i| {
            let (a, b) = (early[i], late[i]);
            (a * d + b * (R::one() - d), R::constant(6.0) * d * (R::one() - d) * (b - a))
        })
    }

    /// The force over the step between two samples `start` and `end`, `before` being the one before them, linear between
    /// samples. As for [`Actuator::held`] the bend at t + d is replaced by the same impulse and moment, which
    /// keeps orders 2 and 4 for a smooth command.
    pub fn linear(&self, before: &[R; N], start: &[R; N], end: &[R; N]) -> Control<R, N> {
        let [before, start, end] = [before, start, end].map(|u| self.output(u));
        let (d, late) = (self.delay, R::one() - self.delay);
        self.control(|i| {
            let (early_rate, rate) = (start[i] - before[i], end[i] - start[i]);
            // τ(s) = start + (s − d)·rate; before the bend its rate is another, over a time d.
            let bend = early_rate - rate;
            let mean = start[i] + rate * (R::one().half() - d) - bend * d * d.half();
            let slope = rate + bend * d * d * (R::one() + late + late);
            (mean, slope)
        })
    }

    /// From the mean and the slope over the step of each coordinate.
    fn control(&self, of: impl Fn(usize) -> (R, R)) -> Control<R, N> {
        let mut control = Control::none();
        for (i, (start, end)) in control.start.iter_mut().zip(&mut control.end).enumerate() {
            let (mean, slope) = of(i);
            (*start, *end) = (mean - slope.half(), mean + slope.half());
        }
        control
    }
}
