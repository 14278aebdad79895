use crate::training::LossKind;
use serde::{Deserialize, Serialize};

/// The loss that a run minimises.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TrainingLoss {
    /// The residual of the three-point DEL equation.
    DelResidual,
    /// Error of the next position.
    NextPosition,
    /// Error of the acceleration.
    Acceleration,
    /// Error of the next position and velocity.
    NextState,
    /// Errors of positions over windows of many steps, each from a start state of its own ([`windows`](crate::windows)).
    Windows,
    /// Errors of the drive torques at filtered states; the bodies of an arm are first identified by a fit of their own.
    Torque,
}

impl TrainingLoss {
    /// The corresponding loss over single samples; `None` for windows.
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

    /// Whether the loss needs logged velocities.
    pub fn reads_velocities(self) -> bool {
        matches!(self, Self::Acceleration | Self::NextState | Self::Torque)
    }

    /// Whether the loss uses the DEL integrator.
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
