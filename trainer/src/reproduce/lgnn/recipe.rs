//! What is learned, and how.

use crate::architecture::{GraphArchitecture, NamedGraph, NamedNodes, Number};
use crate::baselines::AccelerationModel;
use crate::ground_truth::LgnnSystem;
use crate::training::{Levenberg, Samples};
use leastaction_core::energy::NetworkShape;
use leastaction_core::energy::graph::{
    Drag, Edge, EdgeShape, Kinetic, NodeShape, Potential, Separation, Shape,
};
use leastaction_core::model::{ModelError, Rod};
use leastaction_core::network::Activation;

/// Hidden units of every potential, beside a uniform field. Squareplus is nearly linear far out, and so is what is learned beyond
/// the data.
const POTENTIAL: [u16; 4] = [8, 0, 0, 0];
/// Hidden units of a spring's potential.
const SPRING: [u16; 4] = [16, 0, 0, 0];
/// Hidden units of the drag.
const DRAG: [u16; 4] = [5, 0, 0, 0];
/// Of 4 samples 3 are learned from, and one judges.
const JUDGES: usize = 4;

/// A trained model.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Its shape.
    pub architecture: GraphArchitecture,
    /// Its weight block.
    pub weights: Vec<f64>,
}

impl Model {
    /// The same nodes and edges in another graph.
    #[must_use]
    pub fn on(&self, system: LgnnSystem) -> Self {
        Self { architecture: self.architecture.with_graph(graph(system)), weights: self.weights.clone() }
    }
}

/// The shape for a system: bobs with a potential of their place, or nodes joined by springs with a potential of their squared
/// distance; all of the known mass of 1 kg, which fixes the scale of L; with drag, one of each component of the velocity.
pub fn architecture(system: LgnnSystem, drag: bool) -> GraphArchitecture {
    let network =
        |inputs, widths| NetworkShape { inputs, widths, outputs: 1, activation: Activation::Squareplus };
    let springs = matches!(system, LgnnSystem::Spring(_));
    let mut networks = vec![if springs { network(1, SPRING) } else { network(2, POTENTIAL) }];
    let drag = if drag {
        networks.push(network(1, DRAG));
        Drag::Network(1)
    } else {
        Drag::None
    };
    let potential = if springs { Potential::None } else { Potential::Network(0) };
    let node = NodeShape { kinetic: Kinetic::Mass, potential, drag };
    let spring = EdgeShape { separation: Separation::Squared, potential: Some(0), embedding: None };
    let edges: &[EdgeShape] = if springs { &[spring] } else { &[] };
    let mut shape = Shape { networks: Default::default(), ..empty() };
    for (slot, network) in shape.networks.iter_mut().zip(networks) {
        *slot = Some(network);
    }
    shape.nodes[0] = Some(node);
    for (slot, edge) in shape.edges.iter_mut().zip(edges) {
        *slot = Some(*edge);
    }
    let field = if springs { Number::known(0.0) } else { Number::learned(0.0) };
    let numbers = vec![Number::known(1.0), Number::known(0.0), field, field];
    let types = vec![NamedNodes { name: if springs { "node" } else { "bob" }.to_owned(), numbers }];
    let edge_types = edges.iter().map(|_| "spring".to_owned()).collect();
    GraphArchitecture { shape, types, edge_types, graphs: vec![graph(system)], graph: 0 }
}

/// In the plane, without anything.
fn empty() -> Shape {
    Shape {
        dimension: 2,
        kinetic_embedding: 0,
        embedding: 0,
        networks: Default::default(),
        nodes: Default::default(),
        edges: Default::default(),
        messages: None,
    }
}

/// The graph of a system whose nodes and springs are all of the first type.
pub fn graph(system: LgnnSystem) -> NamedGraph {
    let number = |node: usize| node as u16;
    let rod = |rod: crate::ground_truth::Rod| Rod {
        from: rod.from.map(number),
        to: number(rod.to),
        length: rod.length as f32,
    };
    NamedGraph {
        name: system.name().to_owned(),
        nodes: vec![0; system.nodes()],
        edges: system.springs().into_iter().map(|ends| Edge { kind: 0, ends: ends.map(number) }).collect(),
        rods: system.rods().into_iter().map(rod).collect(),
    }
}

/// Learns from accelerations by Levenberg–Marquardt on three quarters of the samples, and keeps the iteration that is best on the
/// fourth; `watch` is called with the iteration and the loss. Also the mean squared errors on both.
///
/// # Errors
/// Where the shape is beyond what is compiled.
pub fn train(
    architecture: GraphArchitecture,
    samples: &Samples,
    iterations: usize,
    seed: u64,
    mut watch: impl FnMut(usize, f64),
) -> Result<(Model, [f64; 2]), ModelError> {
    let [rows, judges] = samples.shuffled(seed).split(samples.len() / JUDGES);
    let (objective, judge) = (architecture.objective(rows)?, architecture.objective(judges)?);
    let start = Levenberg::new(&*objective, architecture.initial_weights(seed));
    let weights =
        start.best(&*objective, &*judge, iterations, |iteration, state| watch(iteration, state.loss));
    let errors = [objective.loss(&weights), judge.loss(&weights)];
    Ok((Model { architecture, weights }, errors))
}
