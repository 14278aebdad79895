//! Drives whose torque is off by a constant.

use super::Energies;
use crate::builder::{Builder, Node};

/// A model whose drives add a constant to the logged torque, τ = u + o. Its weight block is that of the model, then o of every
/// coordinate, N or N m.
#[derive(Clone, Debug)]
pub struct WithOffsets<E>(pub E);

impl<E: Energies> Energies for WithOffsets<E> {
    fn n(&self) -> usize {
        self.0.n()
    }

    fn parameters(&self) -> usize {
        self.0.parameters() + self.n()
    }

    fn energies(&self, builder: &mut Builder, q: Node, v: Node) -> [Node; 2] {
        self.0.energies(builder, q, v)
    }

    fn force(&self, builder: &mut Builder, q: Node, v: Node, u: Node) -> Node {
        let offset = builder.parameters(self.0.parameters(), self.n());
        let tau = builder.sum(u, offset);
        let force = self.0.force(builder, q, v, tau);
        builder.sum(force, offset)
    }

    fn bends(&self, builder: &mut Builder) -> Option<Node> {
        self.0.bends(builder)
    }
}
