use crate::training::LossKind;
use serde::{Deserialize, Serialize};

/// What a run minimises.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TrainingLoss {
    /// The residual of the three-point DEL equation.
    DelResidual,
    /// The next position.
    NextPosition,
    /// The acceleration.
    Acceleration,
    /// The next position and velocity.
    NextState,
    /// Positions over windows of many steps, each from a start state of its own ([`windows`](crate::windows)).
    Windows,
    /// The torques of the drives, at filtered states; of an arm its bodies one by one.
    Torque,
}

impl TrainingLoss {
    /// The loss of single samples, where it is one.
    pub fn of_samples(self) -> Option<LossKind> {
        match self {
            Self::DelResidual => Some(LossKind::DelResidual),
            Self::NextPosition => Some(LossKind::NextPosition),
            Self::Acceleration => Some(LossKind::Acceleration),
            Self::NextState => Some(LossKind::NextState),
            Self::Torque => Some(LossKind::Torque),
            Self::Windows => None,
        }
    }

    /// Whether it reads logged velocities.
    pub fn reads_velocities(self) -> bool {
        matches!(self, Self::Acceleration | Self::NextState | Self::Torque)
    }

    /// Whether it is one of the DEL integrator.
    pub fn is_discrete(self) -> bool {
        self.of_samples().is_some_and(LossKind::is_discrete)
    }
}

impl From<LossKind> for TrainingLoss {
    fn from(kind: LossKind) -> Self {
        match kind {
            LossKind::DelResidual => Self::DelResidual,
            LossKind::NextPosition => Self::NextPosition,
            LossKind::Acceleration => Self::Acceleration,
            LossKind::NextState => Self::NextState,
            LossKind::Torque => Self::Torque,
        }
    }
}
