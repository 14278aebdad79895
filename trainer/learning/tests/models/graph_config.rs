//! Configurations of graphs of particles: their meaning, and their errors with file, line and key.

use leastaction_core::energy::graph::{Drag, Edge, Potential, Separation};
use leastaction_core::model::Rod;
use leastaction_core::network::Activation;
use leastaction_learning::config::{Config, ConfigError};
use leastaction_models::config::{FamilyConfig, GraphConfig};
use leastaction_models::{GraphArchitecture, Number};
use std::path::Path;

fn parse(text: &str) -> Result<Config, ConfigError> {
    Config::parse(text, Path::new("c.toml"))
}

/// A configuration whose first four lines are the two of `[data]` and the two of `[model]` that name the family.
fn graph(rest: &str) -> String {
    format!("[data]\nfile = \"data.npz\"\n[model]\nfamily = \"graph\"\n{rest}\n")
}

fn architecture(text: &str) -> GraphArchitecture {
    parse(text).unwrap().beginning().unwrap().0.family.graph().unwrap().clone()
}

fn error(text: &str) -> String {
    parse(text).unwrap_err().to_string()
}

const BOB: &str = "[[model.node_types]]\nname = \"bob\"\n";
const SPRING: &str = "[[model.edge_types]]\nname = \"spring\"\n";
const TWO: &str = "[model.graphs.two]\nnodes = [\"bob\", \"bob\"]\n";

fn edge(kind: u8, ends: [u16; 2]) -> Edge {
    Edge { kind, ends }
}

#[test]
fn printed_defaults_are_the_defaults() {
    let least = graph(&format!(
        "graph = \"three\"\n{BOB}field = {{ learn = [0, 0] }}\npotential = [8]\n\
         {SPRING}law = {{ learn = [0, 0] }}\npotential = [16]\n\
         [model.graphs.three]\nnodes = [\"bob\", \"bob\", \"bob\"]\nedges = [[0, 1], [1, 2]]\n\
         [model.graphs.ring]\nnodes = [\"bob\", \"bob\", \"bob\", \"bob\"]\nedges = [[0, 1], [1, 2], [2, 3], [3, 0]]"
    ));
    assert_eq!(architecture(GraphConfig::defaults()), architecture(&least));
}

#[test]
fn printed_keys_that_are_off_can_be_switched_on() {
    let is_key = |line: &str| line.split(" = ").next().is_some_and(|key| !key.contains(' '));
    let on: Vec<_> = GraphConfig::defaults()
        .lines()
        .map(|line| {
            line.strip_prefix("# ").filter(|rest| rest.contains(" = ") && is_key(rest)).unwrap_or(line)
        })
        .collect();
    let on = architecture(&on.join("\n"));
    assert_eq!(on.graphs[0].rods, [Rod { from: None, to: 0, length: 1.0 }]);
    assert_eq!(on.shape.nodes.iter().next().unwrap().drag, Drag::Network(1));
}

#[test]
fn every_key_is_explained() {
    let all = graph(&format!(
        "dimension = 3\ngraph = \"two\"\n{BOB}mass = 2\nfield = [0, 0, 1]\npotential = [3]\ndrag = 0.1\n\
         drag_network = [2]\nactivation = \"isru\"\n{SPRING}sees = \"squared\"\nlaw = [1, 2]\npotential = [3]\n\
         activation = \"isru\"\n{TWO}edges = [[0, 1]]\nrods = [{{ from = 0, to = 1, length = 1 }}]"
    ));
    let config = parse(&all).unwrap();
    assert_eq!(parse(&config.to_toml()).unwrap(), config);
    let table: toml::Table = toml::from_str(&config.to_toml()).unwrap();
    let model = table["model"].as_table().unwrap();
    let parts = ["node_types", "edge_types"].map(|key| model[key].as_array().unwrap()[0].as_table().unwrap());
    let layout = model["graphs"]["two"].as_table().unwrap();
    for key in parts.iter().flat_map(|part| part.keys()).chain(layout.keys()).chain(model.keys()) {
        let known = [format!("{key} = "), format!("[[model.{key}]]"), format!("[model.{key}.")];
        assert!(known.iter().any(|text| GraphConfig::defaults().contains(text)), "{key}");
    }
}

#[test]
fn types_have_their_networks_and_numbers() {
    let text = graph(&format!(
        "graph = \"b\"\n{BOB}mass = {{ learn = 2 }}\nfield = {{ learn = [0.5, 9.8] }}\npotential = [5, 4]\ndrag = 0.1\n\
         [[model.node_types]]\nname = \"free\"\ndrag_network = [3]\nactivation = \"tanh\"\n\
         {SPRING}sees = \"squared\"\nlaw = [1, -2]\n\
         [[model.edge_types]]\nname = \"bond\"\nlaw = {{ learn = [0, 3] }}\npotential = []\n\
         [model.graphs.a]\nnodes = [\"free\"]\n\
         [model.graphs.b]\nnodes = [\"free\", \"bob\"]\n\
         edges = [{{ type = \"bond\", between = [1, 0] }}, {{ type = \"spring\", between = [0, 1] }}]\n\
         rods = [{{ from = \"origin\", to = 1, length = 0.5 }}, {{ from = 1, to = 0, length = 2 }}]"
    ));
    let model = architecture(&text);
    let names: Vec<_> = model.graphs.iter().map(|graph| graph.name.as_str()).collect();
    assert_eq!(names, ["b", "a"]);
    let layout = &model.graphs[0];
    assert_eq!(
        (&layout.nodes[..], &layout.edges[..]),
        (&[1, 0][..], &[edge(1, [1, 0]), edge(0, [0, 1])][..])
    );
    let rods = [Rod { from: None, to: 1, length: 0.5 }, Rod { from: Some(1), to: 0, length: 2.0 }];
    assert_eq!(layout.rods, rods);
    let (known, learned) = (Number::known, Number::learned);
    assert_eq!(model.node_types[0].numbers, [learned(2.0), known(0.1), learned(0.5), learned(9.8)]);
    assert_eq!(model.node_types[1].numbers, [1.0, 0.0, 0.0, 0.0].map(known));
    assert_eq!(model.edge_types[0].numbers, [1.0, -2.0].map(known));
    assert_eq!(model.edge_types[1].numbers, [0.0, 3.0].map(learned));
    let nodes: Vec<_> = model.shape.nodes.iter().map(|node| (node.potential, node.drag)).collect();
    assert_eq!(nodes, [(Potential::Network(0), Drag::Viscous), (Potential::None, Drag::Network(1))]);
    let edges: Vec<_> = model.shape.edges.iter().map(|edge| (edge.separation, edge.potential)).collect();
    assert_eq!(edges, [(Separation::Squared, None), (Separation::Distance, Some(2))]);
    let networks: Vec<_> =
        model.shape.networks.iter().map(|n| (n.inputs, n.widths().0[0], n.outputs, n.activation)).collect();
    let squareplus = Activation::Squareplus;
    assert_eq!(networks, [(2, 5, 1, squareplus), (1, 3, 1, Activation::Tanh), (1, 0, 1, squareplus)]);
}

/// Refused text after [`graph`]'s lines, line of the error, and words of its message.
type Refusal<'a> = (String, usize, &'a [&'a str]);

#[track_caller]
fn assert_refused(cases: &[Refusal]) {
    for (text, line, words) in cases {
        let message = error(&graph(text));
        assert!(message.starts_with(&format!("c.toml:{line}: ")), "line {line}: {message}");
        for word in *words {
            assert!(message.contains(word), "{word:?} is not in {message}");
        }
    }
}

#[test]
fn graphs_that_cannot_be_are_refused_with_line_and_key() {
    let two = |rest: &str| format!("{BOB}{SPRING}{TWO}{rest}");
    let sheet = "[[model.edge_types]]\nname = \"sheet\"\n";
    assert_refused(&[
        (TWO.to_owned(), 3, &["no node types", "[[model.node_types]]"]),
        (BOB.to_owned(), 3, &["no graph", "[model.graphs.three]"]),
        (format!("{BOB}[model.graphs.a]\nnodes = [\"bop\"]"), 8, &["no node type is called \"bop\"", "bob"]),
        (format!("{BOB}[model.graphs.a]\nnodes = []"), 7, &["at least one node"]),
        (format!("{BOB}{TWO}[model.graphs.three]\nnodes = [\"bob\"]"), 3, &["which graph", "three, two"]),
        (format!("graph = \"twoo\"\n{BOB}{TWO}"), 5, &["no graph is called \"twoo\"", "two"]),
        (two("edges = [[0, 1],\n [1, 2]]"), 12, &["no node 2", "has 2"]),
        (two("edges = [[1, 1]]"), 11, &["node 1 to itself"]),
        (two("edges = [[0]]"), 11, &["invalid length 1"]),
        (
            two("edges = [{ type = \"sprin\", between = [0, 1] }]"),
            11,
            &["no edge type", "\"sprin\"", "spring"],
        ),
        (two("edges = [{ tipe = \"spring\", between = [0, 1] }]"), 11, &["did you mean `type`?"]),
        (format!("{BOB}{SPRING}{sheet}{TWO}edges = [[0, 1]]"), 13, &["of which type", "between"]),
        (format!("{BOB}{TWO}edges = [[0, 1]]"), 9, &["of which type"]),
        (two("rods = [{ from = 2, to = 1, length = 1 }]"), 11, &["no node 2"]),
        (two("rods = [{ from = \"orign\", to = 1, length = 1 }]"), 11, &["\"origin\""]),
        (two("rods = [{ from = 0, to = 1, length = -1 }]"), 11, &["`length` is -1", "above 0"]),
        (two("rods = [{ from = 0, to = 0, length = 1 }]"), 11, &["itself"]),
        (two("rodes = []"), 11, &["did you mean `rods`?"]),
    ]);
}

#[test]
fn types_that_cannot_be_are_refused_with_line_and_key() {
    let bob = |rest: &str| format!("{BOB}{rest}\n{TWO}");
    let spring = |rest: &str| format!("{BOB}{SPRING}{rest}\n{TWO}");
    assert_refused(&[
        (format!("dimension = 4\n{BOB}{TWO}"), 5, &["2 or 3"]),
        (bob("mass = 0"), 7, &["`mass` is 0", "above 0"]),
        (bob("mass = { lern = 1.0 }"), 7, &["did you mean `learn`?"]),
        (bob("mass = [1.0]"), 7, &["{ learn = 1.0 }"]),
        (bob("drag = -0.1"), 7, &["`drag` is -0.1", "0 or above"]),
        (bob("field = [0.0, 0.0, 9.8]"), 7, &["`field` has 3 numbers", "must have 2"]),
        (bob("field = 9.8"), 7, &["[0.0, 9.8]"]),
        (bob("field = [0.0, inf]"), 7, &["`field` is inf", "finite"]),
        (bob("potential = [65]"), 7, &["1 to 64 units"]),
        (bob("masss = 1"), 7, &["did you mean `mass`?"]),
        (format!("{BOB}{BOB}{TWO}"), 8, &["another type \"bob\""]),
        (format!("[[model.node_types]]\nname = \"a,b\"\n{TWO}"), 6, &["comma"]),
        (spring("sees = \"distence\""), 9, &["did you mean `distance`?"]),
        (spring("law = [1.0]"), 9, &["two numbers"]),
        (spring("law = { learn = [nan, 1.0] }"), 9, &["`law` is NaN"]),
    ]);
}

#[test]
fn more_than_a_model_holds_is_refused() {
    let many = |count: usize, kind: &str, rest: &str| -> String {
        (0..count).map(|i| format!("[[model.{kind}_types]]\nname = \"{i}\"\n{rest}\n")).collect()
    };
    let nine: String = (0..9).map(|i| format!("[model.graphs.g{i}]\nnodes = [\"bob\"]\n")).collect();
    let many_nodes = format!("[model.graphs.many]\nnodes = [{}]", vec!["\"bob\""; 97].join(", "));
    assert_refused(&[
        (format!("{}{TWO}", many(7, "node", "")), 5, &["7 node types", "at most 6"]),
        (format!("{BOB}{}{TWO}", many(7, "edge", "")), 7, &["7 edge types", "at most 6"]),
        (
            format!(
                "{}{}{TWO}",
                many(6, "node", "potential = [1]\ndrag_network = [1]"),
                many(1, "edge", "potential = [1]")
            ),
            5,
            &["13 networks", "at most 12"],
        ),
        (format!("graph = \"g0\"\n{BOB}{nine}"), 8, &["9 graphs", "at most 8"]),
        (format!("{BOB}{many_nodes}"), 7, &["194 coordinates", "1 to 192"]),
    ]);
}

#[test]
fn networks_beside_learned_laws_begin_small() {
    let last = |text: &str| {
        let (architecture, weights) = parse(text).unwrap().beginning().unwrap();
        let networks =
            architecture.family.graph().unwrap().shape.networks.iter().filter_map(|n| n.parameters());
        let end: usize = networks.sum();
        weights[end - 4..end - 1].iter().fold(0.0, |most: f64, w| most.max(w.abs()))
    };
    let alone = graph(&format!("{BOB}potential = [3]\n{TWO}"));
    let beside = graph(&format!("{BOB}potential = [3]\nfield = {{ learn = [0, 0] }}\n{TWO}"));
    assert!((last(&beside) / last(&alone) - 1e-3).abs() < 1e-12);
    assert!(last(&alone) > 0.1);
}
