//! Model shapes for LGNN's systems.

use super::{LgnnSystem, Rod as TrussRod};
use leastaction_core::energy::NetworkShape;
use leastaction_core::energy::graph::{
    Drag, EDGE_NUMBERS, Edge, EdgeShape, GraphShape, Kinetic, NodeShape, Potential, Separation,
};
use leastaction_core::model::{ModelError, Rod};
use leastaction_core::network::Activation;
use leastaction_models::{GraphArchitecture, GraphType, NamedGraph, Number};

/// Hidden units of every potential beside a uniform field. Squareplus is nearly linear far from the origin, and so is
/// the learned potential beyond the data.
const POTENTIAL: [u16; 4] = [8, 0, 0, 0];
/// Hidden units of a spring's potential.
const SPRING: [u16; 4] = [16, 0, 0, 0];
/// Hidden units of the drag.
const DRAG: [u16; 4] = [5, 0, 0, 0];

/// The graph of a system whose nodes and springs are all of the first type.
pub fn lgnn_graph(system: LgnnSystem) -> NamedGraph {
    let number = |node: usize| node as u16;
    let rod =
        |rod: TrussRod| Rod { from: rod.from.map(number), to: number(rod.to), length: rod.length as f32 };
    let edge = |ends: [usize; 2]| Edge { kind: 0, ends: ends.map(number) };
    NamedGraph {
        name: system.name().to_owned(),
        nodes: vec![0; system.nodes()],
        edges: system.springs().into_iter().map(edge).collect(),
        rods: system.rods().into_iter().map(rod).collect(),
    }
}

/// The shape for a system: bobs with a potential of their position, or nodes joined by springs with a potential of their squared distance.
/// All nodes have the known mass of 1 kg, which fixes the scale of L. `drag` adds drag, a function of each velocity component.
///
/// Every network corrects a simple law beside it: a uniform field, a polynomial of the squared distance, or viscous drag. With
/// `networks_alone` the laws are known to be 0.
///
/// # Errors
/// None in practice: shapes this small fit.
pub fn lgnn_shape(
    system: LgnnSystem,
    drag: bool,
    networks_alone: bool,
) -> Result<GraphArchitecture, ModelError> {
    let network =
        |inputs, widths| NetworkShape { inputs, widths, outputs: 1, activation: Activation::Squareplus };
    let law = |learned: bool| {
        if learned && !networks_alone { Number::learned(0.0) } else { Number::known(0.0) }
    };
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
        graphs: vec![lgnn_graph(system)],
        graph: 0,
    })
}
