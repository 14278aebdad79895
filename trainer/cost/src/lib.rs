//! Cost of a model on a chip, from its shape: multiply-adds, flash, RAM and stack.

mod bodies;
mod bytes;
mod corrections;
mod counted;
mod graph;
mod operations;
pub mod processor;

use bodies::{Evaluation, Where, multiply_adds};
use bytes::Bytes;
use corrections::CorrectionsCost;
use leastaction_core::discrete::{Galerkin, Midpoint, Path};
use leastaction_core::energy::NetworkShape;
use leastaction_core::energy::bodies::TreeBody;
use leastaction_core::energy::modular::{PairInput, TransformShape, TypeShape};
use leastaction_core::model::{Law, ModelError};
use leastaction_models::{
    AnyFamily, Architecture, Family as _, InertiaNetworkArchitecture, ModularArchitecture,
};
use serde::Serialize;

/// Work and memory of one evaluation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Work {
    /// Multiply-adds in the layers of networks, or in the energies of rigid bodies; activations, features, friction and
    /// small matrices are not included.
    pub multiply_adds: usize,
    /// Bytes of the arrays that are live on the stack at the same time; call frames and spilled registers are not
    /// included.
    pub stack_bytes: usize,
}

impl Work {
    /// The work of both evaluations, one after the other.
    fn before(self, other: Self) -> Self {
        Self {
            multiply_adds: self.multiply_adds + other.multiply_adds,
            stack_bytes: self.stack_bytes.max(other.stack_bytes),
        }
    }
}

/// Work and memory of a model on a 32-bit chip.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Cost {
    /// Bytes of the state that a program keeps between steps.
    pub state_bytes: usize,
    /// Bytes of the loaded model beside its weights, which stay in flash.
    pub handle_bytes: usize,
    /// One acceleration.
    pub acceleration: Work,
    /// One Newton iteration of a step of order 2, or the whole step; see `iterated`.
    pub step_order_2: Work,
    /// One Newton iteration of a step of order 4, or the whole step; see `iterated`.
    pub step_order_4: Work,
    /// Whether the steps are given as one Newton iteration, of which a step takes 2 to 3. Otherwise they are given as
    /// the whole step.
    pub iterated: bool,
}

/// The cost of models of this shape.
///
/// # Errors
/// [`ModelError::NoSuchGraph`] if there is no such graph, [`ModelError::OtherFamily`] for a family without operation counts.
pub fn cost(architecture: &Architecture) -> Result<Cost, ModelError> {
    if let Some(graph) = architecture.family.graph() {
        return graph::cost(graph);
    }
    let bytes = Bytes::of(architecture.n());
    let evaluations = match &architecture.family {
        AnyFamily::InertiaNetwork(inertia_network) => Evaluations::inertia_network(inertia_network, &bytes),
        AnyFamily::Modular(modular) => Evaluations::modular(modular, &bytes),
        AnyFamily::Bodies(bodies) => {
            Evaluations::bodies((Where::Plane, BODY), &bodies.bodies().collect::<Vec<_>>(), &bytes)
        }
        AnyFamily::Arm(arm) => {
            Evaluations::bodies((Where::Space, ARM_BODY), &arm.tree_bodies().collect::<Vec<_>>(), &bytes)
        }
        other => return Err(ModelError::OtherFamily { found: other.name() }),
    };
    let dry = if architecture.laws().contains(Law::Coulomb) { bytes.dry } else { 0 };
    let networks = CorrectionsCost::of(architecture);
    let evaluations = Evaluations {
        handle_bytes: evaluations.handle_bytes + dry + networks.handle_bytes,
        dynamics: evaluations.dynamics.before(networks.force),
        linearization: evaluations.linearization.before(networks.with_derivatives),
    };
    Ok(Cost {
        state_bytes: bytes.state,
        handle_bytes: evaluations.handle_bytes,
        acceleration: evaluations.dynamics,
        step_order_2: evaluations.newton::<Midpoint>(bytes.newton_order_2),
        step_order_4: evaluations.newton::<Galerkin>(bytes.newton_order_4),
        iterated: true,
    })
}

/// Cost of the evaluations of a Lagrangian, from which the solvers are composed.
struct Evaluations {
    handle_bytes: usize,
    dynamics: Work,
    /// All first and second derivatives but L_qq.
    linearization: Work,
}

impl Evaluations {
    /// The cost of an inertia network. A step takes a forward pass with N tangents, and so do the dynamics of up to two
    /// coordinates. For more coordinates, the dynamics take a forward pass with a single tangent and an adjoint.
    fn inertia_network(inertia_network: &InertiaNetworkArchitecture, bytes: &Bytes) -> Self {
        let n = inertia_network.n();
        let weights: usize = inertia_network.layers().iter().map(|(inputs, outputs)| inputs * outputs).sum();
        let widest = inertia_network.widths.iter().copied().max().map_or(0, usize::from);
        let depth = inertia_network.widths.len();
        // The units of a layer are written while those of the previous layer are read; the derivatives of the
        // activations are computed afterwards.
        let units = (2 * jet(n) + WORD) * widest;
        let linearization = Work { multiply_adds: (1 + n) * weights, stack_bytes: units + ends(n, n) };
        let dynamics = if n <= 2 {
            linearization
        } else {
            Work { multiply_adds: 3 * weights, stack_bytes: tape(1, 0, widest, depth) + ends(1, n) }
        };
        Self {
            // Two slices and a length per layer, the kinds of coordinates, the inertia, the damping.
            handle_bytes: (depth + 1) * LAYER + n.next_multiple_of(WORD) + bytes.damping + 5 * WORD,
            dynamics,
            linearization,
        }
    }

    /// The cost of a tree of elements. Positions take one pass per derivative of the transform. Potentials take a
    /// forward pass and an adjoint, each with as many tangents as the positions on which they depend have components.
    fn modular(modular: &ModularArchitecture, bytes: &Bytes) -> Self {
        let weights = NetworkWeights::of(modular);
        let multiply_adds = |derivatives: usize, element: usize, pair: usize| {
            (1 + derivatives) * weights.transforms
                + 2 * (1 + element) * weights.potentials
                + 2 * (1 + pair) * weights.pairs
        };
        let (widest, depth) = (weights.widest, weights.deepest);
        let arrays = 16 * WORD * modular.n();
        let networks = modular.types.len() * 3 + 1;
        let dynamics =
            Work { multiply_adds: multiply_adds(2, 0, 0), stack_bytes: tape(2, 0, widest, depth) + arrays };
        Self {
            handle_bytes: networks * (depth + 1) * LAYER + modular.n() * 5 * WORD + bytes.damping,
            dynamics,
            linearization: dynamics,
        }
    }

    /// The cost of rigid bodies, which have no layers. The arrays are the bodies in motion, and the sums over the
    /// bodies that each carries. An acceleration of up to two coordinates uses the evaluation of a step.
    fn bodies((place, numbers): (Where, usize), tree: &[TreeBody], bytes: &Bytes) -> Self {
        let n = tree.len();
        let stack_bytes = n * numbers * WORD + 3 * n * n * WORD;
        let work = |evaluation| Work { multiply_adds: multiply_adds(place, tree, evaluation), stack_bytes };
        let of_acceleration = if n <= 2 { Evaluation::Linearization } else { Evaluation::Dynamics };
        Self {
            handle_bytes: (n * JOINT).next_multiple_of(WORD) + bytes.damping + 2 * WORD,
            dynamics: work(of_acceleration),
            linearization: work(Evaluation::Linearization),
        }
    }

    /// The cost of a Newton iteration: one evaluation at every Gauss point gives the residual of the last update and
    /// the next update. `solver` is the size of the solver's own arrays in bytes.
    fn newton<P: Path>(&self, solver: usize) -> Work {
        let nodes = P::points::<f32>().as_ref().len();
        Work {
            multiply_adds: nodes * self.linearization.multiply_adds,
            stack_bytes: self.linearization.stack_bytes + solver,
        }
    }
}

/// Numbers of weights in one evaluation of all networks of a tree.
struct NetworkWeights {
    transforms: usize,
    potentials: usize,
    pairs: usize,
    widest: usize,
    deepest: usize,
}

impl NetworkWeights {
    fn of(modular: &ModularArchitecture) -> Self {
        let shape = &modular.shape;
        let weights = |network: u8| shape.networks.get(network).map_or(0, network_weights);
        let kinds: Vec<_> = modular.kinds().filter_map(|kind| shape.types.get(kind)).collect();
        let transform = |kind: &&TypeShape| match kind.transform {
            TransformShape::Network { position, velocity, .. } => {
                weights(position) + velocity.map_or(0, weights)
            }
            TransformShape::Rod | TransformShape::Slide | TransformShape::Free => 0,
        };
        let pairs = kinds.len() * kinds.len().saturating_sub(1) / 2;
        let passes = |input| match input {
            PairInput::Concat | PairInput::Difference => 2,
            PairInput::Distance | PairInput::InverseDistance => 1,
        };
        Self {
            transforms: kinds.iter().map(transform).sum(),
            potentials: kinds.iter().filter_map(|kind| kind.potential).map(weights).sum(),
            pairs: shape.pair.map_or(0, |pair| pairs * passes(pair.input) * weights(pair.network)),
            widest: shape.networks.iter().flat_map(|network| network.widths().0).max().unwrap_or(0),
            deepest: shape.networks.iter().map(|network| network.widths().1).max().unwrap_or(0),
        }
    }
}

fn network_weights(network: &NetworkShape) -> usize {
    let (widths, depth) = network.widths();
    let mut inputs = usize::from(network.inputs);
    let mut sum = 0;
    for width in widths.into_iter().take(depth).chain([network.outputs.into()]) {
        sum += inputs * width;
        inputs = width;
    }
    sum
}

/// Bytes of a number with `tangents` tangents.
const fn jet(tangents: usize) -> usize {
    (1 + tangents) * WORD
}

/// Bytes of the tape of a forward pass (units and derivatives) with `tangents` tangents, and of two layers of an
/// adjoint with `of_adjoint` tangents; every layer also stores its number of units.
fn tape(tangents: usize, of_adjoint: usize, widest: usize, depth: usize) -> usize {
    depth * (2 * jet(tangents) * widest + 2 * WORD) + 2 * (jet(of_adjoint) * widest + WORD)
}

/// Bytes of the inputs and outputs of a network of n coordinates.
fn ends(tangents: usize, n: usize) -> usize {
    4 * n * n * jet(tangents)
}

/// Numbers per planar body in motion: its own, those of its frame, of the sums over the bodies that it carries, and of
/// its rotor.
const BODY: usize = 9 + 9 + 7 + 3;
/// Numbers per body in space: frame, motion of its joint, sums over the bodies that it carries, inertia and momentum,
/// rotor.
const ARM_BODY: usize = 12 + 12 + 12 + 10 + 6 + 1;
/// Bytes of a joint and its parent.
const JOINT: usize = 3;
const WORD: usize = 4;
/// Bytes of a layer: two slices and a length.
const LAYER: usize = 5 * WORD;

#[cfg(test)]
mod tests {
    use super::*;
    use leastaction_core::discrete::State;
    use leastaction_core::energy::inertia_network::Coordinate;
    use leastaction_core::model::InertiaNetworkModel;
    use leastaction_core::network::Jet;

    fn cartpole(width: u16) -> Architecture {
        InertiaNetworkArchitecture::new(&[Coordinate::Translation, Coordinate::Angle], width).into()
    }

    #[test]
    fn the_cart_pole_of_the_paper_by_hand() {
        let cost = cost(&cartpole(24)).unwrap();
        let weights = 3 * 24 + 24 * 24 + 24 * 4;
        assert_eq!(cost.acceleration.multiply_adds, 3 * weights);
        // The equations of a step take one evaluation as for an acceleration per Gauss point.
        assert_eq!(cost.step_order_2.multiply_adds, 3 * weights);
        assert_eq!(cost.step_order_4.multiply_adds, 6 * weights);
    }

    #[test]
    fn an_arm_of_seven_joints_has_a_cost() {
        let arm = InertiaNetworkArchitecture::new(&[Coordinate::Angle; 7], 32);
        let weights = 14 * 32 + 32 * 32 + 32 * (13 * 7 + 1);
        let cost = cost(&arm.into()).unwrap();
        assert_eq!(cost.state_bytes, size_of::<State<f32, 7>>());
        assert_eq!(cost.acceleration.multiply_adds, 3 * weights);
        assert_eq!(cost.step_order_2.multiply_adds, 8 * weights);
    }

    #[test]
    fn the_units_of_a_step_are_those_of_the_compiled_sizes() {
        let units = size_of::<[[Jet<f32, 2>; 24]; 2]>();
        let stack = cost(&cartpole(24)).unwrap().step_order_2.stack_bytes;
        assert!((units..units + 1024).contains(&stack), "{stack}");
    }

    #[test]
    #[cfg(target_pointer_width = "64")]
    fn the_handle_is_about_half_of_that_on_a_64_bit_host() {
        let here = size_of::<InertiaNetworkModel<2, 24, 2>>() / 2;
        let there = cost(&cartpole(24)).unwrap().handle_bytes;
        assert!(there.abs_diff(here) <= 16, "{there} against {here}");
    }
}
