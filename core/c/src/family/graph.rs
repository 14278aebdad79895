use super::Weight;
use crate::config::{
    LEASTACTION_COORDINATES as N, LEASTACTION_DIMENSIONS as D, LEASTACTION_EDGES, LEASTACTION_HIDDEN as H,
    LEASTACTION_LAYERS as L, LEASTACTION_NETWORKS as K,
};
use crate::error::Error;
use crate::status::Status;
use core::ffi::{CStr, c_char};
use leastaction_core::energy::graph::{Edge, Fixed, GraphError};
use leastaction_core::forces::System;
use leastaction_core::model::{GraphModel, Model, ModelError};

pub(crate) const FAMILY: &CStr = c"graph";
pub(crate) const EDGES: usize = LEASTACTION_EDGES;

/// Particles, coordinates node after node.
pub(crate) type Mechanism = Model<'static, Particles>;

/// A Lagrangian that is its own drag.
type Particles = Fixed<'static, Weight, D, K, H, L, N>;

/// # Safety
/// `name` is NULL, or bytes up to a zero.
pub(crate) unsafe fn load(
    bytes: &'static [u8],
    name: *const c_char,
    edges: &'static mut [Edge],
) -> Result<Mechanism, Error> {
    // SAFETY: this function's promise.
    let name = unsafe { super::text(name) }?;
    // Particles that nothing holds together would be another mechanism than the one that was learned.
    let model = GraphModel::<D, K, H, L, Weight>::load(bytes, name, edges, &mut []).map_err(without_rods)?;
    model.try_map(|system| Ok(Fixed::new(system.graph)?))
}

/// There is no place for rods at all here.
fn without_rods(error: ModelError) -> Error {
    match error {
        ModelError::Graph(GraphError::TooManyRods { needed, .. }) => Error::new(Status::Rods, [needed]),
        error => error.into(),
    }
}

pub(crate) fn system(mechanism: &Mechanism) -> System<&Particles, &Particles> {
    System { lagrangian: &mechanism.system, forces: &mechanism.system }
}
