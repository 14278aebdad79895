//! Learned terms of a model, beside the true ones.

use super::LearnedGraph;
use crate::task::TaskError;
use leastaction_core::energy::graph::{Edge, Graph};
use leastaction_core::particles::Particles;
use leastaction_ground_truth::Truss;
use leastaction_learning::training::Samples;
use leastaction_models::HostTypes;
use leastaction_models::particles::Driven;

/// Number of points of a curve.
const POINTS: usize = 200;

/// Rows (abscissa, learned, exact) of a function of one quantity.
pub type Compared = Vec<[f64; 3]>;

/// Learned terms of a model's networks and laws.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Insight {
    /// Potential energy of a spring, J, over its length, m, in the range of the data; 0 at 1 m.
    pub spring: Compared,
    /// Drag, N, over velocity, m/s, in the range of the data.
    pub drag: Compared,
    /// Pull of every rod, N, over time, s, along one exact motion.
    pub rods: Vec<Compared>,
}

impl Insight {
    /// Computes the springs and the drag of a model trained on samples; rods need a motion ([`pulls`]).
    pub(super) fn new(model: &LearnedGraph, drag: f64, samples: &Samples) -> Result<Self, TaskError> {
        Ok(Self { spring: spring(model, samples)?, drag: dragged(model, drag, samples)?, rods: Vec::new() })
    }
}

/// Largest distance between the ends of the model's edges.
fn longest(model: &LearnedGraph, samples: &Samples) -> Result<f64, TaskError> {
    let edges = &model.architecture.graph()?.edges;
    let length = |q: &[[f64; 2]], edge: &Edge| {
        let [a, b] = edge.ends.map(|end| q[usize::from(end)]);
        (a[0] - b[0]).hypot(a[1] - b[1])
    };
    let states = samples.states[0].chunks_exact(samples.n);
    let of_state = |q: &[f64]| edges.iter().map(|edge| length(q.as_chunks().0, edge)).fold(0.0, f64::max);
    Ok(states.map(of_state).fold(0.0, f64::max))
}

fn spring(model: &LearnedGraph, samples: &Samples) -> Result<Compared, TaskError> {
    if model.architecture.graph()?.edges.is_empty() {
        return Ok(Compared::default());
    }
    let types: HostTypes<'_, f64, 2> = model.architecture.host_types(&model.weights)?;
    let edges = [Edge { kind: 0, ends: [0, 1] }];
    let pair = Graph::new(types, &[0, 0], &edges)?;
    let mut workspace = vec![0.0; Particles::<f64, 2>::workspace(&pair)];
    let mut learned = |r: f64| pair.energies(&[[0.0; 2], [r, 0.0]], &[[0.0; 2]; 2], &mut workspace).potential;
    let (zero, longest) = (learned(1.0), longest(model, samples)?);
    let row = |k: usize| {
        let r = longest * (k + 1) as f64 / POINTS as f64;
        [r, learned(r) - zero, (r * r - 1.0).powi(2)]
    };
    Ok((0..POINTS).map(row).collect())
}

fn dragged(model: &LearnedGraph, drag: f64, samples: &Samples) -> Result<Compared, TaskError> {
    if drag == 0.0 {
        return Ok(Compared::default());
    }
    let types: HostTypes<'_, f64, 2> = model.architecture.host_types(&model.weights)?;
    let node = Graph::new(types, &[0], &[])?;
    let fastest = samples.states[1].iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    let row = |k: usize| {
        let v = fastest * (2.0 * k as f64 / (POINTS - 1) as f64 - 1.0);
        let [learned, _] = Particles::<f64, 2>::drag(&node, 0, &[v, 0.0]);
        [v, learned, -drag * v]
    };
    Ok((0..POINTS).map(row).collect())
}

/// Pull of every rod along an exact motion under a force u, with states (q, v) `h` seconds apart.
pub(super) fn pulls<P: Particles<f64, 2>>(
    driven: &Driven<'_, P, 2>,
    u: &[f64],
    truss: &Truss,
    states: &[f64],
    h: f64,
) -> Vec<Compared> {
    if truss.rods.is_empty() {
        return Vec::new();
    }
    let n = 2 * truss.masses.len();
    let at = |(k, state): (usize, &[f64])| {
        let (q, v) = state.split_at(n);
        Some((k as f64 * h, driven.multipliers(q, v, u)?, truss.tensions(q, v)?))
    };
    let all: Vec<_> = states.chunks_exact(2 * n).enumerate().filter_map(at).collect();
    let rod = |i: usize| all.iter().map(|(t, lambda, exact)| [*t, -lambda[i], exact[i]]).collect();
    (0..truss.rods.len()).map(rod).collect()
}
