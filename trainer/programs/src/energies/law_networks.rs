//! Laws with networks beside a model: dissipation, and a potential that corrects the model's own.

use super::{Energies, Network, features};
use crate::builder::Builder;
use crate::function::Function;
use crate::operation::Node;
use leastaction_core::energy::inertia_network::{Coordinate, feature_count};
use leastaction_core::network::Activation;

/// Inputs of a law's network, among the coordinates of a model, and its hidden layers.
#[derive(Clone, Debug, PartialEq)]
pub struct LawNetwork {
    /// Kind of each coordinate as an input; `None` for a coordinate that is not an input, as is any beyond the end of
    /// the list.
    pub coordinates: Vec<Option<Coordinate>>,
    /// Numbers of units in the hidden layers.
    pub widths: Vec<usize>,
    /// Activation of the hidden layers.
    pub activation: Activation,
}

impl LawNetwork {
    /// Numbers of the coordinates that are inputs.
    fn seen(&self) -> Vec<usize> {
        (0..self.coordinates.len()).filter(|i| self.coordinates[*i].is_some()).collect()
    }

    /// Kinds of the coordinates whose positions are inputs; the rest count as cyclic.
    fn kinds(&self) -> Vec<Coordinate> {
        self.coordinates.iter().map(|kind| kind.unwrap_or(Coordinate::Cyclic)).collect()
    }

    fn network(&self, inputs: usize, outputs: usize, start: usize) -> Network {
        Network::of_widths(inputs, &self.widths, (outputs, self.activation), start)
    }
}

/// Dissipation −LLᵀv, see [`leastaction_core::forces::Dissipation`].
#[derive(Clone, Debug)]
struct Dissipation {
    seen: Vec<usize>,
    kinds: Vec<Coordinate>,
    /// Position of the first scale; the scales precede the network.
    start: usize,
    network: Network,
}

/// Potential V_c, see [`leastaction_core::forces::PotentialCorrection`].
#[derive(Clone, Debug)]
struct Potential {
    kinds: Vec<Coordinate>,
    network: Network,
}

/// A model with networks beside its energies and forces: Q = −L(q, v)Lᵀv and V + V_c(q). Its weight block is that of a
/// model file: the model's numbers; then, with a dissipation, the scale of every input velocity (m/s or rad/s) and the
/// network; then, with a potential, its network.
#[derive(Clone, Debug)]
pub struct WithNetworks<E> {
    model: E,
    dissipation: Option<Dissipation>,
    potential: Option<Potential>,
    parameters: usize,
}

impl Dissipation {
    fn new(law: &LawNetwork, start: usize) -> Self {
        let (seen, kinds) = (law.seen(), law.kinds());
        let m = seen.len();
        let network = law.network(feature_count(&kinds) + m, m * (m + 1) / 2, start + m);
        Self { seen, kinds, start, network }
    }

    fn force(&self, builder: &mut Builder, q: Node, v: Node) -> Node {
        let (n, m) = (builder.length(v), self.seen.len());
        let scales = builder.parameters(self.start, m);
        let inverse = builder.map(Function::Reciprocal, scales);
        let v = builder.gather(v, &self.seen);
        let scaled = builder.product(v, inverse);
        let positions = features(builder, &self.kinds, q);
        let inputs = builder.joined(&[positions, scaled]);
        let l = self.network.output(builder, inputs);
        let entries = || (0..m).flat_map(|i| (0..=i).map(move |j| (i, j)));
        let (rows, columns): (Vec<usize>, Vec<usize>) = entries().unzip();
        let y = transposed(builder, l, (&rows, &columns), (m, v));
        let work = transposed(builder, l, (&columns, &rows), (m, y));
        let force = builder.scatter(work, &self.seen, n);
        builder.scaled(-1.0, force)
    }
}

/// Vector of `m` entries with the sum of all l x\[from\] at every place `to`.
fn transposed(
    builder: &mut Builder,
    l: Node,
    (from, to): (&[usize], &[usize]),
    (m, x): (usize, Node),
) -> Node {
    let x = builder.gather(x, from);
    let products = builder.product(l, x);
    builder.scatter(products, to, m)
}

impl<E: Energies> WithNetworks<E> {
    fn with_dissipation(&self, builder: &mut Builder, force: Node, [q, v]: [Node; 2]) -> Node {
        let Some(law) = &self.dissipation else { return force };
        let dissipation = law.force(builder, q, v);
        builder.sum(force, dissipation)
    }

    /// Adds these laws; `None` if one of them has inputs that the model does not have, or no inputs at all.
    pub fn new(model: E, dissipation: Option<&LawNetwork>, potential: Option<&LawNetwork>) -> Option<Self> {
        let fits = |law: &LawNetwork| law.coordinates.len() <= model.n() && !law.seen().is_empty();
        let sees = potential.is_none_or(|law| feature_count(&law.kinds()) > 0);
        if !sees || !dissipation.into_iter().chain(potential).all(fits) {
            return None;
        }
        let dissipation = dissipation.map(|law| Dissipation::new(law, model.parameters()));
        let start = dissipation.as_ref().map_or(model.parameters(), |law| law.network.end());
        let potential = potential.map(|law| {
            let kinds = law.kinds();
            Potential { network: law.network(feature_count(&kinds), 1, start), kinds }
        });
        let parameters = potential.as_ref().map_or(start, |law| law.network.end());
        Some(Self { model, dissipation, potential, parameters })
    }
}

impl<E: Energies> Energies for WithNetworks<E> {
    fn n(&self) -> usize {
        self.model.n()
    }

    fn parameters(&self) -> usize {
        self.parameters
    }

    fn energies(&self, builder: &mut Builder, q: Node, v: Node) -> [Node; 2] {
        let [kinetic, potential] = self.model.energies(builder, q, v);
        let Some(law) = &self.potential else { return [kinetic, potential] };
        let seen = features(builder, &law.kinds, q);
        let correction = law.network.output(builder, seen);
        [kinetic, builder.sum(potential, correction)]
    }

    fn force(&self, builder: &mut Builder, q: Node, v: Node, tau: Node) -> Node {
        let force = self.model.force(builder, q, v, tau);
        self.with_dissipation(builder, force, [q, v])
    }

    fn single_valued(&self, builder: &mut Builder, q: Node, v: Node, tau: Node) -> Node {
        let force = self.model.single_valued(builder, q, v, tau);
        self.with_dissipation(builder, force, [q, v])
    }

    fn grips(&self, builder: &mut Builder, tau: Node) -> Option<[Node; 3]> {
        self.model.grips(builder, tau)
    }

    fn stops(&self, builder: &mut Builder) -> Option<[Node; 3]> {
        self.model.stops(builder)
    }

    fn bends(&self, builder: &mut Builder) -> Option<Node> {
        self.model.bends(builder)
    }
}
