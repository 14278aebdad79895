//! What is learned, and how.

use crate::architecture::{GraphArchitecture, GraphType, NamedGraph, Number};
use crate::baselines::AccelerationModel;
use crate::ground_truth::LgnnSystem;
use crate::training::{Levenberg, Samples};
use leastaction_core::energy::NetworkShape;
use leastaction_core::energy::graph::{
    Drag, EDGE_NUMBERS, Edge, EdgeShape, GraphShape, Kinetic, NodeShape, Potential, Separation,
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
pub(super) const JUDGES: usize = 4;
/// Mean squared error, relative to the mean square, that is rounding.
const ROUNDING: f64 = 1e-26;

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
///
/// Beside every network stands a simple law that it corrects: a uniform field, a polynomial of the squared distance, viscous drag.
/// With `networks_alone` those are known to be 0.
///
/// # Errors
/// None; shapes this small fit.
pub fn architecture(
    system: LgnnSystem,
    drag: bool,
    networks_alone: bool,
) -> Result<GraphArchitecture, ModelError> {
    let network =
        |inputs, widths| NetworkShape { inputs, widths, outputs: 1, activation: Activation::Squareplus };
    let law =
        |learned: bool| if learned && !networks_alone { Number::learned(0.0) } else { Number::known(0.0) };
    let springs = matches!(system, LgnnSystem::Spring(_));
    let networks = [if springs { network(1, SPRING) } else { network(2, POTENTIAL) }, network(1, DRAG)];
    let node = NodeShape {
        kinetic: Kinetic::Mass,
        potential: if springs { Potential::None } else { Potential::Network(0) },
        drag: if drag { Drag::Network(1) } else { Drag::None },
    };
    let spring = EdgeShape { separation: Separation::Squared, potential: Some(0), embedding: None };
    let (networks, edges) = (&networks[..1 + usize::from(drag)], &[spring][..usize::from(springs)]);
    let shape = GraphShape::new(2, networks, &[node], edges)
        .ok_or(ModelError::OutOfRange { what: "number of types" })?;
    let numbers = vec![Number::known(1.0), law(drag), law(!springs), law(!springs)];
    let name = if springs { "node" } else { "bob" }.to_owned();
    let spring = |_| GraphType { name: "spring".to_owned(), numbers: vec![law(true); EDGE_NUMBERS] };
    Ok(GraphArchitecture {
        shape,
        node_types: vec![GraphType { name, numbers }],
        edge_types: edges.iter().map(spring).collect(),
        graphs: vec![graph(system)],
        graph: 0,
    })
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

/// Learns from accelerations by Levenberg–Marquardt on three quarters of the samples: first the simple laws alone, then with
/// the networks beside them; keeps what is best on the fourth quarter. `watch` is called with the iteration and the loss. Also
/// the mean squared errors on both.
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
    let (objective, judge) = (architecture.objective(rows.clone())?, architecture.objective(judges.clone())?);
    let mut best = Vec::new();
    let mut weights = architecture.beginning(seed);
    if let Some(laws) = architecture.laws_alone() {
        let (objective, judge) = (laws.objective(rows)?, laws.objective(judges)?);
        weights = Levenberg::new(&*objective, weights).best(&*objective, &*judge, iterations, |_, _| ());
        best.push(architecture.with_corrections_scaled(weights.clone(), 0.0));
    }
    // Where the laws are all there is, networks could only learn rounding.
    let rounding = ROUNDING * samples.mean_square();
    if best.first().is_none_or(|laws| judge.loss(laws) > rounding) {
        let start = Levenberg::new(&*objective, weights);
        best.push(
            start.best(&*objective, &*judge, iterations, |iteration, state| watch(iteration, state.loss)),
        );
    }
    let loss = |weights: &Vec<f64>| judge.loss(weights);
    let weights = best.into_iter().min_by(|a, b| loss(a).total_cmp(&loss(b))).unwrap_or_default();
    let errors = [objective.loss(&weights), judge.loss(&weights)];
    Ok((Model { architecture, weights }, errors))
}
