//! Energy of an edge: the separation of its ends, and a potential that depends on it.

use super::GraphEnergies;
use crate::builder::Builder;
use crate::function::Function;
use crate::operation::Node;
use leastaction_core::energy::graph::{Edge, EdgeShape, GraphShape, Separation};

/// Edges of one type.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct EdgeGroup {
    kind: usize,
    pub shape: EdgeShape,
    /// Positions of these edges in the list of all edges.
    pub places: Vec<usize>,
    ends: Vec<[usize; 2]>,
}

impl EdgeGroup {
    /// Returns the groups of all types that have edges.
    pub fn all(shape: &GraphShape, edges: &[Edge]) -> Vec<Self> {
        let groups = shape.edges.iter().enumerate().map(|(kind, shape)| {
            let of_kind = |place: &usize| usize::from(edges[*place].kind) == kind;
            let places: Vec<usize> = (0..edges.len()).filter(of_kind).collect();
            let ends = places.iter().map(|place| edges[*place].ends.map(usize::from)).collect();
            Self { kind, shape: *shape, places, ends }
        });
        groups.filter(|group| !group.places.is_empty()).collect()
    }
}

impl GraphEnergies {
    /// Separations z of all edges, group by group: r = |x_a − x_b|, m, or r², m².
    pub(super) fn separations(&self, builder: &mut Builder, q: Node) -> Vec<Node> {
        let minus = builder.scaled(-1.0, q);
        let mut separations = Vec::new();
        for group in &self.edges {
            let [a, b] = [0, 1].map(|end| self.coordinates(group.ends.iter().map(|ends| ends[end])));
            let (first, second) = (builder.gather(q, &a), builder.gather(minus, &b));
            let difference = builder.sum(first, second);
            let squares = builder.column_products(difference, difference, group.ends.len());
            separations.push(match group.shape.separation {
                Separation::Squared => squares,
                Separation::Distance => builder.map(Function::SquareRoot, squares),
            });
        }
        separations
    }

    /// Sum Σ U = Σ c₁z + c₂z² + net(z).
    pub(super) fn pairs(&self, builder: &mut Builder, group: &EdgeGroup, z: Node) -> Node {
        let sums = [builder.total(z), builder.dot(z, z)];
        let sums = builder.joined(&sums);
        let law = self.numbers.law(builder, group.kind);
        let quadratic = builder.dot(law, sums);
        let Some(network) = group.shape.potential else { return quadratic };
        let own = self.total(builder, network, group.ends.len(), z);
        builder.sum(quadratic, own)
    }
}
