use super::Weight;
use crate::config::{
    LEASTACTION_COORDINATES as N, LEASTACTION_DIMENSIONS as D, LEASTACTION_EDGES, LEASTACTION_HIDDEN as H,
    LEASTACTION_LAYERS as L, LEASTACTION_NETWORKS as K,
};
use crate::error::Error;
use crate::status::Status;
use core::ffi::{CStr, c_char};
use leastaction_core::energy::graph::{Edge, Fixed};
use leastaction_core::forces::System;
use leastaction_core::model::{GraphHeader, TrainedStep, parse_as};

pub(crate) const FAMILY: &CStr = c"graph";
pub(crate) const EDGES: usize = LEASTACTION_EDGES;

/// Particles, coordinates node after node.
pub(crate) struct Mechanism {
    particles: Particles,
    trained_step: Option<TrainedStep>,
}

/// A Lagrangian that is its own drag.
type Particles = Fixed<'static, Weight, D, K, H, L, N>;

impl Mechanism {
    /// # Safety
    /// `name` is NULL, or bytes up to a zero.
    pub unsafe fn load(
        bytes: &'static [u8],
        name: *const c_char,
        edges: &'static mut [Edge],
    ) -> Result<Self, Error> {
        // SAFETY: this function's promise.
        let name = unsafe { super::text(name) }?;
        let parsed = parse_as::<GraphHeader, Weight>(bytes)?;
        let header = parsed.shape;
        let layout = header.layout(name)?;
        // Particles that nothing holds together would be another mechanism than the one that was learned.
        if layout.rods().next().is_some() {
            return Err(Error::new(Status::Rods, [layout.rods().count()]));
        }
        let particles = Fixed::new(header.graph(layout, parsed.weights, edges)?)?;
        Ok(Self { particles, trained_step: parsed.trained_step })
    }

    pub fn system(&self) -> System<&Particles, &Particles> {
        System { lagrangian: &self.particles, forces: &self.particles }
    }

    pub fn trained_step(&self) -> Option<TrainedStep> {
        self.trained_step
    }
}
