use super::{Laws, Weight};
use crate::config::LEASTACTION_COORDINATES as N;
use crate::error::Error;
use core::ffi::{CStr, c_char};
use leastaction_core::energy::arm::ArmBodies;
use leastaction_core::forces::System;
use leastaction_core::model::ArmModel;

pub(crate) const FAMILY: &CStr = c"arm";

/// No lists beside the file.
pub(crate) struct Lists;

impl Lists {
    pub fn empty() -> Self {
        Self
    }
}

/// A tree of rigid bodies in space.
pub(crate) type Mechanism = ArmModel<'static, N, Weight, Laws>;

type Parts<'a> = System<&'a ArmBodies<'static, Weight, N>, &'a Laws>;

/// # Safety
/// None: an arm has no name to read.
pub(crate) unsafe fn load(
    bytes: &'static [u8],
    _: *const c_char,
    _: &'static mut Lists,
) -> Result<Mechanism, Error> {
    Ok(Mechanism::load(bytes)?)
}

pub(crate) fn system(mechanism: &Mechanism) -> Parts<'_> {
    System { lagrangian: &mechanism.system.lagrangian, forces: &mechanism.system.forces }
}
