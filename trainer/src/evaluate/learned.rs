//! A learned model as plain functions on slices, whatever its family and size.

use super::particles::Driven;
use crate::architecture::{Architecture, Family, GraphArchitecture, HostTypes, Visitor};
use leastaction_core::continuous::{acceleration, energy};
use leastaction_core::energy::graph::Graph;
use leastaction_core::lagrangian::Energies;
use leastaction_core::model::ModelError;
use leastaction_core::particles::Particles;

/// Writes v̇(q, v), m/s² or rad/s², of a free motion; `None` where it does not exist or a slice is too short.
pub type Acceleration<'w> = Box<dyn Fn(&[f64], &[f64], &mut [f64]) -> Option<()> + Sync + 'w>;
/// The energy T + V, J; not a number where a slice is too short.
pub type Energy<'w> = Box<dyn Fn(&[f64], &[f64]) -> f64 + Sync + 'w>;

/// The accelerations that a model gives, and its own energy.
///
/// # Errors
/// Where the shape is beyond what is compiled.
pub fn functions<'w>(
    architecture: &Architecture,
    weights: &'w [f64],
) -> Result<(Acceleration<'w>, Energy<'w>), ModelError> {
    match architecture {
        Architecture::Graph(graph) if graph.dimension() == 3 => graph_functions::<3>(graph, weights),
        Architecture::Graph(graph) => graph_functions::<2>(graph, weights),
        Architecture::Rigid(_) | Architecture::Modular(_) => architecture.dispatch(Functions { weights })?,
    }
}

/// Writes v̇(q, v, u) of particles under a force u, N on every coordinate, or none where it is empty; `None` as for
/// [`Acceleration`].
pub(super) type Forced<'w> = Box<dyn Fn(&[f64], &[f64], &[f64], &mut [f64]) -> Option<()> + Sync + 'w>;

/// The accelerations of a graph of any size, on its rods.
pub(super) fn forced<'w>(
    architecture: &GraphArchitecture,
    weights: &'w [f64],
) -> Result<Forced<'w>, ModelError> {
    match architecture.dimension() {
        3 => forced_in::<3>(architecture, weights),
        _ => forced_in::<2>(architecture, weights),
    }
}

fn forced_in<'w, const D: usize>(
    architecture: &GraphArchitecture,
    weights: &'w [f64],
) -> Result<Forced<'w>, ModelError> {
    let types: HostTypes<'_, f64, D> = architecture.host_types(weights)?;
    let graph = architecture.graph()?.clone();
    Graph::new(types, &graph.nodes, &graph.edges).map_err(ModelError::Graph)?;
    let rods = graph.constraints::<D>();
    Ok(Box::new(move |q, v, u, out| {
        let particles = Graph::new(types, &graph.nodes, &graph.edges).ok()?;
        Driven::new(&particles, &rods, u.as_chunks().0).ok()?.acceleration(q, v, out)
    }))
}

/// Those of a graph of any size.
fn graph_functions<'w, const D: usize>(
    architecture: &GraphArchitecture,
    weights: &'w [f64],
) -> Result<(Acceleration<'w>, Energy<'w>), ModelError> {
    let types: HostTypes<'_, f64, D> = architecture.host_types(weights)?;
    let graph = architecture.graph()?.clone();
    let forced = forced_in::<D>(architecture, weights)?;
    let accelerations = move |q: &[f64], v: &[f64], out: &mut [f64]| forced(q, v, &[], out);
    let energies = move |q: &[f64], v: &[f64]| {
        let Ok(particles) = Graph::new(types, &graph.nodes, &graph.edges) else { return f64::NAN };
        let mut room = vec![0.0; Particles::<f64, D>::room(&particles)];
        let Energies { kinetic, potential } = particles.energies(q.as_chunks().0, v.as_chunks().0, &mut room);
        kinetic + potential
    };
    Ok((Box::new(accelerations), Box::new(energies)))
}

struct Functions<'w> {
    weights: &'w [f64],
}

impl<'w> Visitor for Functions<'w> {
    type Output = Result<(Acceleration<'w>, Energy<'w>), ModelError>;

    fn visit<F: Family<N> + Clone + 'static, const N: usize>(self, family: &F) -> Self::Output {
        let (weights, family, same) = (self.weights, family.clone(), family.clone());
        family.system::<f64>(weights)?;
        let accelerations = move |q: &[f64], v: &[f64], out: &mut [f64]| {
            let (q, v) = (q.first_chunk::<N>()?, v.first_chunk::<N>()?);
            let system = family.system::<f64>(weights).ok()?;
            *out.first_chunk_mut::<N>()? = acceleration(&system, q, v, &[0.0; N]).ok()?;
            Some(())
        };
        let energies = move |q: &[f64], v: &[f64]| match (q.first_chunk(), v.first_chunk()) {
            (Some(q), Some(v)) => {
                same.system::<f64>(weights).map_or(f64::NAN, |system| energy(&system.lagrangian, q, v))
            }
            _ => f64::NAN,
        };
        Ok((Box::new(accelerations), Box::new(energies)))
    }
}
