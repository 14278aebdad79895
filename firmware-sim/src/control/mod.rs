//! Controllers that know a mechanism only through its model.

mod by_encoders;
mod float;
mod pump;
mod reference;
mod regulator;
mod riccati;
mod swing_up;
mod task;
mod track;

pub use by_encoders::ByEncoders;
pub use float::Float;
pub use pump::{CartPump, JointPump, NoPump, Pump, PumpConfig};
pub use reference::{HARMONICS, Reference, Setpoint, Target, Trajectory, enter};
pub use regulator::{Regulator, Tolerance};
pub use riccati::{Linear, riccati};
pub use swing_up::{Catch, SwingUp};
pub use task::{Listen, TaskController};
pub use track::{Gains, Law, Track};

use crate::tick::Mode;
use crate::wire::array;
use leastaction_core::continuous::ContinuousState;
use leastaction_core::discrete::StepError;
use serde::{Deserialize, Serialize};

/// What a controller asks for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Command<const N: usize> {
    /// Force, N or N m; the firmware makes a command within the limits of it.
    #[serde(with = "array")]
    pub u: [f32; N],
    /// What the controller is doing.
    pub mode: Mode,
}

/// A feedback law over a model.
pub trait Controller<M, const N: usize> {
    /// What the encoders read, so many ticks after the last readings; before any command of the tick. Most controllers go by the estimate
    /// alone.
    fn read(&mut self, _elapsed: u32, _measured: &[Option<f32>; N]) {}
    /// The force for the estimated state at which it will act, towards a target. An error where the model cannot say.
    fn command(
        &mut self,
        model: &M,
        target: &Target<N>,
        state: &ContinuousState<f32, N>,
    ) -> Result<Command<N>, StepError<f32>>;
}
