//! Drives whose torque has a constant offset.

use super::Energies;
use crate::builder::Builder;
use crate::operation::Node;

/// A model whose drives add a constant to the logged torque, τ = u + o. Its weight block is that of the model, followed
/// by the offset o of every coordinate, N or N m. There may be unused numbers before and after the offsets.
#[derive(Clone, Debug)]
pub struct WithOffsets<E> {
    energies: E,
    /// Count of unused numbers between the model's numbers and the offsets, and after the offsets.
    beside: [usize; 2],
}

impl<E: Energies> WithOffsets<E> {
    /// Adds offsets directly after the weights of a model.
    pub fn new(energies: E) -> Self {
        Self { energies, beside: [0; 2] }
    }

    /// o and u + o.
    fn drive(&self, builder: &mut Builder, u: Node) -> [Node; 2] {
        let offset = builder.parameters(self.energies.parameters() + self.beside[0], self.energies.n());
        [offset, builder.sum(u, offset)]
    }

    /// Adds offsets with unused numbers between them and those of the model, and after the offsets.
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
        let [offset, tau] = self.drive(builder, u);
        let force = self.energies.force(builder, q, v, tau);
        builder.sum(force, offset)
    }

    fn single_valued(&self, builder: &mut Builder, q: Node, v: Node, u: Node) -> Node {
        let [offset, tau] = self.drive(builder, u);
        let force = self.energies.single_valued(builder, q, v, tau);
        builder.sum(force, offset)
    }

    fn grips(&self, builder: &mut Builder, u: Node) -> Option<[Node; 3]> {
        let [_, tau] = self.drive(builder, u);
        self.energies.grips(builder, tau)
    }

    fn stops(&self, builder: &mut Builder) -> Option<[Node; 3]> {
        self.energies.stops(builder)
    }

    fn bends(&self, builder: &mut Builder) -> Option<Node> {
        self.energies.bends(builder)
    }
}
