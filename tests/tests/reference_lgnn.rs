//! Pendulums that were trained with the LGNN authors' program, without and with drag, against arrays exported from it. The data
//! is not ours to ship: these tests run where `LEASTACTION_REFERENCE` names its folder.

#[path = "common/reference.rs"]
#[allow(dead_code, reason = "each test binary uses its own part")]
mod reference;

use leastaction_core::energy::NetworkShape;
use leastaction_core::energy::graph::{
    Drag, Edge, EdgeShape, Fixed, Graph, Kinetic, MessageShape, NodeShape, Potential, Separation, Shape,
    Types,
};
use leastaction_core::forces::Forces;
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::network::{Activation, Dense};
use reference::{Arrays, EXACT, assert_close, assert_within, data, scale};
use safetensors::SafeTensors;
use std::fs;

/// Coordinates of three nodes in the plane.
const N: usize = 6;
/// The authors' names of the networks, in our order, with inputs, units of both hidden layers, and outputs.
const NETWORKS: [(&str, u8, u16, u8); 8] = [
    ("L.ke", 6, 10, 1),
    ("L.ff3", 7, 5, 1),
    ("drag", 1, 5, 1),
    ("L.fb", 1, 5, 5),
    ("L.fv", 10, 5, 5),
    ("L.fe", 5, 5, 5),
    ("L.ff1", 5, 5, 1),
    ("L.ff2", 5, 5, 1),
];

fn shape(drag: Drag) -> Shape {
    let networks = NETWORKS.map(|(_, inputs, width, outputs)| {
        NetworkShape::new(inputs, &[width; 2], outputs, Activation::Squareplus).expect("few layers")
    });
    let node = NodeShape { kinetic: Kinetic::Network(0), potential: Potential::Network(1), drag };
    let edge = EdgeShape { separation: Separation::Distance, potential: None, embedding: Some(3) };
    let messages = MessageShape { message: 4, update: 5, edge_potential: Some(6), node_potential: Some(7) };
    Shape {
        kinetic_embedding: 5,
        embedding: 5,
        messages: Some(messages),
        ..Shape::new(2, &networks, &[node], &[edge]).expect("few parts")
    }
}

fn tensor(tensors: &SafeTensors, name: &str) -> Vec<f64> {
    let bytes = tensors.tensor(name).expect("tensor").data().to_vec();
    bytes.as_chunks().0.iter().map(|x| f64::from_le_bytes(*x)).collect()
}

/// A layer of theirs, row by row, in our order.
fn layer(tensors: &SafeTensors, name: &str) -> Vec<f64> {
    let (rows, bias) = (tensor(tensors, &format!("{name}.weight")), tensor(tensors, &format!("{name}.bias")));
    let (outputs, inputs) = (bias.len(), rows.len() / bias.len());
    let mut weights = rows.clone();
    for (k, weight) in rows.into_iter().enumerate() {
        weights[Dense::<f64>::position(inputs, outputs, k / inputs, k % inputs)] = weight;
    }
    [weights, bias].concat()
}

/// The weight block: an embedding is what their linear layer makes of the one type there is.
fn weights(tensors: &SafeTensors) -> Vec<f64> {
    let layers = NETWORKS.iter().flat_map(|(name, ..)| (0..3).map(move |i| format!("{name}.{i}")));
    let networks: Vec<f64> = layers.flat_map(|name| layer(tensors, &name)).collect();
    let embedding = |name: &str| {
        let bias = tensor(tensors, &format!("{name}.0.bias"));
        let weights = tensor(tensors, &format!("{name}.0.weight"));
        weights.iter().zip(bias).map(|(w, b)| w + b).collect::<Vec<f64>>()
    };
    let no_mass_drag_or_field = vec![0.0; 4];
    let no_law = vec![0.0; 2];
    [networks, no_mass_drag_or_field, embedding("L.fneke"), embedding("L.fne"), no_law].concat()
}

fn check(name: &str, drag: Drag) {
    let file = fs::read(data("lgnn").join(format!("{name}_network.safetensors"))).expect("weights");
    let weights = weights(&SafeTensors::deserialize(&file).expect("safetensors"));
    let mut block = &weights[..];
    let types = Types::<f64, 2, 8, 10, 2>::take(&mut block, &shape(drag)).expect("weights of this shape");
    assert!(block.is_empty());
    let edges = [[0, 1], [1, 2]].map(|ends| Edge { kind: 0, ends });
    let graph = Graph::new(types, &[0; 3], &edges).expect("a graph");
    let fixed = Fixed::<_, 2, _, _, _, N>::new(graph).expect("as many coordinates");
    let mut reference = Arrays::open(&data("lgnn").join(format!("{name}_reference.npz")));
    let (q, v) = (reference.get("q"), reference.get("v"));
    let (mut kinetic, mut potential, mut l_q, mut mass, mut force) = (vec![], vec![], vec![], vec![], vec![]);
    for (q, v) in q.as_chunks::<N>().0.iter().zip(v.as_chunks::<N>().0) {
        let energies = Lagrangian::<f64, N>::energies(&fixed, q, v);
        kinetic.push(energies.kinetic);
        potential.push(energies.potential);
        let dynamics = fixed.dynamics(q, v);
        l_q.extend(dynamics.l_q);
        mass.extend_from_slice(dynamics.mass.0.as_flattened());
        force.extend(fixed.force(q, v));
    }
    assert_close("T", &kinetic, &reference.get("T"), EXACT);
    assert_close("V", &potential, &reference.get("V"), EXACT);
    assert_close("L_q", &l_q, &reference.get("Pi"), EXACT);
    assert_close("M", &mass, &reference.get("M"), EXACT);
    let drag = reference.get("drag");
    assert_within("drag", &force, &drag, scale(&drag).max(1.0), EXACT);
}

#[test]
#[ignore = "needs LEASTACTION_REFERENCE"]
fn energies_and_derivatives_agree() {
    check("3_pendulum", Drag::None);
}

#[test]
#[ignore = "needs LEASTACTION_REFERENCE"]
fn energies_derivatives_and_drag_agree() {
    check("3_pendulum_drag", Drag::Network(2));
}
