//! Terms of one node: kinetic energy, potential, drag.

use super::{GraphEnergies, embedded};
use crate::builder::Builder;
use crate::function::Function;
use crate::operation::Node;
use leastaction_core::energy::graph::{Drag, GraphShape, Kinetic, NodeShape, Potential};

/// Nodes of one type.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct NodeGroup {
    kind: usize,
    shape: NodeShape,
    nodes: Vec<usize>,
}

impl NodeGroup {
    /// Returns the groups of all types that have nodes.
    pub fn all(shape: &GraphShape, kinds: &[u8]) -> Vec<Self> {
        let groups = shape.nodes.iter().enumerate().map(|(kind, shape)| {
            let nodes = (0..kinds.len()).filter(|node| usize::from(kinds[*node]) == kind).collect();
            Self { kind, shape: *shape, nodes }
        });
        groups.filter(|group| !group.nodes.is_empty()).collect()
    }
}

impl GraphEnergies {
    /// Part of a vector of all coordinates that belongs to the group, node after node.
    fn own(&self, builder: &mut Builder, group: &NodeGroup, x: Node) -> Node {
        let coordinates = self.coordinates(group.nodes.iter().copied());
        builder.gather(x, &coordinates)
    }

    /// Sum Σ T: ½m|v|², or net(k ‖ |v|²) with the kinetic embedding k.
    pub(super) fn kinetic(&self, builder: &mut Builder, group: &NodeGroup, v: Node) -> Node {
        let v = self.own(builder, group, v);
        match group.shape.kinetic {
            Kinetic::Mass => {
                let mass = self.numbers.mass(builder, group.kind);
                let square = builder.dot(v, v);
                let twice = builder.product(mass, square);
                builder.scaled(0.5, twice)
            }
            Kinetic::Network(network) => {
                let count = group.nodes.len();
                let squares = builder.column_products(v, v, count);
                let embedding = self.numbers.kinetic_embedding(builder, group.kind);
                let y = embedded(builder, self.network(network), embedding, (count, squares));
                builder.total(y)
            }
        }
    }

    /// Sum Σ V: 0, g·x, or g·x + net(h ‖ x) with the embedding h.
    pub(super) fn potential(&self, builder: &mut Builder, group: &NodeGroup, q: Node) -> Node {
        let x = self.own(builder, group, q);
        match group.shape.potential {
            Potential::None => builder.zeros(1),
            Potential::Uniform => self.uniform(builder, group, x),
            Potential::Network(network) => {
                let uniform = self.uniform(builder, group, x);
                let embedding = self.numbers.embedding(builder, group.kind);
                let count = group.nodes.len();
                let y = embedded(builder, self.network(network), embedding, (count, x));
                let own = builder.total(y);
                builder.sum(uniform, own)
            }
        }
    }

    /// Sum Σ g·x.
    fn uniform(&self, builder: &mut Builder, group: &NodeGroup, x: Node) -> Node {
        let d = self.dimension;
        let axes: Vec<usize> = (0..builder.length(x)).map(|i| i % d).collect();
        let sum = builder.scatter(x, &axes, d);
        let field = self.numbers.field(builder, group.kind);
        builder.dot(field, sum)
    }

    /// Force Q on all coordinates, N: 0, −cv, or −(c + |net(v_i)|)v_i component by component; it is 0 outside the
    /// group.
    pub(super) fn drag(&self, builder: &mut Builder, group: &NodeGroup, v: Node) -> Node {
        let (n, coordinates) = (builder.length(v), self.coordinates(group.nodes.iter().copied()));
        let own = builder.gather(v, &coordinates);
        let count = coordinates.len();
        let correction = match group.shape.drag {
            Drag::None => return builder.zeros(n),
            Drag::Viscous => builder.zeros(count),
            Drag::Network(network) => {
                let y = self.network(network).outputs(builder, count, own);
                builder.map(Function::Magnitude, y)
            }
        };
        let viscous = self.numbers.viscous(builder, group.kind);
        let viscous = builder.repeated(viscous, count);
        let coefficients = builder.sum(viscous, correction);
        let drag = builder.product(coefficients, own);
        let drag = builder.scaled(-1.0, drag);
        builder.scatter(drag, &coordinates, n)
    }
}
