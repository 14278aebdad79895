use super::{Laws, Weight};
use crate::config::LEASTACTION_COORDINATES as N;
#[cfg(feature = "adapt")]
pub(crate) use adapted::{Shape, Tuned};
use core::ffi::CStr;
use leastaction_core::energy::bodies::PlanarBodies;
use leastaction_core::model::BodiesModel;

pub(crate) const FAMILY: &CStr = c"bodies";

/// A tree of rigid bodies.
pub(crate) type Mechanism = BodiesModel<'static, N, Weight, Laws>;

/// Kinetic and potential energy of the mechanism.
pub(crate) type Energy = PlanarBodies<'static, Weight, N>;

/// Models whose numbers follow the machine.
#[cfg(feature = "adapt")]
mod adapted {
    use crate::config::{BLOCK, LEASTACTION_COORDINATES as N};
    use crate::family::Laws;
    use leastaction_core::energy::bodies::{BODY_PARAMETERS as B, GRAVITY_PARAMETERS as D};
    use leastaction_core::model::{self, BodiesHeader};

    /// Shape of the model in its file.
    pub(crate) type Shape = BodiesHeader<'static>;

    /// The model with a block of numbers of its own.
    pub(crate) type Tuned = model::Tuned<'static, Laws, D, B, N, BLOCK>;
}
