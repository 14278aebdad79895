use super::{Laws, Weight};
use crate::config::LEASTACTION_COORDINATES as N;
#[cfg(feature = "adapt")]
pub(crate) use adapted::{Shape, Tuned};
use core::ffi::CStr;
use leastaction_core::energy::arm::ArmBodies;
use leastaction_core::model::ArmModel;

pub(crate) const FAMILY: &CStr = c"arm";

/// A tree of rigid bodies in space.
pub(crate) type Mechanism = ArmModel<'static, N, Weight, Laws>;

/// Kinetic and potential energy of the mechanism.
pub(crate) type Energy = ArmBodies<'static, Weight, N>;

/// Models whose numbers follow the machine.
#[cfg(feature = "adapt")]
mod adapted {
    use crate::config::{BLOCK, LEASTACTION_COORDINATES as N};
    use crate::family::Laws;
    use leastaction_core::energy::arm::{ARM_GRAVITY_PARAMETERS as D, ARM_PARAMETERS as B};
    use leastaction_core::model::{self, ArmHeader};

    /// Shape of the model in its file.
    pub(crate) type Shape = ArmHeader<'static>;

    /// The model with a block of numbers of its own.
    pub(crate) type Tuned = model::Tuned<'static, Laws, D, B, N, BLOCK>;
}
