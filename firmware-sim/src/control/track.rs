use super::{Command, Controller};
use crate::Mechanism;
use crate::angle::difference;
use crate::error::{SetupError, require};
use crate::tick::Mode;
use crate::wire::array;
use core::f32::consts::TAU;
use leastaction_core::continuous::ContinuousState;
use leastaction_core::discrete::StepError;
use leastaction_core::scalar::Scalar;
use serde::{Deserialize, Serialize};

/// A motion there and back, q_i = from + ½(to − from)(1 − cos 2πf(t − begin)); at rest until it begins.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reference<const N: usize> {
    /// When it begins, s: the observer needs a few samples before.
    pub begin: f32,
    /// Where it begins, rad or m.
    #[serde(with = "array")]
    pub from: [f32; N],
    /// Farthest position, rad or m.
    #[serde(with = "array")]
    pub to: [f32; N],
    /// f > 0, Hz.
    #[serde(with = "array")]
    pub frequency: [f32; N],
}

/// A point of a reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setpoint<const N: usize> {
    /// Position.
    pub q: [f32; N],
    /// Velocity.
    pub v: [f32; N],
    /// Acceleration.
    pub a: [f32; N],
}

impl<const N: usize> Reference<N> {
    /// Position, velocity and acceleration at time t, s.
    pub fn at(&self, t: f32) -> Setpoint<N> {
        let mut point = Setpoint { q: self.from, v: [0.0; N], a: [0.0; N] };
        let t = t - self.begin;
        if t < 0.0 {
            return point;
        }
        for i in 0..N {
            let (half, omega) = (0.5 * (self.to[i] - self.from[i]), TAU * self.frequency[i]);
            let (sin, cos) = Scalar::sin_cos(omega * t);
            point.q[i] += half * (1.0 - cos);
            point.v[i] = half * omega * sin;
            point.a[i] = half * omega * omega * cos;
        }
        point
    }

    pub(crate) fn validate(&self) -> Result<(), SetupError> {
        require("reference begin", self.begin, self.begin.is_finite(), "finite")?;
        for i in 0..N {
            let finite = self.from[i].is_finite() && self.to[i].is_finite();
            require("reference", self.from[i] + self.to[i], finite, "finite")?;
            let f = self.frequency[i];
            require("reference frequency", f, f.is_finite() && f > 0.0, "finite and positive")?;
        }
        Ok(())
    }
}

/// Feedback of the tracking error as a desired acceleration −ω²e − 2ζωė, the same in every coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gains {
    /// ω, rad/s, of the error's decay.
    pub frequency: f32,
    /// ζ; 1 does not overshoot.
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

/// Inverse-dynamics feed-forward along a reference, with PD feedback through the model's inertia matrix.
///
/// u = ID(q_r, v_r, a_r) − M(q)(ω²e + 2ζωė), e = q − q_r. Source: Siciliano et al., "Robotics", 2009, section 8.5.
#[derive(Clone, Copy, Debug)]
pub struct Track<const N: usize> {
    /// The motion.
    pub reference: Reference<N>,
    /// The feedback.
    pub gains: Gains,
    /// Which coordinates are angles.
    pub angle: [bool; N],
    /// From a command to its effect, s: the state that the controller sees is the one by then.
    pub delay: f32,
    /// From there to the middle of the interval over which the force is held, s.
    pub middle: f32,
}

impl<M: Mechanism<N>, const N: usize> Controller<M, N> for Track<N> {
    fn reference(&self, t: f32) -> [f32; N] {
        self.reference.at(t).q
    }

    fn command(
        &mut self,
        model: &M,
        t: f32,
        state: &ContinuousState<f32, N>,
    ) -> Result<Command<N>, StepError<f32>> {
        let t = t + self.delay;
        let (now, middle) = (self.reference.at(t), self.reference.at(t + self.middle));
        let error = difference(&state.q, &now.q, &self.angle);
        let (stiffness, damping) =
            (square(self.gains.frequency), 2.0 * self.gains.damping * self.gains.frequency);
        let wanted = core::array::from_fn(|i| stiffness * error[i] + damping * (state.v[i] - now.v[i]));
        let feedback = model.inertial_force(&state.q, &wanted);
        let feedforward = model.inverse_dynamics(&middle.q, &middle.v, &middle.a)?;
        let u = core::array::from_fn(|i| feedforward[i] - feedback[i]);
        Ok(Command { u, mode: Mode::Track })
    }
}

fn square(x: f32) -> f32 {
    x * x
}
