use super::{Laws, Weight};
use crate::config::{
    LEASTACTION_COORDINATES as N, LEASTACTION_HIDDEN as H, LEASTACTION_LAYERS as L, LEASTACTION_TYPES as E,
};
use crate::error::Error;
use core::ffi::{CStr, c_char};
use leastaction_core::energy::modular::Modular;
use leastaction_core::forces::System;
use leastaction_core::model::ModularModel;

pub(crate) const FAMILY: &CStr = c"modular";

/// No lists beside the file.
pub(crate) struct Lists;

impl Lists {
    pub fn empty() -> Self {
        Self
    }
}

/// A tree of elements.
pub(crate) type Mechanism = ModularModel<'static, N, E, H, L, Weight, Laws>;

type Parts<'a> = System<&'a Modular<'static, Weight, N, E, H, L>, &'a Laws>;

/// # Safety
/// `name` is NULL, or bytes up to a zero.
pub(crate) unsafe fn load(
    bytes: &'static [u8],
    name: *const c_char,
    _: &'static mut Lists,
) -> Result<Mechanism, Error> {
    // SAFETY: this function's promise.
    let name = unsafe { super::text(name) }?;
    Ok(Mechanism::load(bytes, name)?)
}

pub(crate) fn system(mechanism: &Mechanism) -> Parts<'_> {
    System { lagrangian: &mechanism.system.lagrangian, forces: &mechanism.system.forces }
}
