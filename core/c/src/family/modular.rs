use super::Weight;
use crate::config::{
    LEASTACTION_COORDINATES as N, LEASTACTION_HIDDEN as H, LEASTACTION_LAYERS as D, LEASTACTION_TYPES as K,
};
use crate::error::Error;
use core::ffi::{CStr, c_char};
use leastaction_core::energy::graph::Edge;
use leastaction_core::energy::modular::Modular;
use leastaction_core::forces::{System, Viscous};
use leastaction_core::model::{ModularModel, TrainedStep};

pub(crate) const FAMILY: &CStr = c"modular";
pub(crate) const EDGES: usize = 0;

/// A tree of elements.
pub(crate) struct Mechanism(ModularModel<'static, N, K, H, D, Weight>);

type Parts<'a> = System<&'a Modular<'static, Weight, N, K, H, D>, &'a Viscous<f32, N>>;

impl Mechanism {
    /// # Safety
    /// `name` is NULL, or bytes up to a zero.
    pub unsafe fn load(
        bytes: &'static [u8],
        name: *const c_char,
        _: &'static mut [Edge],
    ) -> Result<Self, Error> {
        // SAFETY: this function's promise.
        let name = unsafe { super::text(name) }?;
        #[cfg(feature = "half")]
        let model = ModularModel::load_half(bytes, name)?;
        #[cfg(not(feature = "half"))]
        let model = ModularModel::load(bytes, name)?;
        Ok(Self(model))
    }

    pub fn system(&self) -> Parts<'_> {
        System { lagrangian: &self.0.system.lagrangian, forces: &self.0.system.forces }
    }

    pub fn trained_step(&self) -> Option<TrainedStep> {
        self.0.trained_step
    }
}
