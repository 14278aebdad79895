//! The Lagrangian graph network (LGNN's authors' LGN): a graph network that gives the whole Lagrangian as one number.

use super::graph_network::{GraphSizes, InputsBar, Networks, Placed, Trace, Used, Values, Wiring, add};
use super::network_lagrangian::{NetworkLagrangian, ScalarNetwork, acceleration};
use super::{AccelerationModel, Follow, coordinates_fit};
use leastaction::architecture::{
    Constraint, Damping, Family, FamilySystem, HostScalar, NamedGraph, Visitor, random_layers,
};
use leastaction::evaluate::prediction::{Prediction, Truth};
use leastaction::training::{Accelerations, Objective, Samples};
use leastaction_core::forces::{System, Viscous};
use leastaction_core::model::ModelError;
use leastaction_core::network::Jet;
use leastaction_core::scalar::Scalar;

/// L_vv v̇ = L_q − L_vq v + Aᵀλ, A v̇ = −Ȧv, with L = N_L(Σ_i h′_i): what stands for the nodes of a [`Gns`](super::Gns) after the
/// messages, added up and read out to one number.
///
/// Sizes and inputs are those of LGNN's program; messages go along edges and along rods between two nodes. Nothing makes L_vv
/// positive definite, or regular: where it has no inverse there is no acceleration. The weights serve any graph, in the plane.
/// They start uniform with Glorot's variance.
#[derive(Clone, Debug, PartialEq)]
pub struct Lgn {
    sizes: GraphSizes,
    wiring: Wiring,
    graph: NamedGraph,
}

impl Lgn {
    /// On the nodes, edges and rods of a graph.
    ///
    /// # Errors
    /// [`ModelError::Shape`] for wider hidden layers than are compiled, other dimensions than 2, or where an edge ends at no node.
    pub fn new(sizes: GraphSizes, graph: NamedGraph) -> Result<Self, ModelError> {
        let sizes = sizes.checked()?;
        if sizes.dimension != 2 {
            return Err(ModelError::Shape { what: "dimensions", found: sizes.dimension, compiled: 2 });
        }
        let rods = graph.rods.iter().filter_map(|rod| Some([rod.from?, rod.to]));
        let wiring = Wiring::new(2, &graph, graph.edges.iter().map(|edge| edge.ends).chain(rods))?;
        Ok(Self { sizes, wiring, graph })
    }

    /// Numbers in the weight block, whatever the graph.
    pub fn parameters(&self) -> usize {
        self.sizes.parameters(1)
    }

    /// Writes v̇(q, v), m/s²; `None` where the weights are too few, the slices do not fit, or there is none.
    pub fn acceleration(&self, weights: &[f64], q: &[f64], v: &[f64], out: &mut [f64]) -> Option<()> {
        let network = self.network(weights).ok()?;
        let fits = [q.len(), v.len(), out.len()] == [self.wiring.coordinates(); 3];
        fits.then(|| acceleration(&network, &self.graph.constraints::<2>(), [q, v], out))?
    }

    fn network<'w>(&'w self, weights: &'w [f64]) -> Result<LgnNetwork<'w>, ModelError> {
        let short = ModelError::Shape { what: "weights", found: weights.len(), compiled: self.parameters() };
        let networks = Networks::take(self.sizes, 1, weights).ok_or(short)?;
        Ok(LgnNetwork { networks, wiring: &self.wiring })
    }
}

/// The networks on a graph, over a weight block.
pub struct LgnNetwork<'w> {
    networks: Networks<'w>,
    wiring: &'w Wiring,
}

/// What a forward pass leaves for the adjoint.
struct Pass<S, const T: usize> {
    messages: Trace<S, T>,
    lagrangian: Used<S, T>,
}

impl<'w> LgnNetwork<'w> {
    fn pass<S: Scalar<Weight = f64>, const T: usize>(&self, x: &[Jet<S, T>]) -> Pass<S, T> {
        let messages = self.networks.messages(self.wiring, x);
        let mut sum = Vec::new();
        for node in &messages.nodes {
            sum.resize(node.y.len(), Jet::zero());
            add(&mut sum, &node.y);
        }
        Pass { lagrangian: self.networks.read_out.used(sum), messages }
    }

    /// The adjoint of what nodes and edges see, by `back` through one use of a network.
    fn back<S: Scalar<Weight = f64>, const T: usize, const A: usize>(
        &self,
        Pass { messages, lagrangian }: &Pass<S, T>,
        mut back: impl FnMut(&Placed<'w>, &Used<S, T>, &[Jet<S, A>]) -> Values<S, A>,
    ) -> InputsBar<S, A> {
        let bar = back(&self.networks.read_out, lagrangian, &[Jet::constant(S::one())]);
        let all = std::iter::repeat_n(bar, self.wiring.nodes());
        self.networks.messages_adjoint(self.wiring, messages, all, back)
    }
}

impl ScalarNetwork for LgnNetwork<'_> {
    fn differentiate<S: Scalar<Weight = f64>, const T: usize>(&self, x: &[Jet<S, T>]) -> (S, Vec<Jet<S, T>>) {
        let pass = self.pass(x);
        let bar = self.back(&pass, |network, used, bar| network.adjoint(used, bar, |_, _, _, _| ()));
        let l = pass.lagrangian.y.first().map_or(S::zero(), |l| l.value);
        (l, self.wiring.adjoint(x, &bar))
    }

    /// Velocities reach the networks as they are, and between these all is linear, so that only the networks bend.
    fn bend<S: Scalar<Weight = f64>, const T: usize>(&self, x: &[Jet<S, T>]) -> [[S; T]; T] {
        let mut sum = [[S::zero(); T]; T];
        self.back(&self.pass(x), |network, used, bar| network.bend(used, bar, &mut sum));
        sum
    }

    fn slope_gradient<S: Scalar<Weight = f64>>(&self, x: &[Jet<S, 1>], mut row: impl FnMut(usize, S)) {
        self.back(&self.pass(x), |network, used, bar: &[Jet<S, 1>]| {
            network.adjoint(used, bar, |start, layer, x, bar| {
                layer.tangent_gradient(x, bar, |i, value| row(start + i, value));
            })
        });
    }
}

/// The shape as a family.
#[derive(Clone)]
struct Compiled(Lgn);

impl<const N: usize> Family<N> for Compiled {
    type Lagrangian<'w, S: HostScalar> = NetworkLagrangian<LgnNetwork<'w>>;
    type Forces<'w, S: HostScalar> = Damping<S, N>;

    fn system<'w, S: HostScalar>(
        &'w self,
        weights: &'w [f64],
    ) -> Result<FamilySystem<'w, Self, S, N>, ModelError> {
        let lagrangian = NetworkLagrangian(self.0.network(weights)?);
        Ok(System { lagrangian, forces: Damping::new(Viscous::none(), &[]) })
    }

    const DEFINITE: bool = false;

    fn constraints(&self, q: &[f64; N]) -> Vec<Constraint<N>> {
        self.0.graph.rods.iter().map(|rod| Constraint::of_rod(rod, q.as_chunks::<2>().0)).collect()
    }
}

macro_rules! compiled {
    ($($n:literal),*) => {
        /// Numbers of coordinates that can be trained on: those of LGNN's three pendulums and five springs, and 4.
        const SIZES: &[usize] = &[$($n),*];

        impl Lgn {
            fn dispatch<V: Visitor>(&self, visitor: V) -> Result<V::Output, ModelError> {
                match self.wiring.coordinates() {
                    $($n => Ok(visitor.visit::<_, $n>(&Compiled(self.clone()))),)*
                    found => {
                        let compiled = SIZES.iter().copied().max().unwrap_or(0);
                        Err(ModelError::Shape { what: "coordinates", found, compiled })
                    }
                }
            }
        }
    };
}

compiled!(4, 6, 10);

impl AccelerationModel for Lgn {
    fn initial_weights(&self, seed: u64) -> Vec<f64> {
        random_layers(self.sizes.layers(1), seed)
    }

    fn objective(&self, samples: Samples) -> Result<Box<dyn Objective>, ModelError> {
        coordinates_fit(&samples, self.wiring.coordinates())?;
        self.dispatch(Accelerations { parameters: self.parameters(), samples })
    }

    fn predict(&self, weights: &[f64], truth: &Truth, follow: Follow) -> Result<Prediction, ModelError> {
        self.network(weights)?;
        Ok(follow.compare(truth, |q, v, out| self.acceleration(weights, q, v, out)))
    }
}

#[cfg(test)]
mod tests;
