//! Description of graphs of particles in words.

use crate::graph::GraphArchitecture;
use crate::words::{Describe, layers};
use leastaction_core::energy::graph::{Drag, Kinetic, Potential, Separation};
use serde::Serialize;

/// Types of nodes and edges, and graphs of them.
#[derive(Serialize)]
pub struct GraphDescription {
    /// Number of coordinates of a node.
    dimension: usize,
    /// Node types.
    nodes: Vec<String>,
    /// Edge types.
    edges: Vec<String>,
    /// All graphs.
    graphs: Vec<GraphOf>,
    /// Name of the graph to which coordinates and cost refer.
    graph: String,
}

/// Name and size of a graph.
#[derive(Serialize)]
struct GraphOf {
    name: String,
    nodes: usize,
    edges: usize,
    rods: usize,
}

impl From<&GraphArchitecture> for GraphDescription {
    fn from(graph: &GraphArchitecture) -> Self {
        let shape = &graph.shape;
        let network = |network: u8| layers(shape.networks.get(network));
        let named = shape.nodes.iter().zip(&graph.node_types).map(|(kind, named)| {
            let number = |k: usize| named.numbers.get(k).map_or(f64::NAN, |number| number.value);
            let kinetic = match kind.kinetic {
                Kinetic::Mass => format!("mass {:.4} kg", number(0)),
                Kinetic::Network(n) => format!("kinetic energy {}", network(n)),
            };
            let field: Vec<_> = (0..graph.dimension()).map(|i| format!("{:.4}", number(2 + i))).collect();
            let field = format!("({}) N", field.join(", "));
            let potential = match kind.potential {
                Potential::None => "no potential".to_owned(),
                Potential::Uniform => format!("field {field}"),
                Potential::Network(n) => format!("field {field}, potential {}", network(n)),
            };
            let drag = match kind.drag {
                Drag::None => String::new(),
                Drag::Viscous => format!(", drag {:.4} N s/m", number(1)),
                Drag::Network(n) => format!(", drag {}", network(n)),
            };
            format!("{}: {kinetic}, {potential}{drag}", named.name)
        });
        let joined = shape.edges.iter().zip(&graph.edge_types).map(|(kind, named)| {
            let name = &named.name;
            let law: Vec<_> = named.numbers.iter().map(|number| format!("{:.4}", number.value)).collect();
            let seen = match kind.separation {
                Separation::Distance => "distance",
                Separation::Squared => "squared distance",
            };
            let potential = kind.potential.map_or("no potential".to_owned(), network);
            let embedding = kind.embedding.map_or(String::new(), |n| format!(", embedded by {}", network(n)));
            format!("{name}: of the {seen}, law ({}), {potential}{embedding}", law.join(", "))
        });
        let graphs = graph.graphs.iter().map(|graph| GraphOf {
            name: graph.name.clone(),
            nodes: graph.nodes.len(),
            edges: graph.edges.len(),
            rods: graph.rods.len(),
        });
        Self {
            dimension: graph.dimension(),
            nodes: named.collect(),
            edges: joined.collect(),
            graphs: graphs.collect(),
            graph: graph.graph().map_or(String::new(), |graph| graph.name.clone()),
        }
    }
}

impl Describe for GraphDescription {
    fn lines(&self) -> Vec<(&'static str, String)> {
        let lines = [("dimensions", self.dimension.to_string())].into_iter();
        let nodes = self.nodes.iter().map(|kind| ("node type", kind.clone()));
        let edges = self.edges.iter().map(|kind| ("edge type", kind.clone()));
        let graphs = self.graphs.iter().map(|graph| ("graph", graph.line()));
        lines.chain(nodes).chain(edges).chain(graphs).collect()
    }
}

impl GraphOf {
    fn line(&self) -> String {
        let Self { name, nodes, edges, rods } = self;
        format!("{name}: nodes {nodes}, edges {edges}, rods {rods}")
    }
}
