use super::{Laws, Weight};
use crate::config::LEASTACTION_COORDINATES as N;
use crate::error::Error;
use core::ffi::{CStr, c_char};
use leastaction_core::energy::bodies::PlanarBodies;
use leastaction_core::forces::System;
use leastaction_core::model::BodiesModel;

pub(crate) const FAMILY: &CStr = c"bodies";

/// No lists beside the file.
pub(crate) struct Lists;

impl Lists {
    pub fn empty() -> Self {
        Self
    }
}

/// A tree of rigid bodies.
pub(crate) type Mechanism = BodiesModel<'static, N, Weight, Laws>;

type Parts<'a> = System<&'a PlanarBodies<'static, Weight, N>, &'a Laws>;

/// # Safety
/// None: bodies have no name to read.
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
