use super::no_lists::Lists;
use super::{Laws, Weight};
use crate::config::{
    LEASTACTION_COORDINATES as N, LEASTACTION_HIDDEN as H, LEASTACTION_LAYERS as L, LEASTACTION_TYPES as E,
};
use crate::error::Error;
use core::ffi::{CStr, c_char};
use leastaction_core::energy::modular::Modular;
use leastaction_core::model::ModularModel;

pub(crate) const FAMILY: &CStr = c"modular";

/// A tree of elements.
pub(crate) type Mechanism = ModularModel<'static, N, E, H, L, Weight, Laws>;

/// Kinetic and potential energy of the mechanism.
pub(crate) type Energy = Modular<'static, Weight, N, E, H, L>;

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
