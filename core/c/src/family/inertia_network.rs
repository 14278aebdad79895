use super::{Laws, Weight};
use crate::config::{LEASTACTION_COORDINATES as N, LEASTACTION_HIDDEN as H, LEASTACTION_LAYERS as L};
use crate::error::Error;
use core::ffi::{CStr, c_char};
use leastaction_core::energy::inertia_network::InertiaNetwork;
use leastaction_core::forces::System;
use leastaction_core::model::InertiaNetworkModel;

pub(crate) const FAMILY: &CStr = c"inertia-network";

/// No lists beside the file.
pub(crate) struct Lists;

impl Lists {
    pub fn empty() -> Self {
        Self
    }
}

/// An inertia network.
pub(crate) type Mechanism = InertiaNetworkModel<'static, N, H, L, Weight, Laws>;

type Parts<'a> = System<&'a InertiaNetwork<'static, Weight, N, H, L>, &'a Laws>;

/// # Safety
/// None: an inertia network has no name to read.
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
