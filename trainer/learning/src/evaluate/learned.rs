//! A learned model as a plain function on slices, whatever its family and size.

use super::FreeAccelerations;
use super::particles::Driven;
use crate::architecture::{Architecture, Family, GraphArchitecture, HostTypes};
use leastaction_core::energy::graph::Graph;
use leastaction_core::model::ModelError;

/// Writes v̇(q, v), m/s² or rad/s², of a free motion; `None` where it does not exist or a slice is too short.
pub type Accelerations<'w> = dyn Fn(&[f64], &[f64], &mut [f64]) -> Option<()> + Sync + 'w;
/// Writes v̇(q, v, u) under a force u on every coordinate, N or N m, or none where it is empty; `None` as for [`Accelerations`].
pub type Forced<'w> = dyn Fn(&[f64], &[f64], &[f64], &mut [f64]) -> Option<()> + Sync + 'w;

/// Calls `then` with the accelerations that a model gives; its shape is read once.
///
/// # Errors
/// Where the shape does not fit in itself, or the weights to the shape.
pub fn with_accelerations<T>(
    architecture: &Architecture,
    weights: &[f64],
    then: impl FnOnce(&Accelerations) -> T,
) -> Result<T, ModelError> {
    with_forced(architecture, weights, |forced| then(&|q, v, out| forced(q, v, &[], out)))
}

/// Calls `then` with the accelerations that a model gives under forces; its shape is read once.
///
/// # Errors
/// Where the shape does not fit in itself, or the weights to the shape.
pub fn with_forced<T>(
    architecture: &Architecture,
    weights: &[f64],
    then: impl FnOnce(&Forced) -> T,
) -> Result<T, ModelError> {
    match &architecture.family {
        Family::Graph(graph) => with_forced_graph(graph, weights, then),
        Family::Rigid(_) | Family::Modular(_) | Family::Bodies(_) | Family::Arm(_) => {
            let free = FreeAccelerations::new(architecture, weights)?;
            Ok(then(&|q, v, u, out| free.write(q, v, u, out)))
        }
    }
}

/// Calls `then` with the accelerations of a graph of any size, on its rods.
pub(super) fn with_forced_graph<T>(
    architecture: &GraphArchitecture,
    weights: &[f64],
    then: impl FnOnce(&Forced) -> T,
) -> Result<T, ModelError> {
    match architecture.dimension() {
        3 => forced_in::<3, T>(architecture, weights, then),
        _ => forced_in::<2, T>(architecture, weights, then),
    }
}

fn forced_in<const D: usize, T>(
    architecture: &GraphArchitecture,
    weights: &[f64],
    then: impl FnOnce(&Forced) -> T,
) -> Result<T, ModelError> {
    let types: HostTypes<'_, f64, D> = architecture.host_types(weights)?;
    let graph = architecture.graph()?;
    let particles = Graph::new(types, &graph.nodes, &graph.edges).map_err(ModelError::Graph)?;
    let rods = graph.constraints::<D>();
    let driven = Driven::new(&particles, &rods).map_err(|_| ModelError::OutOfRange { what: "rod" })?;
    Ok(then(&|q, v, u, out| driven.acceleration(q, v, u, out)))
}
