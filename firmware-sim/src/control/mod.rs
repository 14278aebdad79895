//! Controllers that know a mechanism only through its model.

mod by_encoders;
mod coordinates;
mod float;
mod follow;
mod mpc;
mod mpc_settings;
mod plans;
mod pump;
mod reference;
mod regulator;
mod swing_up;
mod task;
mod track;

pub use by_encoders::ByEncoders;
pub use coordinates::SwungUp;
pub use float::Float;
pub use follow::Follow;
pub use mpc::{Mpc, NODES, NoMpc, Nodes, blank_nodes};
pub use mpc_settings::MpcSettings;
pub(crate) use plans::collected;
pub use plans::{MAX_PLANS, Plans};
pub use pump::{CartPump, JointPump, NoPump, Pump, PumpConfig};
pub use reference::{HARMONICS, Reference, Setpoint, Target, Trajectory, enter};
pub use regulator::{Regulator, Tolerance};
pub use swing_up::{Catch, SwingUp};
pub use task::{Listen, TaskController};
pub use track::{Gains, Law, Track};

use crate::Mechanism;
use crate::tick::Mode;
use crate::wire::array;
use leastaction_core::continuous::ContinuousState;
pub use leastaction_core::control::{Coordinates, States};
use leastaction_core::discrete::StepError;
use serde::{Deserialize, Serialize};

/// Output of a controller.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Command<const N: usize> {
    /// Force, N or N m; the firmware turns it into a command within the limits.
    #[serde(with = "array")]
    pub u: [f32; N],
    /// Mode of the controller.
    pub mode: Mode,
}

/// A feedback law over a model.
pub trait Controller<const N: usize> {
    /// Takes the encoders' readings, `elapsed` ticks after the last readings, before any command of the tick. Most controllers use only the
    /// estimate.
    fn read(&mut self, _elapsed: u32, _measured: &[Option<f32>; N]) {}
    /// Computes the force towards a target from the estimated state at which the force will act. An error if the model cannot compute it.
    fn command<M: Mechanism<N>>(
        &mut self,
        model: &M,
        target: &Target<N>,
        state: &ContinuousState<f32, N>,
    ) -> Result<Command<N>, StepError<f32>>;
}
