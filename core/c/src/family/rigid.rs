use super::Weight;
use crate::config::{LEASTACTION_COORDINATES as N, LEASTACTION_HIDDEN as H, LEASTACTION_LAYERS as D};
use crate::error::Error;
use core::ffi::{CStr, c_char};
use leastaction_core::energy::graph::Edge;
use leastaction_core::energy::rigid::Rigid;
use leastaction_core::forces::{System, Viscous};
use leastaction_core::model::{RigidModel, TrainedStep};

pub(crate) const FAMILY: &CStr = c"rigid";
pub(crate) const EDGES: usize = 0;

/// A rigid mechanism.
pub(crate) struct Mechanism(RigidModel<'static, N, H, D, Weight>);

type Parts<'a> = System<&'a Rigid<'static, Weight, N, H, D>, &'a Viscous<f32, N>>;

impl Mechanism {
    /// # Safety
    /// None: a rigid model has no name to read.
    pub unsafe fn load(
        bytes: &'static [u8],
        _: *const c_char,
        _: &'static mut [Edge],
    ) -> Result<Self, Error> {
        #[cfg(feature = "half")]
        let model = RigidModel::load_half(bytes)?;
        #[cfg(not(feature = "half"))]
        let model = RigidModel::load(bytes)?;
        Ok(Self(model))
    }

    pub fn system(&self) -> Parts<'_> {
        System { lagrangian: &self.0.system.lagrangian, forces: &self.0.system.forces }
    }

    pub fn trained_step(&self) -> Option<TrainedStep> {
        self.0.trained_step
    }
}
