//! Time of a step as a function of the size of a system.

use super::{LearnedGraph, LgnnSettings, LgnnSystem};
use crate::task::TaskError;
use leastaction_core::constraints::Constrained;
use leastaction_core::discrete::{
    Order,
    rattle::{ParticleState, Rattle},
};
use leastaction_core::energy::graph::Graph;
use leastaction_ground_truth::lgnn_starts;
use leastaction_models::HostTypes;
use std::time::Instant;

/// Numbers of springs for which the time of a step is measured.
pub const LINEAR_SIZES: [usize; 4] = [5, 50, 500, 5_000];
/// Step size of springs in the authors' program, s.
const STEP: f64 = 1e-3;
/// Number of steps, summed over nodes, in a measured stretch.
const STRETCH: usize = 50_000;
/// Number of stretches. The fastest one counts, since the others were disturbed by other programs.
const STRETCHES: usize = 7;

/// Time of one variational step of order 2 for a ring of springs, on one core in f64, µs.
pub fn step_microseconds(model: &LearnedGraph) -> Result<f64, TaskError> {
    let graph = model.architecture.graph()?;
    let nodes = graph.nodes.len();
    let settings = LgnnSettings { trajectories: 1, ..LgnnSettings::published(LgnnSystem::Spring(nodes), 0) };
    let starts = lgnn_starts(&settings);
    let (q, v) = starts.first().map_or((&[][..], &[][..]), |s| (s.q.as_chunks().0, s.v.as_chunks().0));
    let types: HostTypes<'_, f64, 2> = model.architecture.host_types(&model.weights)?;
    let particles = Graph::new(types, &graph.nodes, &graph.edges)?;
    let rods = graph.constraints();
    let mechanism = Constrained::new(&particles, rods.as_slice())?;
    let (integrator, equations) = (Rattle::new(STEP, Order::Two), mechanism.equations());
    let mut workspace = vec![0.0; Rattle::workspace(&mechanism)];
    let mut storage = vec![0.0; ParticleState::<f64, 2>::workspace(nodes, equations)];
    let mut state = ParticleState::new(&mechanism, q, v, &mut storage, &mut workspace)?;
    let steps = (STRETCH / nodes).max(1);
    let mut fastest = f64::INFINITY;
    for _ in 0..STRETCHES {
        let clock = Instant::now();
        for _ in 0..steps {
            integrator.step(&mechanism, &mut state, None, &mut workspace)?;
        }
        fastest = fastest.min(clock.elapsed().as_secs_f64() / steps as f64);
    }
    Ok(1e6 * fastest)
}
