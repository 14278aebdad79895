//! Accelerations of a model as a plain function on slices, for a model of any family and size.

use crate::parallel::Pool;
use crate::particles::Driven;
use crate::{GraphArchitecture, HostTypes, Model};
use leastaction_core::energy::graph::Graph;
use leastaction_core::model::ModelError;
use leastaction_programs::Row;
use leastaction_programs::dynamics;

/// Writes v̇(q, v) of free motion, m/s² or rad/s²; `None` if it does not exist or a slice is too short.
pub type Accelerations<'w> = dyn Fn(&[f64], &[f64], &mut [f64]) -> Option<()> + Sync + 'w;
/// Writes v̇(q, v, τ) under a force τ on every coordinate, N or N m (no force if τ is empty); `None` as for [`Accelerations`].
pub type Forced<'w> = dyn Fn(&[f64], &[f64], &[f64], &mut [f64]) -> Option<()> + Sync + 'w;

impl Model {
    /// Calls `then` with the accelerations of free motion; the shape is read once.
    ///
    /// # Errors
    /// An error if the shape is inconsistent or the weights do not fit it.
    pub fn with_accelerations<T>(&self, then: impl FnOnce(&Accelerations) -> T) -> Result<T, ModelError> {
        self.with_forced(|forced| then(&|q, v, out| forced(q, v, &[], out)))
    }

    /// Calls `then` with the accelerations under forces, with the rods of the graph as constraints; the shape is read once.
    ///
    /// # Errors
    /// An error if the shape is inconsistent or the weights do not fit it.
    pub fn with_forced<T>(&self, then: impl FnOnce(&Forced) -> T) -> Result<T, ModelError> {
        match self.architecture.family.graph() {
            Some(graph) => with_forced_graph(graph, &self.weights, then),
            None => {
                let free = FreeAccelerations::new(self)?;
                Ok(then(&|q, v, tau, out| free.write([q, v, tau], out)))
            }
        }
    }
}

/// Accelerations of a system without constraints, callable from any thread.
struct FreeAccelerations<'m> {
    model: &'m Model,
    n: usize,
    pool: Pool<dynamics::Accelerations>,
}

impl<'m> FreeAccelerations<'m> {
    fn new(model: &'m Model) -> Result<Self, ModelError> {
        let system = model.system()?;
        Ok(Self { model, n: system.n(), pool: Pool::new(move || dynamics::Accelerations::new(&system)) })
    }

    fn write(&self, [q, v, tau]: [&[f64]; 3], out: &mut [f64]) -> Option<()> {
        let n = self.n;
        let fits = q.len() >= n && v.len() >= n && (tau.is_empty() || tau.len() >= n) && out.len() >= n;
        fits.then_some(())?;
        let rows = |x: &[f64]| -> Vec<Row> {
            (0..n).map(|i| Row::splat(x.get(i).copied().unwrap_or(0.0))).collect()
        };
        let (q, v, tau) = (rows(q), rows(v), rows(tau));
        let mut a = vec![Row::default(); n];
        let weights = &self.model.weights;
        let failures = self.pool.with(|own| own.evaluate(weights, [&q, &v, &tau], &mut a, None));
        out.iter_mut().zip(&a).for_each(|(out, a)| *out = a.0[0]);
        (!failures.any(1)).then_some(())
    }
}

/// Calls `then` with the accelerations of a graph of any size, with its rods as constraints.
fn with_forced_graph<T>(
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
    Ok(then(&|q, v, tau, out| driven.acceleration(q, v, tau, out)))
}
