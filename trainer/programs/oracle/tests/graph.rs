//! Comparison of the graph family, for any size, with core in f64: value, derivatives, and gradients with respect to
//! the weights.

mod common;

use common::{Dual, Motion, Numbers, random_weights};
use leastaction_core::energy::graph::{
    Drag, Edge, EdgeShape, Fixed, Graph, GraphShape, Kinetic, MAX_NETWORKS, MessageShape, NodeShape,
    Potential, Separation, Types,
};
use leastaction_core::energy::{List, NetworkShape};
use leastaction_core::forces;
use leastaction_core::model::ModelError;
use leastaction_core::network::Activation;
use leastaction_core::scalar::WeightFormat;
use leastaction_programs::dynamics::{Accelerations, OneSampleAccelerations};
use leastaction_programs::energies::{Energies, GraphEnergies};
use leastaction_programs::{Program, Row, System};

/// Lengths of the embeddings: of kinetic energies, of nodes, of edges. All are different, and none is a dimension of
/// space.
const KINETIC: u8 = 1;
const H: u8 = 4;
const E: u8 = 5;

/// The networks to which the types refer, in several activations; none has widths that are multiples of a panel.
fn networks(dimension: u8) -> [NetworkShape; 11] {
    let of = |inputs, widths: &[u16], outputs, activation| {
        NetworkShape::new(inputs, widths, outputs, activation).unwrap()
    };
    [
        of(KINETIC + 1, &[7], 1, Activation::Softplus),
        of(KINETIC + 1, &[3, 10], 1, Activation::Tanh),
        of(H + dimension, &[13], 1, Activation::Tanh),
        of(H + dimension, &[6, 9, 2], 1, Activation::Squareplus),
        of(1, &[11], 1, Activation::Tanh),
        of(1, &[5, 7], 1, Activation::Softplus),
        of(1, &[17], E, Activation::Tanh),
        of(H + E, &[9], H, Activation::Tanh),
        of(H, &[], E, Activation::Identity),
        of(E, &[3, 5], 1, Activation::Softplus),
        of(H, &[14], 1, Activation::Isru),
    ]
}

const KINETIC_NETWORKS: [u8; 2] = [0, 1];
const POTENTIALS: [u8; 2] = [2, 3];
/// Networks of a single number: drag, pairs.
const SCALARS: [u8; 2] = [4, 5];
const EMBEDDING: u8 = 6;
const MESSAGES: MessageShape =
    MessageShape { message: 7, update: 8, edge_potential: Some(9), node_potential: Some(10) };

const PLAIN: NodeShape = NodeShape { kinetic: Kinetic::Mass, potential: Potential::None, drag: Drag::None };
const HEAVY: NodeShape =
    NodeShape { kinetic: Kinetic::Mass, potential: Potential::Uniform, drag: Drag::Viscous };
const LEARNED: NodeShape = NodeShape {
    kinetic: Kinetic::Network(KINETIC_NETWORKS[0]),
    potential: Potential::Network(POTENTIALS[0]),
    drag: Drag::Network(SCALARS[0]),
};
const DEEP: NodeShape = NodeShape {
    kinetic: Kinetic::Network(KINETIC_NETWORKS[1]),
    potential: Potential::Network(POTENTIALS[1]),
    drag: Drag::Network(SCALARS[1]),
};
const SPRING: EdgeShape = EdgeShape { separation: Separation::Distance, potential: None, embedding: None };
const QUARTIC: EdgeShape = EdgeShape { separation: Separation::Squared, ..SPRING };
/// An edge with the network of [`LEARNED`]'s drag.
const PAIR: EdgeShape = EdgeShape { potential: Some(SCALARS[0]), ..SPRING };
const SQUARED_PAIR: EdgeShape = EdgeShape { potential: Some(SCALARS[1]), ..QUARTIC };

fn with_messages(edge: EdgeShape) -> EdgeShape {
    EdgeShape { embedding: Some(EMBEDDING), ..edge }
}

fn shape(
    dimension: u8,
    nodes: &[NodeShape],
    edges: &[EdgeShape],
    messages: Option<MessageShape>,
) -> GraphShape {
    let shape = GraphShape::new(dimension, &networks(dimension), nodes, edges).unwrap();
    GraphShape { kinetic_embedding: KINETIC, embedding: H, messages, ..shape }
}

fn edges<const M: usize>(edges: [(u8, [u16; 2]); M]) -> [Edge; M] {
    edges.map(|(kind, ends)| Edge { kind, ends })
}

type Core<'a, W, const D: usize, const N: usize> = Fixed<'a, W, D, MAX_NETWORKS, 64, 4, N>;

/// Core's graph with its drag.
fn core<'a, W: WeightFormat, const D: usize, const N: usize>(
    shape: &GraphShape,
    (nodes, edges): (&'a [u8], &'a [Edge]),
    mut block: &'a [W],
) -> forces::System<Core<'a, W, D, N>, Core<'a, W, D, N>> {
    let types = Types::take(&mut block, shape).unwrap();
    assert!(block.is_empty(), "{} numbers are left", block.len());
    let core = Fixed::new(Graph::new(types, nodes, edges).unwrap()).unwrap();
    forces::System { lagrangian: core, forces: core }
}

/// Checks a graph of N coordinates, with D for each node.
fn check<const D: usize, const N: usize>(shape: &GraphShape, nodes: &[u8], edges: &[Edge]) {
    let model = GraphEnergies::new(shape, nodes, edges, 0).unwrap();
    let weights = random_weights(model.parameters(), N as u64);
    let motion = |weights: &[Dual], at: [&[Dual; N]; 3]| {
        Motion::new(&core::<_, D, N>(shape, (nodes, edges), weights), at)
    };
    let numbers = Numbers::<N>::new(weights.clone(), 1.5, N as u64);
    common::check(&model, &core::<_, D, N>(shape, (nodes, edges), &weights), motion, &numbers, 1.0);
}

#[test]
fn one_node() {
    check::<2, 2>(&shape(2, &[HEAVY], &[], None), &[0], &[]);
    check::<3, 3>(&shape(3, &[LEARNED], &[], None), &[0], &[]);
}

#[test]
fn springs() {
    let list = edges([(0, [0, 1]), (0, [2, 1])]);
    check::<2, 6>(&shape(2, &[HEAVY], &[SPRING], None), &[0; 3], &list);
    check::<3, 9>(&shape(3, &[HEAVY], &[QUARTIC], None), &[0; 3], &list);
}

#[test]
fn learned_types() {
    let list = edges([(0, [1, 0])]);
    check::<2, 4>(&shape(2, &[LEARNED], &[PAIR], None), &[0; 2], &list);
    check::<3, 6>(&shape(3, &[DEEP], &[SQUARED_PAIR], None), &[0; 2], &list);
}

/// Types alternate in the lists, two nodes share several edges, types share networks, and one type of each kind has no
/// members.
#[test]
fn mixed_types() {
    let nodes = [HEAVY, LEARNED, PLAIN, DEEP, PLAIN];
    let kinds = [SPRING, PAIR, QUARTIC, SQUARED_PAIR, EdgeShape { separation: Separation::Squared, ..PAIR }];
    let list = edges([(4, [0, 1]), (0, [2, 1]), (1, [1, 2]), (4, [2, 3]), (3, [3, 0]), (1, [0, 2])]);
    check::<2, 8>(&shape(2, &nodes, &kinds, None), &[1, 0, 3, 1], &list);
    check::<3, 12>(&shape(3, &nodes, &kinds, None), &[3, 2, 0, 3], &list);
}

#[test]
fn messages_between_nodes_of_one_type() {
    let list = edges([(0, [0, 1]), (0, [2, 1]), (0, [0, 2])]);
    let kinds = [with_messages(SPRING)];
    check::<2, 6>(&shape(2, &[LEARNED], &kinds, Some(MESSAGES)), &[0; 3], &list);
    let kinds = [with_messages(SQUARED_PAIR)];
    check::<3, 9>(&shape(3, &[HEAVY], &kinds, Some(MESSAGES)), &[0; 3], &list);
}

/// Edges join nodes of one type and of two types, edges of two types have different embeddings, and one pair of nodes
/// has two edges.
#[test]
fn messages_between_mixed_types() {
    let list = edges([(0, [0, 1]), (1, [2, 1]), (0, [0, 2]), (1, [2, 3]), (0, [1, 2])]);
    let kinds = [with_messages(PAIR), with_messages(QUARTIC)];
    let shape = shape(2, &[PLAIN, LEARNED], &kinds, Some(MESSAGES));
    check::<2, 8>(&shape, &[0, 1, 0, 0], &list);
}

#[test]
fn messages_of_each_potential_alone() {
    let list = edges([(0, [0, 1]), (0, [2, 1])]);
    let kinds = [with_messages(QUARTIC)];
    let of_edges = MessageShape { node_potential: None, ..MESSAGES };
    check::<3, 9>(&shape(3, &[PLAIN, PLAIN], &kinds, Some(of_edges)), &[1, 0, 0], &list);
    let of_nodes = MessageShape { edge_potential: None, ..MESSAGES };
    check::<2, 6>(&shape(2, &[PLAIN, PLAIN], &kinds, Some(of_nodes)), &[1, 0, 0], &list);
    let of_none = MessageShape { node_potential: None, ..of_edges };
    check::<2, 6>(&shape(2, &[HEAVY], &kinds, Some(of_none)), &[0; 3], &list);
}

#[test]
fn messages_without_an_edge() {
    let kinds = [with_messages(QUARTIC)];
    check::<2, 4>(&shape(2, &[HEAVY], &kinds, Some(MESSAGES)), &[0; 2], &[]);
}

/// Embeddings without numbers, and networks without a hidden layer.
#[test]
fn empty_embeddings() {
    let of = |inputs, outputs| NetworkShape::new(inputs, &[], outputs, Activation::Tanh).unwrap();
    let edge = EdgeShape { embedding: Some(1), potential: Some(0), ..QUARTIC };
    let node =
        NodeShape { kinetic: Kinetic::Network(0), potential: Potential::Network(2), drag: Drag::Network(0) };
    let networks = [of(1, 1), of(1, 0), of(3, 1), of(1, 1), of(1, 0), of(0, 1)];
    let mut shape = GraphShape::new(2, &networks, &[node], &[edge]).unwrap();
    shape.embedding = 1;
    shape.messages =
        Some(MessageShape { message: 3, update: 4, edge_potential: Some(5), node_potential: Some(0) });
    check::<2, 4>(&shape, &[0; 2], &edges([(0, [0, 1])]));
    (shape.embedding, shape.messages) = (0, None);
    shape.networks = List::new(&[of(1, 1), of(1, 0), of(2, 1)]).unwrap();
    shape.edges = List::new(&[EdgeShape { embedding: None, ..edge }]).unwrap();
    check::<2, 4>(&shape, &[0; 2], &edges([(0, [0, 1])]));
}

/// Energies and the gradient along a direction.
fn results(model: &GraphEnergies, weights: &[f64], start: usize) -> (Vec<Row>, Vec<Row>) {
    let x: Vec<Vec<Row>> = (0..5)
        .map(|k| (0..model.n()).map(|i| Row::splat(f64::from((3 * k + 7 * i as u32) % 11) / 7.0)).collect())
        .collect();
    let inputs: Vec<&[Row]> = x.iter().map(|x| &x[..]).collect();
    let run = |program: &Program| {
        let mut rows = vec![vec![Row::default(); weights.len()]; program.rows()];
        let mut workspace = program.workspace();
        program.run(weights, &inputs, &mut workspace, &mut rows);
        (workspace, rows)
    };
    let system = System::new(model);
    let (energies, _) = run(&system.energies());
    let (_, mut rows) = run(&system.along(1));
    let energies = [energies.output(0), energies.output(1)].concat();
    assert!(rows[0][..start].iter().all(|row| *row == Row::default()));
    (energies, rows[0].split_off(start))
}

#[test]
fn a_block_may_begin_anywhere() {
    let shape = shape(2, &[HEAVY, LEARNED], &[with_messages(PAIR)], Some(MESSAGES));
    let (nodes, list) = ([0, 1, 1], edges([(0, [0, 1]), (0, [2, 1])]));
    let [own, behind] = [0, 5].map(|start| GraphEnergies::new(&shape, &nodes, &list, start).unwrap());
    let weights = random_weights(behind.parameters(), 1);
    assert_eq!(own.parameters() + 5, behind.parameters());
    assert_eq!(results(&own, &weights[5..], 0), results(&behind, &weights, 5));
}

/// The list of operations of a graph of a thousand nodes is as long as that of a small graph.
#[test]
fn graphs_of_any_size_take_the_same_steps() {
    let shape = shape(2, &[HEAVY], &[with_messages(PAIR)], Some(MESSAGES));
    let steps = [3, 1000].map(|nodes| {
        let list: Vec<Edge> = (1..nodes).map(|i| Edge { kind: 0, ends: [i - 1, i] }).collect();
        let model = GraphEnergies::new(&shape, &vec![0; nodes.into()], &list, 0).unwrap();
        System::new(&model).gradient().steps()
    });
    assert_eq!(steps[0], steps[1]);
}

/// A ring of nodes of two types, one with a mass and one with a network.
fn ring(nodes: u16) -> (System, Vec<f64>) {
    let shape = shape(2, &[HEAVY, LEARNED], &[with_messages(PAIR)], Some(MESSAGES));
    let list: Vec<Edge> = (0..nodes).map(|i| Edge { kind: 0, ends: [i, (i + 1) % nodes] }).collect();
    let kinds: Vec<u8> = (0..nodes).map(|i| u8::from(i % 3 == 1)).collect();
    let model = GraphEnergies::new(&shape, &kinds, &list, 0).unwrap();
    (System::new(&model), random_weights(model.parameters(), 3))
}

/// The mass matrix has a block for every node or coordinate, so two directions determine all blocks.
#[test]
fn mass_matrices_of_graphs_take_as_many_directions_as_dimensions() {
    for nodes in [5, 200] {
        let (program, pattern) = ring(nodes).0.equation_of_motion();
        assert_eq!(pattern.directions(), 2);
        assert_eq!(program.steps(), ring(5).0.equation_of_motion().0.steps());
    }
}

#[test]
fn accelerations_of_one_sample_are_those_of_samples_side_by_side() {
    for nodes in [3, 40, 67] {
        let (system, weights) = ring(nodes);
        let n = system.n();
        let x = |k: usize, i: usize| ((7 * i + 3 * k) as f64).sin();
        let [q, v, tau] = [0, 1, 2].map(|k| (0..n).map(|i| x(k, i)).collect::<Vec<_>>());
        let rows = [&q, &v, &tau].map(|x| x.iter().map(|x| Row::splat(*x)).collect::<Vec<_>>());
        let mut expected = vec![Row::default(); n];
        let failures = Accelerations::new(&system).evaluate(
            &weights,
            rows.each_ref().map(Vec::as_slice),
            &mut expected,
            None,
        );
        let mut found = vec![0.0; n];
        let solved = OneSampleAccelerations::new(&system).evaluate(&weights, [&q, &v, &tau], &mut found);
        assert!(solved && !failures.all());
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected.0[0]).abs() < 1e-11 * (1.0 + found.abs()), "{found} {expected:?}");
        }
    }
}

#[test]
fn wrong_graphs_are_refused() {
    let shape = shape(2, &[HEAVY], &[SPRING], None);
    let found = GraphEnergies::new(&shape, &[0, 1], &[], 0).unwrap_err();
    assert!(matches!(found, ModelError::Graph(_)), "{found}");
    let found = GraphEnergies::new(&GraphShape { dimension: 4, ..shape }, &[0], &[], 0).unwrap_err();
    assert!(matches!(found, ModelError::OutOfRange { .. }), "{found}");
}
