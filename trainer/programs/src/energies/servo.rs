//! Position servos: commands are positions.

use super::Energies;
use crate::builder::Builder;
use crate::operation::Node;

/// A model whose commands are positions, τ + Q = k (τ − q) + the model's own forces, see [`leastaction_core::forces::Servo`]. k ≥ 0 of
/// each group (N/m or N m/rad) follows the model's numbers in the weight block.
#[derive(Clone, Debug)]
pub struct WithServo<E> {
    model: E,
    groups: usize,
    of: Vec<usize>,
}

impl<E: Energies> WithServo<E> {
    /// Gives coordinate i the stiffness of group `of[i]`, out of `groups` groups; `None` if the number of coordinates differs or a group
    /// does not exist.
    pub fn new(model: E, groups: usize, of: Vec<usize>) -> Option<Self> {
        let fits = of.len() == model.n() && of.iter().all(|group| *group < groups);
        fits.then_some(Self { model, groups, of })
    }
}

impl<E: Energies> Energies for WithServo<E> {
    fn n(&self) -> usize {
        self.model.n()
    }

    fn parameters(&self) -> usize {
        self.model.parameters() + self.groups
    }

    fn energies(&self, builder: &mut Builder, q: Node, v: Node) -> [Node; 2] {
        self.model.energies(builder, q, v)
    }

    fn force(&self, builder: &mut Builder, q: Node, v: Node, tau: Node) -> Node {
        let own = self.model.force(builder, q, v, tau);
        let all = builder.parameters(self.model.parameters(), self.groups);
        let stiffness = builder.gather(all, &self.of);
        let away = builder.difference(tau, q);
        let drive = builder.product(stiffness, away);
        let beside_tau = builder.difference(drive, tau);
        builder.sum(own, beside_tau)
    }

    fn bends(&self, builder: &mut Builder) -> Option<Node> {
        self.model.bends(builder)
    }
}
