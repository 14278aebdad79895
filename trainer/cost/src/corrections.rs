//! Cost of laws of force with networks.

use super::{LAYER, WORD, Work, jet, network_weights, tape};
use leastaction_core::energy::NetworkShape;
use leastaction_core::model::Law;
use leastaction_models::Architecture;

/// Cost of the networks that correct a model.
pub(super) struct CorrectionsCost {
    pub handle_bytes: usize,
    /// Evaluation of their force.
    pub force: Work,
    /// Evaluation of their force, followed by one of the force with its derivatives.
    pub with_derivatives: Work,
}

impl CorrectionsCost {
    pub fn of(architecture: &Architecture) -> Self {
        let mut all = Self { handle_bytes: 0, force: NONE, with_derivatives: NONE };
        for law in [Law::Dissipation, Law::Potential] {
            let shape = architecture.laws().network(law).and_then(|network| network.network(law).ok());
            if let Some(shape) = shape {
                all.add(law, &shape, architecture.n());
            }
        }
        all
    }

    /// Adds a network. A dissipation takes a forward pass, and for derivatives one pass with n tangents each for
    /// positions and velocities. A potential takes a forward pass and an adjoint, and for second derivatives a forward
    /// pass with n tangents.
    fn add(&mut self, law: Law, shape: &NetworkShape, n: usize) {
        let (weights, (widths, depth)) = (network_weights(shape), shape.widths());
        let widest = widths.into_iter().max().unwrap_or(0);
        let ends = |tangents: usize| (usize::from(shape.inputs) + usize::from(shape.outputs)) * jet(tangents);
        let (force, derivatives, stacks) = if law == Law::Dissipation {
            let units = |tangents: usize| jet(tangents) * widest * depth + ends(tangents);
            (weights, 2 * (1 + n) * weights, [units(0), units(n)])
        } else {
            let units = |tangents: usize| tape(tangents, 0, widest, depth) + ends(tangents);
            (2 * weights, (2 + n) * weights, [units(0), units(n)])
        };
        self.handle_bytes += (2 * n).next_multiple_of(WORD) + (depth + 1) * LAYER + 4 * WORD;
        self.force = self.force.before(Work { multiply_adds: force, stack_bytes: stacks[0] });
        let both = Work { multiply_adds: force + derivatives, stack_bytes: stacks[1] };
        self.with_derivatives = self.with_derivatives.before(both);
    }
}

const NONE: Work = Work { multiply_adds: 0, stack_bytes: 0 };
