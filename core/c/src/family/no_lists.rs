//! Families that need no lists beside the file.

use super::{Energy, Laws, Mechanism};
#[cfg(not(feature = "modular"))]
use crate::error::Error;
#[cfg(not(feature = "modular"))]
use core::ffi::c_char;
use leastaction_core::forces::System;

/// No lists beside the file.
pub(crate) struct Lists;

impl Lists {
    pub fn empty() -> Self {
        Self
    }
}

/// Loads a file, which holds a single mechanism.
///
/// # Safety
/// None: the mechanism has no name to read.
#[cfg(not(feature = "modular"))]
pub(crate) unsafe fn load(
    bytes: &'static [u8],
    _: *const c_char,
    _: &'static mut Lists,
) -> Result<Mechanism, Error> {
    Ok(Mechanism::load(bytes)?)
}

pub(crate) fn system(mechanism: &Mechanism) -> System<&Energy, &Laws> {
    System { lagrangian: &mechanism.system.lagrangian, forces: &mechanism.system.forces }
}
