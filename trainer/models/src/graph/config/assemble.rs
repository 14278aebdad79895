//! Conversion of a configuration into the shape of a model.

use super::{EdgeConfig, EdgeTypeConfig, GraphConfig, LayoutConfig, NodeTypeConfig, RodConfig};
use crate::config::checks::{check_count, check_name, list};
use crate::config::parts::{Networks, NumberConfig, Range};
use crate::config::place::ShapeError;
use crate::config::problem::Problem;
use crate::family::Family;
use crate::graph::{GraphArchitecture, GraphType, NamedGraph};
use crate::limits::MAX_GRAPH_COORDINATES;
use crate::number::Number;
use leastaction_core::energy::graph::{
    Drag, EDGE_NUMBERS, Edge, EdgeShape, GraphShape, Kinetic, MAX_EDGE_TYPES, MAX_NETWORKS, MAX_NODE_TYPES,
    NodeShape, Potential,
};
use leastaction_core::model::{MAX_GRAPHS, ORIGIN, Rod};
use leastaction_core::network::Activation;

/// Key of the node types.
const NODE_TYPES: &str = "node_types";
/// Key of the edge types.
const EDGE_TYPES: &str = "edge_types";

impl GraphConfig {
    /// Returns the model with these types and graphs; its first graph is the one to be trained.
    ///
    /// # Errors
    /// [`ShapeError`]: what is invalid, and where.
    pub fn assemble(&self) -> Result<GraphArchitecture, ShapeError> {
        let mut networks = Networks::default();
        let dimension = self.dimension.into();
        let (node_shapes, node_types) =
            each_type(NODE_TYPES, &self.node_types, |kind| kind.assemble(dimension, &mut networks))?;
        let (edge_shapes, edge_types) =
            each_type(EDGE_TYPES, &self.edge_types, |kind| kind.assemble(&mut networks))?;
        check_count("node types", NODE_TYPES, node_types.len(), MAX_NODE_TYPES)?;
        check_count("edge types", EDGE_TYPES, edge_types.len(), MAX_EDGE_TYPES)?;
        check_count("networks of node and edge types", NODE_TYPES, networks.0.len(), MAX_NETWORKS)?;
        let shape = GraphShape::new(self.dimension, &networks.0, &node_shapes, &edge_shapes);
        // The counts are in range.
        let shape = shape.filter(|_| !node_types.is_empty()).ok_or_else(|| Problem::NoNodeTypes.at([]))?;
        let graphs = self.named_graphs()?;
        let architecture = GraphArchitecture { shape, node_types, edge_types, graphs, graph: 0 };
        check_size(&architecture)?;
        Ok(architecture)
    }

    /// Returns all graphs, the chosen one first.
    fn named_graphs(&self) -> Result<Vec<NamedGraph>, ShapeError> {
        check_count("graphs", "graphs", self.graphs.len(), MAX_GRAPHS)?;
        let named = self.graphs.iter().map(|(name, layout)| self.named_graph(name, layout));
        let mut graphs = named.collect::<Result<Vec<_>, _>>()?;
        let chosen = self.chosen().map_err(|problem| problem.at(["graph".into()]))?;
        graphs.swap(0, chosen);
        Ok(graphs)
    }

    /// Position of the graph that is trained.
    fn chosen(&self) -> Result<usize, Problem> {
        let known = || list(self.graphs.keys());
        match &self.graph {
            Some(name) => self
                .graphs
                .keys()
                .position(|known| known == name)
                .ok_or_else(|| Problem::UnknownGraph { name: name.clone(), known: known() }),
            None if self.graphs.is_empty() => Err(Problem::NoGraph),
            None if self.graphs.len() == 1 => Ok(0),
            None => Err(Problem::WhichGraph { known: known() }),
        }
    }

    fn named_graph(&self, name: &str, layout: &LayoutConfig) -> Result<NamedGraph, ShapeError> {
        let at = |problem: Problem| problem.at(["graphs".into(), name.into()]);
        check_name(name).map_err(at)?;
        if layout.nodes.is_empty() {
            return Err(at(Problem::EmptyGraph));
        }
        let count = layout.nodes.len();
        // The largest node number stands for the origin.
        if count > usize::from(ORIGIN) {
            let (what, most) = ("nodes in a graph", ORIGIN.into());
            return Err(at(Problem::TooMany { what, found: count, most }));
        }
        let node = |name: &String| position("node type", name, &self.node_types);
        let edge = |edge: &EdgeConfig| self.edge(edge, count);
        let rod = |config: &RodConfig| rod(config, count);
        Ok(NamedGraph {
            name: name.to_owned(),
            nodes: each((name, "nodes"), &layout.nodes, node)?,
            edges: each((name, "edges"), &layout.edges, edge)?,
            rods: each((name, "rods"), &layout.rods, rod)?,
        })
    }

    fn edge(&self, EdgeConfig { kind, between: [a, b] }: &EdgeConfig, nodes: usize) -> Result<Edge, Problem> {
        let kind = match kind {
            Some(name) => position("edge type", name, &self.edge_types)?,
            None if self.edge_types.len() == 1 => 0,
            None => return Err(Problem::WhichEdgeType),
        };
        check_ends(Some(*a), *b, nodes)?;
        Ok(Edge { kind, ends: [*a, *b] })
    }
}

/// A problem, and the key at which it occurs.
type Misfit = (&'static str, Problem);

/// Converts every entry of a list of a graph by `of`.
fn each<T, U>(
    (name, key): (&str, &str),
    list: &[T],
    of: impl Fn(&T) -> Result<U, Problem>,
) -> Result<Vec<U>, ShapeError> {
    let at = |i: usize, problem: Problem| problem.at(["graphs".into(), name.into(), key.into(), i.into()]);
    list.iter().enumerate().map(|(i, entry)| of(entry).map_err(|problem| at(i, problem))).collect()
}

/// Number of the type with that name.
fn position<T: Named>(what: &'static str, name: &str, kinds: &[T]) -> Result<u8, Problem> {
    let known = || list(kinds.iter().map(Named::name));
    let found = kinds.iter().position(|kind| kind.name() == name);
    // The cast is safe: a configuration with more types than the format can hold is refused.
    let found = found.map(|kind| kind as u8);
    found.ok_or_else(|| Problem::UnknownType { what, name: name.to_owned(), known: known() })
}

fn rod(RodConfig { from, to, length }: &RodConfig, nodes: usize) -> Result<Rod, Problem> {
    check_ends(*from, *to, nodes)?;
    let length = Range::ABOVE.number("length", *length, false)?.value as f32;
    Ok(Rod { from: *from, to: *to, length })
}

fn check_ends(from: Option<u16>, to: u16, nodes: usize) -> Result<(), Problem> {
    if let Some(node) = from.into_iter().chain([to]).find(|node| usize::from(*node) >= nodes) {
        return Err(Problem::NoNode { node, nodes });
    }
    if from == Some(to) { Err(Problem::Loop { node: to }) } else { Ok(()) }
}

/// A type with a name.
trait Named {
    fn name(&self) -> &str;
}

impl Named for NodeTypeConfig {
    fn name(&self) -> &str {
        &self.name
    }
}

impl Named for EdgeTypeConfig {
    fn name(&self) -> &str {
        &self.name
    }
}

/// Converts every type of a list by `of` into its shape and its numbers, and keeps its name.
fn each_type<T: Named, U>(
    key: &str,
    kinds: &[T],
    mut of: impl FnMut(&T) -> Result<(U, Vec<Number>), Misfit>,
) -> Result<(Vec<U>, Vec<GraphType>), ShapeError> {
    let (mut shapes, mut types) = (Vec::new(), Vec::new());
    for (i, kind) in kinds.iter().enumerate() {
        let at = |(of, problem): Misfit| problem.at([key.into(), i.into(), of.into()]);
        let name = kind.name().to_owned();
        check_name(&name).map_err(|problem| at(("name", problem)))?;
        if kinds.iter().take(i).any(|other| other.name() == name) {
            return Err(at(("name", Problem::Twice { name })));
        }
        let (shape, numbers) = of(kind).map_err(at)?;
        shapes.push(shape);
        types.push(GraphType { name, numbers });
    }
    Ok((shapes, types))
}

fn check_size(architecture: &GraphArchitecture) -> Result<(), ShapeError> {
    let found = architecture.n();
    if (1..=MAX_GRAPH_COORDINATES).contains(&found) {
        return Ok(());
    }
    let most = format!("1 to {MAX_GRAPH_COORDINATES}");
    let name = architecture.graphs.first().map_or("", |graph| graph.name.as_str());
    Err(Problem::Size { found, most }.at(["graphs".into(), name.into()]))
}

/// Returns the numbers at a key; if none are given, `default` as known numbers.
fn numbers(
    (key, range): (&'static str, Range),
    given: Option<(&[f64], bool)>,
    default: &[f64],
) -> Result<Vec<Number>, Misfit> {
    let (values, learned) = given.unwrap_or((default, false));
    let number = |value: &f64| range.number(key, *value, learned).map_err(|problem| (key, problem));
    values.iter().map(number).collect()
}

/// A single number as a list.
fn single(given: &Option<NumberConfig>) -> Option<(&[f64], bool)> {
    given.as_ref().map(|NumberConfig { value, learned }| (std::slice::from_ref(value), *learned))
}

impl NodeTypeConfig {
    fn assemble(
        &self,
        dimension: usize,
        networks: &mut Networks,
    ) -> Result<(NodeShape, Vec<Number>), Misfit> {
        let activation = self.activation.unwrap_or(Activation::Squareplus);
        let mut network = |widths: &[u16], inputs| networks.add(widths, (inputs, 1), activation);
        let potential = match (&self.potential, &self.field) {
            (Some(widths), _) => Potential::Network(network(widths, dimension)),
            (None, Some(_)) => Potential::Uniform,
            (None, None) => Potential::None,
        };
        let drag = match (&self.drag_network, self.drag) {
            (Some(widths), _) => Drag::Network(network(widths, 1)),
            (None, Some(_)) => Drag::Viscous,
            (None, None) => Drag::None,
        };
        let shape = NodeShape { kinetic: Kinetic::Mass, potential, drag };
        Ok((shape, self.numbers(dimension)?))
    }

    /// Mass, drag and field.
    fn numbers(&self, dimension: usize) -> Result<Vec<Number>, Misfit> {
        let field = self.field.as_ref().map(|NumberConfig { value, learned }| (value.as_slice(), *learned));
        if let Some((values, _)) = field.filter(|(values, _)| values.len() != dimension) {
            let (key, found, needed) = ("field", values.len(), dimension);
            return Err((key, Problem::Dimensions { key, found, needed }));
        }
        let mass = numbers(("mass", Range::ABOVE), single(&self.mass), &[1.0])?;
        let drag = numbers(("drag", Range::NOT_BELOW), single(&self.drag), &[0.0])?;
        let field = numbers(("field", Range::ANY), field, &vec![0.0; dimension])?;
        Ok([mass, drag, field].concat())
    }
}

impl EdgeTypeConfig {
    fn assemble(&self, networks: &mut Networks) -> Result<(EdgeShape, Vec<Number>), Misfit> {
        let activation = self.activation.unwrap_or(Activation::Squareplus);
        let potential = self.potential.as_ref().map(|widths| networks.add(widths, (1, 1), activation));
        let shape = EdgeShape { separation: self.sees.into(), potential, embedding: None };
        let law = self.law.as_ref().map(|NumberConfig { value, learned }| (value.as_slice(), *learned));
        Ok((shape, numbers(("law", Range::ANY), law, &[0.0; EDGE_NUMBERS])?))
    }
}
