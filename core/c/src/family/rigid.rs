use super::{Laws, Weight};
use crate::config::{LEASTACTION_COORDINATES as N, LEASTACTION_HIDDEN as H, LEASTACTION_LAYERS as L};
use crate::error::Error;
use core::ffi::{CStr, c_char};
use leastaction_core::energy::rigid::Rigid;
use leastaction_core::forces::System;
use leastaction_core::model::RigidModel;

pub(crate) const FAMILY: &CStr = c"rigid";

/// Nothing beside the file.
pub(crate) struct Lists;

impl Lists {
    pub fn empty() -> Self {
        Self
    }
}

/// A rigid mechanism.
pub(crate) type Mechanism = RigidModel<'static, N, H, L, Weight, Laws>;

type Parts<'a> = System<&'a Rigid<'static, Weight, N, H, L>, &'a Laws>;

/// # Safety
/// None: a rigid model has no name to read.
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
