use super::{Laws, Weight};
use crate::config::LEASTACTION_COORDINATES as N;
use core::ffi::CStr;
use leastaction_core::energy::bodies::PlanarBodies;
use leastaction_core::model::BodiesModel;

pub(crate) const FAMILY: &CStr = c"bodies";

/// A tree of rigid bodies.
pub(crate) type Mechanism = BodiesModel<'static, N, Weight, Laws>;

/// Kinetic and potential energy of the mechanism.
pub(crate) type Energy = PlanarBodies<'static, Weight, N>;
