//! The model file of the graph family: a valid file loads, and everything else is a typed error.

use crate::common::file::{self, Aligned, WEB_NUMBERS, web, web_header, web_weights};
use crate::common::graphs::{Model, edge};
use crate::common::particles::rod_error;
use crate::common::sections::out_of_range;
use crate::common::trees::network;
use crate::common::{assert_close, assert_vectors_close};
use leastaction_core::constraints::Holonomic;
use leastaction_core::discrete::rattle::{ParticleState, Rattle};
use leastaction_core::energy::List;
use leastaction_core::energy::graph::{Drag, Edge, GraphError, GraphShape, Kinetic, Potential};
use leastaction_core::model::{
    FORMAT_VERSION, GraphHeader, GraphLayout, GraphModel, GraphSystem, MAX_GRAPHS, ModelError, ModularModel,
    Rod, Section, parse,
};
use leastaction_core::network::Activation;
use leastaction_core::particles::Particles;
use leastaction_core::scalar::Weights;
use proptest::prelude::*;

/// The web, compiled with the sizes that just fit it.
type Web<'a> = GraphModel<'a, 2, 6, 5, 1>;

/// Placeholder for a rod that is not read yet.
const UNUSED: Holonomic<f32, 2> = Holonomic::Anchor { node: 0, to: [0.0; 2], length: 1.0 };

fn refusal(file: &[u8]) -> ModelError {
    let (mut edges, mut rods) = ([Edge::default(); 8], [UNUSED; 8]);
    Web::load(Aligned::new(file).bytes(), "ring", &mut edges, &mut rods)
        .map(|_| ())
        .expect_err("the file must be refused")
}

/// Reason why loading refuses a header with the right number of weights.
fn header_refusal(header: GraphHeader) -> ModelError {
    let count = header.parameters().unwrap();
    let mut weights = web_weights(WEB_NUMBERS);
    weights.resize(count, 0.5);
    refusal(&file::write(web_header(header), &weights))
}

fn with_shape(change: impl FnOnce(&mut GraphShape)) -> GraphHeader<'static> {
    let mut header = web();
    change(&mut header.shape);
    header
}

fn with_ring<'a>(nodes: &'a [u8], edges: &'a [u8]) -> GraphHeader<'a> {
    let mut header = web();
    header.graphs[1] = GraphLayout { name: "ring", nodes, edges, rods: &[] };
    header
}

fn with_rods(rods: &[u8]) -> GraphHeader<'_> {
    let mut header = web();
    header.graphs[1].rods = rods;
    header
}

#[test]
fn a_valid_file_loads_and_is_what_was_written() {
    let file = Aligned::new(&file::golden_web());
    let parsed = parse(file.bytes()).unwrap();
    assert_eq!(parsed.header, web_header(web()));
    let Weights::Single(weights) = parsed.weights else { panic!("single precision") };
    assert_eq!(weights, web_weights(WEB_NUMBERS));
    assert!(file.bytes().as_ptr_range().contains(&weights.as_ptr().cast()), "borrowed in place");
    let (mut edges, mut rods) = ([Edge::default(); 3], [UNUSED; 2]);
    let model = Web::load(file.bytes(), "ring", &mut edges, &mut rods).unwrap();
    assert_eq!(model.trained_step, parsed.header.trained_step);
    let GraphSystem { graph, rods } = model.system;
    assert_eq!(graph.nodes(), [0, 1, 1]);
    assert!(file.bytes().as_ptr_range().contains(&graph.nodes().as_ptr()), "borrowed in place");
    assert_eq!(graph.edges(), [edge(0, 0, 1), edge(0, 1, 2), edge(0, 2, 0)]);
    assert_eq!(graph.types().shape(), &file::web_shape());
    let [anchor, rod] = file::RODS.map(|rod| Rod::from_bytes(rod).constraint());
    assert_eq!(rods, [anchor, rod]);
}

/// The rods of a file hold the stepped model: they keep their lengths.
#[test]
fn a_loaded_model_moves_under_its_rods() {
    let (file, mut edges, mut rods) = (Aligned::new(&file::golden_web()), [Edge::default(); 3], [UNUSED; 2]);
    let model = Web::load(file.bytes(), "ring", &mut edges, &mut rods).unwrap();
    let system = model.system.constrained().unwrap();
    let rattle = model.rattle::<f32>().unwrap();
    let mut workspace = vec![0.0; ParticleState::<f32, 2>::workspace(3, 2)];
    let mut work = vec![0.0; Rattle::workspace(&system)];
    let (q, v) = ([[0.0, -0.5], [1.0, 1.0], [0.0, -2.5]], [[1.0, 0.0], [0.5, 0.0], [1.0, 0.0]]);
    let mut state = ParticleState::new(&system, &q, &v, &mut workspace, &mut work).unwrap();
    for _ in 0..10 {
        rattle.step(&system, &mut state, None, &mut work).unwrap();
    }
    assert!(rod_error(model.system.rods, state.q()) < 1e-5);
    assert!(state.q()[0][0].abs() > 1e-2, "it moves");
}

#[test]
fn rods_are_what_was_written() {
    let header = web();
    let rods: Vec<_> = header.layout("ring").unwrap().rods().collect();
    let [anchor, rod] =
        [(None, 0, 0.5), (Some(0), 2, 2.0)].map(|(from, to, length)| Rod { from, to, length });
    assert_eq!(rods, [anchor, rod]);
    assert_eq!(rods.iter().map(|rod| rod.to_bytes()).collect::<Vec<_>>(), file::RODS.map(Some));
    assert_eq!(anchor.constraint::<f32, 2>(), Holonomic::Anchor { node: 0, to: [0.0; 2], length: 0.5 });
    assert_eq!(rod.constraint::<f64, 3>(), Holonomic::Rod { nodes: [2, 0], length: 2.0 });
}

#[test]
fn rods_that_cannot_be_are_refused() {
    let rod = |from, to, length| Rod { from, to, length }.to_bytes().unwrap();
    assert_eq!(header_refusal(with_rods(&[0; 7])), out_of_range("length of a list of rods"));
    for bad in [rod(Some(0), 0, 1.0), rod(Some(3), 0, 1.0), rod(None, 3, 1.0)] {
        assert_eq!(header_refusal(with_rods(&bad)), out_of_range("end of a rod"));
    }
    for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert_eq!(header_refusal(with_rods(&rod(None, 1, bad))), out_of_range("length of a rod"));
    }
}

#[test]
fn a_loaded_graph_is_the_one_of_its_weights() {
    let (file, mut edges, mut rods) = (Aligned::new(&file::golden_web()), [Edge::default(); 3], [UNUSED; 2]);
    let graph = Web::load(file.bytes(), "ring", &mut edges, &mut rods).unwrap().system.graph;
    let mut twin = Model::<2>::new(file::web_shape(), graph.nodes(), graph.edges(), 0);
    twin.weights = web_weights(WEB_NUMBERS).into_iter().map(f64::from).collect();
    let (q, v) = ([[0.5_f32, -1.0], [2.0, 0.25], [-1.5, 1.0]], [[1.0_f32, -0.5], [0.25, 2.0], [0.0, 0.75]]);
    let mut workspace = vec![0.0; Particles::<f32, 2>::workspace(&graph)];
    let found = graph.energies(&q, &v, &mut workspace);
    let wide = v.map(|v| v.map(f64::from));
    let kinetic: f64 = twin.nodes.iter().zip(&wide).map(|(kind, v)| twin.naive_kinetic(*kind, v)).sum();
    assert_close("T", found.kinetic.into(), kinetic, 3e-6);
    assert_close("V", found.potential.into(), twin.naive_potential(&q.map(|q| q.map(f64::from))), 3e-6);
    assert_vectors_close("drag", &graph.drag(0, &v[0]).map(f64::from), &[-0.25, 0.125], 0.0);
}

#[test]
fn one_file_serves_all_its_graphs() {
    let (file, mut edges, mut rods) = (Aligned::new(&file::golden_web()), [Edge::default(); 3], [UNUSED; 2]);
    let mut load = |name| {
        let model = Web::load(file.bytes(), name, &mut edges, &mut rods);
        model.map(|model| model.system.graph.nodes().len())
    };
    assert_eq!(load("pair"), Ok(2));
    assert_eq!(load("ring"), Ok(3));
    assert_eq!(load("star"), Err(ModelError::NoSuchGraph { graphs: 2 }));
    assert_eq!(load(""), Err(ModelError::NoSuchGraph { graphs: 2 }));
    let text = ModelError::NoSuchGraph { graphs: 2 }.to_string();
    assert_eq!(text, "none of the 2 graphs in the file has that name");
    let few = Web::load(file.bytes(), "ring", &mut edges[..2], &mut rods).map(|_| ()).unwrap_err();
    assert_eq!(few, ModelError::Graph(GraphError::TooManyEdges { capacity: 2, needed: 3 }));
    let few = Web::load(file.bytes(), "ring", &mut edges, &mut rods[..1]).map(|_| ()).unwrap_err();
    assert_eq!(few, ModelError::Graph(GraphError::TooManyRods { capacity: 1, needed: 2 }));
    assert!(GraphModel::<2, 12, 16, 4>::load(file.bytes(), "pair", &mut edges[..1], &mut []).is_ok());
}

#[test]
fn every_truncation_and_every_change_of_a_byte_is_an_error() {
    file::assert_truncations_are_refused(&file::golden_web());
    file::assert_changes_are_refused(&file::golden_web());
}

#[test]
fn families_are_not_mistaken_for_each_other() {
    assert_eq!(refusal(&file::golden_arm()), ModelError::OtherFamily { found: "modular" });
    let web = Aligned::new(&file::golden_web());
    let error = ModularModel::<3, 3, 5, 2>::load(web.bytes(), "ring").unwrap_err();
    assert_eq!(error, ModelError::OtherFamily { found: "graph" });
}

#[test]
fn the_types_must_fit_the_compiled_sizes() {
    fn load<const D: usize, const K: usize, const H: usize, const L: usize>() -> ModelError {
        let (file, mut edges) = (Aligned::new(&file::golden_web()), [Edge::default(); 3]);
        let mut rods = [Holonomic::Anchor { node: 0, to: [0.0; D], length: 1.0 }; 2];
        GraphModel::<D, K, H, L>::load(file.bytes(), "ring", &mut edges, &mut rods).map(|_| ()).unwrap_err()
    }
    let shape = |what, found, compiled| ModelError::Shape { what, found, compiled };
    assert_eq!(load::<3, 6, 5, 1>(), shape("dimensions", 2, 3));
    assert_eq!(load::<2, 5, 5, 1>(), shape("networks", 6, 5));
    assert_eq!(load::<2, 6, 4, 1>(), shape("units in a hidden layer", 5, 4));
    assert_eq!(load::<2, 6, 5, 0>(), shape("hidden layers", 1, 0));
}

#[test]
fn what_is_no_graph_is_an_error() {
    let bytes = |edges: &[Edge]| edges.iter().flat_map(|edge| edge.to_bytes()).collect::<Vec<u8>>();
    let cases: [(&[u8], &[Edge], GraphError); 5] = [
        (&[0, 2], &[], GraphError::NodeKind { node: 1, kind: 2, kinds: 2 }),
        (&[0, 1], &[edge(0, 0, 1), edge(1, 0, 1)], GraphError::EdgeKind { edge: 1, kind: 1, kinds: 1 }),
        (&[0, 1], &[edge(0, 0, 2)], GraphError::End { edge: 0, node: 2, nodes: 2 }),
        (&[0, 1], &[edge(0, 256, 1)], GraphError::End { edge: 0, node: 256, nodes: 2 }),
        (&[0, 1], &[edge(0, 1, 1)], GraphError::Loop { edge: 0, node: 1 }),
    ];
    for (nodes, edges, error) in cases {
        let found = header_refusal(with_ring(nodes, &bytes(edges)));
        assert_eq!(found, ModelError::Graph(error), "{nodes:?} {edges:?}");
    }
    let mut edges = bytes(&[edge(0, 0, 1), edge(0, 1, 0)]);
    while edges.pop().is_some_and(|_| edges.len() > 5) {
        assert_eq!(header_refusal(with_ring(&[0, 1], &edges)), out_of_range("length of a list of edges"));
    }
}

#[test]
fn more_than_256_nodes_have_edges() {
    let (nodes, ends) = ([1; 600], edge(0, 599, 258).to_bytes());
    let file = file::write(web_header(with_ring(&nodes, &ends)), &web_weights(WEB_NUMBERS));
    let (file, mut edges) = (Aligned::new(&file), [Edge::default(); 1]);
    let graph = Web::load(file.bytes(), "ring", &mut edges, &mut []).unwrap().system.graph;
    assert_eq!((graph.nodes().len(), graph.edges()), (600, &[edge(0, 599, 258)][..]));
}

#[test]
fn names_are_there_and_different() {
    for names in ["", "bob", "bob,body,rod", "bob,", ",bob", "bob,bob"] {
        let error = header_refusal(GraphHeader { node_names: names, ..web() });
        assert_eq!(error, ModelError::Names { of: "node types" }, "{names}");
    }
    for names in ["", "spring,rod", "spring,"] {
        let error = header_refusal(GraphHeader { edge_names: names, ..web() });
        assert_eq!(error, ModelError::Names { of: "edge types" }, "{names}");
    }
    for name in ["", "ring"] {
        let mut header = web();
        header.graphs[0].name = name;
        assert_eq!(header_refusal(header), ModelError::Names { of: "graphs" }, "{name}");
    }
}

#[test]
fn a_model_without_edges_has_no_names_of_edges() {
    let mut header = with_shape(|shape| {
        shape.edges = List::default();
        shape.messages = None;
    });
    header.edge_names = "";
    header.graphs.iter_mut().for_each(|graph| graph.edges = &[]);
    let weights = web_weights(WEB_NUMBERS);
    let (without_law, _) = weights.split_last_chunk::<2>().unwrap();
    let file = file::write(web_header(header), without_law);
    assert!(Web::load(Aligned::new(&file).bytes(), "ring", &mut [], &mut [UNUSED; 2]).is_ok());
    let named = GraphHeader { edge_names: "spring", ..header };
    assert_eq!(header_refusal(named), ModelError::Names { of: "edge types" });
}

#[test]
fn lists_have_no_gap() {
    let none = GraphHeader { graphs: [GraphLayout::default(); MAX_GRAPHS], ..web() };
    assert_eq!(header_refusal(none), out_of_range("number of graphs"));
    let mut gap = web();
    gap.graphs.swap(1, 2);
    assert_eq!(header_refusal(gap), out_of_range("list of graphs"));
    let mut named = web();
    named.graphs[2].name = "nothing";
    assert_eq!(header_refusal(named), out_of_range("list of graphs"));
    let cases = [
        (with_shape(|shape| shape.nodes = List::default()), "number of node types"),
        (with_shape(|shape| shape.nodes.slots.swap(1, 2)), "list of node types"),
        (with_shape(|shape| shape.edges.slots.swap(0, 1)), "list of edge types"),
        (with_shape(|shape| shape.edges.slots[2] = shape.edges.slots[0]), "list of edge types"),
        (with_shape(|shape| shape.networks.slots.swap(5, 6)), "list of networks"),
        (with_shape(|shape| shape.dimension = 1), "number of dimensions"),
        (with_shape(|shape| shape.dimension = 4), "number of dimensions"),
        (with_shape(|shape| shape.embedding = 9), "length of an embedding"),
        (with_shape(|shape| shape.kinetic_embedding = 9), "length of an embedding"),
    ];
    for (header, what) in cases {
        assert_eq!(header_refusal(header), out_of_range(what));
    }
}

#[test]
fn networks_must_have_the_arity_of_their_use() {
    let set = |i: usize, inputs, outputs| {
        let network = network(inputs, &[3], outputs, Activation::Tanh);
        with_shape(|shape| shape.networks.slots[i] = Some(network))
    };
    let node = |i: usize, change: fn(&mut leastaction_core::energy::graph::NodeShape)| {
        with_shape(|shape| shape.nodes.slots[i].iter_mut().for_each(change))
    };
    let embedding =
        |network| with_shape(|shape| shape.edges.slots[0].iter_mut().for_each(|e| e.embedding = network));
    let (of_node, of_edge) = ("network of a node type", "network of an edge type");
    let of_messages = "network of the messages";
    let cases = [
        (set(0, 1, 1), of_node),
        (set(0, 2, 2), of_node),
        (node(1, |node| node.kinetic = Kinetic::Network(6)), of_node),
        (node(0, |node| node.potential = Potential::Network(0)), of_node),
        (node(0, |node| node.drag = Drag::Network(0)), of_node),
        (set(1, 2, 1), of_edge),
        (set(1, 1, 2), of_edge),
        (embedding(None), of_edge),
        (set(2, 2, 2), of_edge),
        (set(2, 1, 9), "length of an embedding"),
        (set(2, 1, 3), of_messages),
        (set(3, 3, 2), of_messages),
        (set(3, 4, 3), of_messages),
        (set(4, 2, 1), of_messages),
        (set(4, 1, 2), of_messages),
        (set(5, 2, 2), of_messages),
        (set(5, 3, 1), of_messages),
        (with_shape(|shape| shape.messages.iter_mut().for_each(|m| m.node_potential = Some(1))), of_messages),
        (with_shape(|shape| shape.messages.iter_mut().for_each(|m| m.message = 255)), of_messages),
        (with_shape(|shape| shape.messages = None), of_edge),
    ];
    for (i, (header, what)) in cases.into_iter().enumerate() {
        assert_eq!(header_refusal(header), out_of_range(what), "case {i}");
    }
}

#[test]
fn numbers_of_a_type_are_in_range() {
    let with = |kind: usize, number: usize, value| {
        let mut numbers = WEB_NUMBERS;
        numbers[kind][number] = value;
        file::write(web_header(web()), &web_weights(numbers))
    };
    for mass in [0.0, -1.0] {
        assert_eq!(refusal(&with(0, 0, mass)), ModelError::Graph(GraphError::Mass { kind: 0 }));
    }
    assert_eq!(refusal(&with(0, 1, -0.5)), ModelError::Graph(GraphError::Drag { kind: 0 }));
    assert!(parse(Aligned::new(&with(1, 0, -1.0)).bytes()).is_ok(), "a mass that is not used");
    for kind in 0..2 {
        for number in 0..7 {
            let error = refusal(&with(kind, number, f32::NAN));
            assert!(matches!(error, ModelError::NotFinite { .. }), "{error:?}");
        }
    }
}

#[test]
fn weights_are_as_many_as_the_shape_says() {
    let weights = web_weights(WEB_NUMBERS);
    let needed = weights.len();
    assert_eq!(needed, 13 + 13 + 4 + 23 + 6 + 21 + 2 * 7 + 2);
    let error = refusal(&file::write(web_header(web()), &weights[1..]));
    assert_eq!(error, ModelError::WeightCount { found: needed - 1, needed });
    let wide = with_shape(|shape| {
        shape.networks.slots = [Some(network(255, &[u16::MAX; 4], 255, Activation::Tanh)); 12];
    });
    let error = refusal(&file::write(web_header(wide), &weights));
    assert!(matches!(error, ModelError::WeightCount { found, .. } if found == needed), "{error:?}");
}

/// Evaluates whatever loads.
fn evaluate(file: &Aligned, name: &str) {
    let (mut edges, mut rods) = ([Edge::default(); 8], [UNUSED; 8]);
    if let Ok(model) = GraphModel::<2, 12, 8, 3>::load(file.bytes(), name, &mut edges, &mut rods) {
        assert!(model.system.constrained().is_ok());
        let (graph, nodes) = (model.system.graph, model.system.graph.nodes().len());
        let mut workspace = vec![0.0; Particles::<f32, 2>::workspace(&graph)];
        let (q, mut l_q) = (vec![[0.3_f32; 2]; nodes], vec![[0.0; 2]; nodes]);
        graph.l_q(&q, &mut workspace, &mut l_q);
        let _ = graph.energies(&q, &q, &mut workspace);
        let _ = (graph.drag(0, &q[0]), Particles::mass(&graph, nodes - 1, &q[0]));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(512) })]

    /// Random bytes behind a valid beginning and before a valid checksum, so that they reach the decoder.
    #[test]
    fn random_headers_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let energies = file::section_of(Section::Energies, &[&[2], &bytes[..]].concat());
        let file = file::with_checksum(&[&b"LACT"[..], &[FORMAT_VERSION], &energies[..]].concat());
        let _ = parse(Aligned::new(&file).bytes());
    }

    /// Several bytes of a valid file changed and the checksum corrected: whatever loads can be evaluated.
    #[test]
    fn changes_under_a_right_checksum_never_panic(changes in prop::collection::vec((5usize..190, 0u8..12), 1..4)) {
        let file = file::golden_web();
        let mut body = file[..file.len() - 4].to_vec();
        for (position, value) in changes {
            body[position] = value;
        }
        let file = Aligned::new(&file::with_checksum(&body));
        evaluate(&file, "pair");
        evaluate(&file, "ring");
    }
}
