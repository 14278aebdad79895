//! The models that are learned.

use leastaction_core::energy::NetworkShape;
use leastaction_core::energy::graph::{Drag, GraphShape, Kinetic, NodeShape, Potential};
use leastaction_core::model::{ModelError, Rod};
use leastaction_core::network::Activation;
use leastaction_ground_truth::Truss;
use leastaction_models::{GraphArchitecture, GraphType, NamedGraph, Number};

/// Numbers of hidden units of every bob's potential, beside a uniform field.
const POTENTIAL: [u16; 4] = [8, 0, 0, 0];

/// Returns a chain with a separate type for each bob, with a mass, a uniform field and a network of the position. All
/// of these are learned except the first mass, which fixes the scale of L. The rods are known, as in the authors'
/// models.
pub fn architecture(truss: &Truss) -> Result<GraphArchitecture, ModelError> {
    let count = truss.masses.len();
    let network =
        NetworkShape { inputs: 2, widths: POTENTIAL, outputs: 1, activation: Activation::Squareplus };
    let node = |k: usize| NodeShape {
        kinetic: Kinetic::Mass,
        potential: Potential::Network(k as u8),
        drag: Drag::None,
    };
    let nodes: Vec<NodeShape> = (0..count).map(node).collect();
    let shape = GraphShape::new(2, &vec![network; count], &nodes, &[])
        .ok_or(ModelError::OutOfRange { what: "number of types" })?;
    let numbers = |k: usize| {
        let mass = if k == 0 { Number::known(1.0) } else { Number::learned(1.0) };
        vec![mass, Number::known(0.0), Number::learned(0.0), Number::learned(0.0)]
    };
    let node_types =
        (0..count).map(|k| GraphType { name: format!("bob-{k}"), numbers: numbers(k) }).collect();
    let number = |node: usize| node as u16;
    let rods = truss.rods.iter().map(|rod| Rod {
        from: rod.from.map(number),
        to: number(rod.to),
        length: rod.length as f32,
    });
    let chain = NamedGraph {
        name: "chain".to_owned(),
        nodes: (0..).take(count).collect(),
        edges: Vec::new(),
        rods: rods.collect(),
    };
    Ok(GraphArchitecture { shape, node_types, edge_types: Vec::new(), graphs: vec![chain], graph: 0 })
}
