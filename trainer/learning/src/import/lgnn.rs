//! Import of networks from the LGNN authors' program.

use super::{ImportError, Imported, MAX_ELEMENTS, Tensors};
use leastaction_core::energy::NetworkShape;
use leastaction_core::energy::graph::{
    Drag, EDGE_NUMBERS, Edge, EdgeShape, GraphShape, Kinetic, MessageShape, NodeShape, Potential, Separation,
};
use leastaction_core::model::MAX_HIDDEN;
use leastaction_core::network::Activation;
use leastaction_ground_truth::{LgnnSystem, lgnn_graph};
use leastaction_models::{GraphArchitecture, GraphType, NamedGraph, Number};
use safetensors::SafeTensors;

/// The authors' names of the networks, in the order of our weight block.
pub const NETWORKS: [&str; 8] = ["L.ke", "L.ff3", "drag", "L.fb", "L.fv", "L.fe", "L.ff1", "L.ff2"];
/// Index of the drag network in [`NETWORKS`].
const DRAG: u8 = 2;
/// The authors' linear layers of the node type; their outputs are its kinetic embedding and its embedding.
pub const EMBEDDINGS: [&str; 2] = ["L.fneke", "L.fne"];

/// Reads a network of the LGNN authors' program, trained on pendulums, as a chain of `count` bobs on rods of 1 m; the first rod hangs from
/// the origin.
///
/// Their model is T = Σ ke(fneke ‖ |v_i|²), V = Σ ff3(fne ‖ x_i) and one round of messages along the chain (see [`MessageShape`]) with
/// squareplus layers. An embedding is the output of a linear layer for the only node type. Every file of theirs has a drag network; `drag`
/// says whether it was trained.
///
/// # Errors
/// [`ImportError`] names the tensor.
pub fn lgnn(bytes: &[u8], count: usize, drag: bool) -> Result<Imported, ImportError> {
    if !(1..=MAX_ELEMENTS).contains(&count) {
        return Err(ImportError::Count { found: count });
    }
    let file = SafeTensors::deserialize(bytes)?;
    let tensors = Tensors { file: &file, option: "the program that wrote it" };
    tensors.require_any("LGNN (L.ff3.0.weight, …)", |name| name.starts_with("L.ff3."))?;
    let (mut networks, mut weights) = (Vec::new(), Vec::new());
    for name in NETWORKS {
        networks.push(network(&tensors, name, &mut weights)?);
    }
    let [kinetic, own] = EMBEDDINGS.map(|name| embedding(&tensors, name));
    let (kinetic, own) = (kinetic?, own?);
    tensors.refuse_others(|name| is_known(name, &networks))?;
    let dimension = usize::from(networks[1].inputs).saturating_sub(own.len());
    let shape = shape(&networks, [kinetic.len(), own.len(), dimension], drag).ok_or("number of parts");
    let fitting = shape.and_then(|shape| shape.invalid_part().map_or(Ok(shape), Err));
    let shape = fitting.map_err(|part| ImportError::Misfit { part })?;
    // Mass, drag and field numbers.
    let mut numbers = vec![Number::known(0.0); 2 + dimension];
    numbers.extend(kinetic.into_iter().chain(own).map(Number::learned));
    let law = vec![Number::known(0.0); EDGE_NUMBERS];
    weights.extend(numbers.iter().chain(&law).map(|number| number.value));
    let architecture = GraphArchitecture {
        shape,
        node_types: vec![GraphType { name: "bob".to_owned(), numbers }],
        edge_types: vec![GraphType { name: "link".to_owned(), numbers: law }],
        graphs: vec![chain(count)],
        graph: 0,
    };
    Ok(Imported { architecture: architecture.into(), weights, discrete: false })
}

fn layer(name: &str, k: usize) -> String {
    format!("{name}.{k}")
}

/// Appends the weights of a network; its tensors give the layer sizes.
fn network(tensors: &Tensors, name: &str, weights: &mut Vec<f64>) -> Result<NetworkShape, ImportError> {
    let mut sizes: Vec<u16> = Vec::new();
    while let Some(width) = tensors.width(&layer(name, sizes.len())) {
        sizes.push(width);
    }
    let missing = || ImportError::Missing(format!("{}.bias", layer(name, 0)));
    let (outputs, widths) = sizes.split_last().ok_or_else(missing)?;
    let inputs = tensors.inputs(&layer(name, 0))?;
    let mut before = inputs;
    for (k, width) in sizes.iter().enumerate() {
        tensors.layer(&layer(name, k), before, usize::from(*width))?.append(weights);
        before = usize::from(*width);
    }
    let shape = NetworkShape::new(byte(inputs), widths, byte((*outputs).into()), Activation::Squareplus);
    shape.ok_or_else(|| ImportError::Unexpected {
        name: format!("{}.weight", layer(name, MAX_HIDDEN + 1)),
        option: tensors.option,
    })
}

/// A size as a byte, as the file format holds it; one that is too large becomes 255, which fits no network.
fn byte(size: usize) -> u8 {
    u8::try_from(size).unwrap_or(u8::MAX)
}

/// Output of the linear layer `name` for the only type, whose input is the number 1.
fn embedding(tensors: &Tensors, name: &str) -> Result<Vec<f64>, ImportError> {
    let name = layer(name, 0);
    let length = tensors.width(&name).ok_or_else(|| ImportError::Missing(format!("{name}.bias")))?;
    let super::Layer { rows, bias } = tensors.layer(&name, 1, length.into())?;
    Ok(rows.iter().flatten().zip(bias).map(|(weight, bias)| weight + bias).collect())
}

/// Whether the authors' program has a tensor of this name.
fn is_known(name: &str, networks: &[NetworkShape]) -> bool {
    let layers = networks.iter().map(|network| network.widths().1 + 1).chain([1, 1]);
    let named = NETWORKS.iter().chain(&EMBEDDINGS).zip(layers);
    let parts = |name: String| [format!("{name}.weight"), format!("{name}.bias")];
    named
        .flat_map(|(network, layers)| (0..layers).flat_map(move |k| parts(layer(network, k))))
        .any(|known| known == name)
}

fn shape(networks: &[NetworkShape], [kinetic, own, dimension]: [usize; 3], drag: bool) -> Option<GraphShape> {
    let drag = if drag { Drag::Network(DRAG) } else { Drag::None };
    let node = NodeShape { kinetic: Kinetic::Network(0), potential: Potential::Network(1), drag };
    let edge = EdgeShape { separation: Separation::Distance, potential: None, embedding: Some(3) };
    let messages = MessageShape { message: 4, update: 5, edge_potential: Some(6), node_potential: Some(7) };
    Some(GraphShape {
        kinetic_embedding: byte(kinetic),
        embedding: byte(own),
        messages: Some(messages),
        ..GraphShape::new(byte(dimension), networks, &[node], &[edge])?
    })
}

/// A chain of bobs on rods, with an edge beside every rod between two bobs.
fn chain(count: usize) -> NamedGraph {
    let edges = (1..count as u16).map(|to| Edge { kind: 0, ends: [to - 1, to] }).collect();
    NamedGraph { edges, ..lgnn_graph(LgnnSystem::Pendulum(count)) }
}
