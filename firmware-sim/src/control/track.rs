use super::{Command, Controller, Target};
use crate::Mechanism;
use crate::angle::difference;
use crate::error::{SetupError, require};
use crate::tick::Mode;
use leastaction_core::continuous::ContinuousState;
use leastaction_core::discrete::StepError;
use serde::{Deserialize, Serialize};

/// Feedback gains: the tracking error gives a desired acceleration −ω²e − 2ζωė, with equal gains in every coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gains {
    /// Rate ω of the error's decay, rad/s.
    pub frequency: f32,
    /// Damping ratio ζ; 1 does not overshoot.
    pub damping: f32,
}

impl Gains {
    pub(crate) fn validate(&self) -> Result<(), SetupError> {
        let gains = [("tracking frequency", self.frequency), ("tracking damping", self.damping)];
        for (what, x) in gains {
            require(what, x, x.is_finite() && x >= 0.0, "finite and not negative")?;
        }
        Ok(())
    }
}

/// Control law for following a reference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Law {
    /// Feed-forward by the model's inverse dynamics, feedback through its inertia matrix.
    #[default]
    ComputedTorque,
    /// Gravity compensation at the present position, and PD feedback joint by joint: the usual alternative.
    PdGravity,
}

/// Inverse-dynamics feed-forward along a reference, with PD feedback through the model's inertia matrix.
///
/// u = ID(q_r, v_r, a_r) − M(q)(ω²e + 2ζωė), e = q − q_r; or, by [`Law::PdGravity`], u = V_q(q) − D(ω²e + 2ζωė) with D the diagonal of M
/// where the motion begins. Source: Siciliano et al., "Robotics", 2009, sections 8.5 and 8.5.1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Track<const N: usize> {
    /// Feedback gains.
    pub gains: Gains,
    /// Use of feed-forward and feedback.
    pub law: Law,
    /// Diagonal D of the inertia matrix, kg m² or kg.
    pub inertia: [f32; N],
    /// Flags of the coordinates that are angles.
    pub angle: [bool; N],
}

impl<const N: usize> Controller<N> for Track<N> {
    fn command<M: Mechanism<N>>(
        &mut self,
        model: &M,
        target: &Target<N>,
        state: &ContinuousState<f32, N>,
    ) -> Result<Command<N>, StepError<f32>> {
        let Target { q, v, middle } = target;
        let error = difference(&state.q, q, &self.angle);
        let (stiffness, damping) =
            (square(self.gains.frequency), 2.0 * self.gains.damping * self.gains.frequency);
        let wanted = core::array::from_fn(|i| stiffness * error[i] + damping * (state.v[i] - v[i]));
        let (feedforward, feedback) = match self.law {
            Law::ComputedTorque => (
                model.inverse_dynamics(&middle.q, &middle.v, &middle.a)?,
                model.inertial_force(&state.q, &wanted),
            ),
            Law::PdGravity => (
                model.inverse_dynamics(&state.q, &[0.0; N], &[0.0; N])?,
                core::array::from_fn(|i| self.inertia[i] * wanted[i]),
            ),
        };
        let u = core::array::from_fn(|i| feedforward[i] - feedback[i]);
        Ok(Command { u, mode: Mode::Track })
    }
}

fn square(x: f32) -> f32 {
    x * x
}
