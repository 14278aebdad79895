use super::{Command, Controller, Pump, Regulator, Target};
use crate::Mechanism;
use crate::angle::difference;
use crate::error::{SetupError, require};
use crate::tick::Mode;
use leastaction_core::continuous::ContinuousState;
use leastaction_core::discrete::StepError;
use serde::{Deserialize, Serialize};

/// Conditions under which the regulator takes over from the pump, and under which it gives up.
///
/// A regulator with a small tolerance of u spares its force. Near the unstable direction it asks for about twice the
/// smallest force that can still save the mechanism. It therefore recovers, saturated, from states for which it asks
/// for up to twice the limit. A regulator that does not spare its force recovers from fewer states.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Catch {
    /// Angle from upright within which the regulator may take over, rad, > 0.
    pub angle: f32,
    /// Largest force at which the regulator may take over, as a multiple of the actuator's limit, > 0; at most 2 is sensible.
    pub force: f32,
    /// Angle beyond which the regulator gives up, rad; at least `angle`.
    pub release: f32,
}

impl Catch {
    pub(crate) fn validate(&self) -> Result<(), SetupError> {
        for (what, x) in [("catch angle", self.angle), ("catch force", self.force)] {
            require(what, x, x.is_finite() && x > 0.0, "finite and positive")?;
        }
        require("release angle", self.release, self.release >= self.angle, "at least the catch angle")
    }
}

/// Pumps energy until the mechanism is near upright, then holds it there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SwingUp<P, const N: usize> {
    /// Pump that brings the mechanism up.
    pub pump: P,
    /// Regulator that holds it.
    pub regulator: Regulator<N>,
    /// Conditions for changing between pump and regulator.
    pub catch: Catch,
    /// Index of the swinging coordinate.
    pub swinging: usize,
    /// Flags of the coordinates that are angles.
    pub angle: [bool; N],
    /// Largest force of the actuator, N or N m.
    pub limit: f32,
    /// Whether the regulator is at work.
    pub holding: bool,
}

impl<P, const N: usize> SwingUp<P, N> {
    /// Whether the regulator should be at work; `force` is the force that it asks for.
    fn holds(&self, state: &ContinuousState<f32, N>, force: f32) -> bool {
        let deviation = difference(&state.q, &self.regulator.target, &self.angle);
        debug_assert!(self.swinging < N, "one of the coordinates swings");
        // An invalid coordinate counts as never near upright.
        let angle = deviation.get(self.swinging).map_or(f32::INFINITY, |x| x.abs());
        if self.holding {
            angle < self.catch.release
        } else {
            angle < self.catch.angle && force.abs() <= self.catch.force * self.limit
        }
    }
}

impl<P: Pump<N>, const N: usize> Controller<N> for SwingUp<P, N> {
    fn command<M: Mechanism<N>>(
        &mut self,
        model: &M,
        _: &Target<N>,
        state: &ContinuousState<f32, N>,
    ) -> Result<Command<N>, StepError<f32>> {
        let force = self.regulator.force(state, &self.angle);
        self.holding = self.holds(state, force);
        if !self.holding {
            return Ok(Command { u: self.pump.force(model, state)?, mode: Mode::Swing });
        }
        let u = core::array::from_fn(|i| if i == self.regulator.input { force } else { 0.0 });
        Ok(Command { u, mode: Mode::Hold })
    }
}
