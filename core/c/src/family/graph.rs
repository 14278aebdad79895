use super::Weight;
use crate::config::{
    LEASTACTION_COORDINATES as N, LEASTACTION_DIMENSIONS as D, LEASTACTION_EDGES, LEASTACTION_HIDDEN as H,
    LEASTACTION_LAYERS as L, LEASTACTION_NETWORKS as K, LEASTACTION_RODS as RODS,
};
use crate::error::Error;
use crate::status::Status;
use core::ffi::{CStr, c_char};
use leastaction_core::constraints::Holonomic;
use leastaction_core::energy::graph::{Edge, Fixed, GraphError};
use leastaction_core::model::{GraphModel, ModelError};

#[cfg(not(feature = "rods"))]
pub(crate) use alone::{Mechanism, system};
#[cfg(feature = "rods")]
pub(crate) use on_rods::{AnyGraph, Mechanism, constrained};

pub(crate) const FAMILY: &CStr = c"graph";

/// Lists that a graph refers to.
pub(crate) struct Lists {
    edges: [Edge; LEASTACTION_EDGES],
    rods: [Holonomic<f32, D>; RODS],
}

impl Lists {
    pub fn empty() -> Self {
        Self { edges: [Edge::default(); LEASTACTION_EDGES], rods: [Holonomic::default(); RODS] }
    }
}

/// A graph with a compiled number of coordinates.
type Particles = Fixed<'static, Weight, D, K, H, L, N>;

/// # Safety
/// `name` is NULL, or bytes up to a zero.
pub(crate) unsafe fn load(
    bytes: &'static [u8],
    name: *const c_char,
    Lists { edges, rods }: &'static mut Lists,
) -> Result<Mechanism, Error> {
    // SAFETY: this function's promise.
    let name = unsafe { super::text(name) }?;
    let model = GraphModel::<D, K, H, L, Weight>::load(bytes, name, edges, rods).map_err(refused)?;
    model.try_map(|system| {
        let particles = Particles::new(system.graph)?;
        #[cfg(feature = "rods")]
        let particles = leastaction_core::model::GraphSystem { graph: *particles.graph(), ..system };
        Ok(particles)
    })
}

/// Refuses a graph with rods if the library was built without them: without its rods, the graph would be another
/// mechanism than the learned one.
fn refused(error: ModelError) -> Error {
    match error {
        ModelError::Graph(GraphError::TooManyRods { needed, .. }) if RODS == 0 => {
            Error::new(Status::Rods, [needed])
        }
        error => error.into(),
    }
}

/// Graphs without rods.
#[cfg(not(feature = "rods"))]
mod alone {
    use super::Particles;
    use leastaction_core::forces::System;
    use leastaction_core::model::Model;

    /// Particles; the coordinates are listed node by node.
    pub(crate) type Mechanism = Model<'static, Particles>;

    /// Returns the graph as a Lagrangian that is its own drag.
    pub(crate) fn system(mechanism: &Mechanism) -> System<&Particles, &Particles> {
        System { lagrangian: &mechanism.system, forces: &mechanism.system }
    }
}

/// Graphs with rods.
#[cfg(feature = "rods")]
mod on_rods {
    use super::{D, H, Holonomic, K, L, Weight};
    use crate::error::Error;
    use leastaction_core::constraints::Constrained;
    use leastaction_core::energy::graph::Graph;
    use leastaction_core::model::GraphModel;

    /// Particles with their rods; the coordinates are listed node by node.
    pub(crate) type Mechanism = GraphModel<'static, D, K, H, L, Weight>;

    /// A graph in any number of coordinates.
    pub(crate) type AnyGraph = Graph<'static, Weight, D, K, H, L>;

    /// The mechanism that RATTLE steps.
    pub(crate) fn constrained(
        mechanism: &Mechanism,
    ) -> Result<Constrained<'_, f32, AnyGraph, [Holonomic<f32, D>], D>, Error> {
        Ok(mechanism.system.constrained()?)
    }
}
