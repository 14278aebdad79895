//! Drives whose torque is off by a constant.

use super::Energies;
use crate::builder::{Builder, Node};

/// A model whose drives add a constant to the logged torque, τ = u + o. Its weight block is that of the model, then o of every
/// coordinate, N or N m, with other numbers around them where there are such.
#[derive(Clone, Debug)]
pub struct WithOffsets<E> {
    energies: E,
    /// Numbers between those of the model and the offsets, and behind these.
    beside: [usize; 2],
}

impl<E: Energies> WithOffsets<E> {
    /// Offsets right behind the weights of a model.
    pub fn new(energies: E) -> Self {
        Self { energies, beside: [0; 2] }
    }

    /// The same with so many numbers between those of the model and the offsets, and behind these, that nothing depends on.
    #[must_use]
    pub fn among(self, beside: [usize; 2]) -> Self {
        Self { beside, ..self }
    }
}

impl<E: Energies> Energies for WithOffsets<E> {
    fn n(&self) -> usize {
        self.energies.n()
    }

    fn parameters(&self) -> usize {
        self.energies.parameters() + self.n() + self.beside.iter().sum::<usize>()
    }

    fn energies(&self, builder: &mut Builder, q: Node, v: Node) -> [Node; 2] {
        self.energies.energies(builder, q, v)
    }

    fn force(&self, builder: &mut Builder, q: Node, v: Node, u: Node) -> Node {
        let offset = builder.parameters(self.energies.parameters() + self.beside[0], self.n());
        let tau = builder.sum(u, offset);
        let force = self.energies.force(builder, q, v, tau);
        builder.sum(force, offset)
    }

    fn bends(&self, builder: &mut Builder) -> Option<Node> {
        self.energies.bends(builder)
    }
}
