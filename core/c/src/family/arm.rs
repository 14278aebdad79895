use super::{Laws, Weight};
use crate::config::LEASTACTION_COORDINATES as N;
use core::ffi::CStr;
use leastaction_core::energy::arm::ArmBodies;
use leastaction_core::model::ArmModel;

pub(crate) const FAMILY: &CStr = c"arm";

/// A tree of rigid bodies in space.
pub(crate) type Mechanism = ArmModel<'static, N, Weight, Laws>;

/// Kinetic and potential energy of the mechanism.
pub(crate) type Energy = ArmBodies<'static, Weight, N>;
