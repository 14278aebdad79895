use super::{Energies, Network, features};
use crate::builder::Builder;
use crate::function::Function;
use crate::operation::Node;
use leastaction_core::energy::inertia_network::{Coordinate, Inertia};
use leastaction_core::network::Activation;

/// Inertia matrix and potential of a mechanism from a single network, with viscous damping of every coordinate if
/// damping is learned ([`leastaction_core::energy::inertia_network`]).
#[derive(Clone, Debug, PartialEq)]
pub struct InertiaNetworkEnergies {
    coordinates: Vec<Coordinate>,
    inertia: Inertia,
    network: Network,
    damped: bool,
}

impl InertiaNetworkEnergies {
    /// Creates the model of this shape: the network's numbers, then the damping coefficients, N s/m or N m s.
    pub fn new(
        coordinates: Vec<Coordinate>,
        (widths, activation): (&[usize], Activation),
        inertia: Inertia,
        damped: bool,
    ) -> Self {
        let features = leastaction_core::energy::inertia_network::feature_count(&coordinates);
        let outputs = inertia.outputs(coordinates.len());
        let network = Network::of_widths(features, widths, (outputs, activation), 0);
        Self { coordinates, inertia, network, damped }
    }

    /// Kinetic energy T = ½vᵀHv, from the outputs that make up H.
    fn kinetic(&self, builder: &mut Builder, outputs: Node, v: Node) -> Node {
        let n = self.n();
        let diagonal = builder.part(outputs, 0..n);
        let diagonal = builder.map(Function::Activation(Activation::Softplus), diagonal);
        let twice = match self.inertia {
            Inertia::Diagonal => {
                let p = builder.product(diagonal, v);
                builder.dot(p, v)
            }
            Inertia::Cholesky { epsilon } => {
                let below: Vec<(usize, usize)> = (0..n).flat_map(|i| (0..i).map(move |j| (i, j))).collect();
                let lower = builder.part(outputs, n..n + below.len());
                let entries = builder.joined(&[diagonal, lower]);
                let of = |k: usize| (0..n).chain(below.iter().map(move |(i, j)| [*i, *j][k])).collect();
                let (columns, rows): (Vec<_>, Vec<_>) = (of(0), of(1));
                square(builder, entries, (&rows, &columns), (n, v, epsilon))
            }
            Inertia::Factor { rows: count, epsilon } => {
                let entries = usize::from(count) * n;
                let (rows, columns): (Vec<_>, Vec<_>) = (0..entries).map(|k| (k / n, k % n)).unzip();
                let entries = builder.part(outputs, 0..entries);
                square(builder, entries, (&rows, &columns), (count.into(), v, epsilon))
            }
        };
        builder.scaled(0.5, twice)
    }
}

/// Returns |Bv|² + ε|v|², where B has `count` rows with the given entries at the given rows and columns, and zeros
/// elsewhere.
fn square(
    builder: &mut Builder,
    entries: Node,
    (rows, columns): (&[usize], &[usize]),
    (count, v, epsilon): (usize, Node, f32),
) -> Node {
    let of_columns = builder.gather(v, columns);
    let products = builder.product(entries, of_columns);
    let speeds = builder.scatter(products, rows, count);
    let (square, own) = (builder.dot(speeds, speeds), builder.dot(v, v));
    let own = builder.scaled(epsilon.into(), own);
    builder.sum(square, own)
}

impl Energies for InertiaNetworkEnergies {
    fn n(&self) -> usize {
        self.coordinates.len()
    }

    fn parameters(&self) -> usize {
        self.network.end() + if self.damped { self.n() } else { 0 }
    }

    fn energies(&self, builder: &mut Builder, q: Node, v: Node) -> [Node; 2] {
        let features = features(builder, &self.coordinates, q);
        let outputs = self.network.output(builder, features);
        let last = builder.length(outputs) - 1;
        let potential = builder.part(outputs, last..last + 1);
        [self.kinetic(builder, outputs, v), potential]
    }

    fn force(&self, builder: &mut Builder, _: Node, v: Node, _: Node) -> Node {
        if !self.damped {
            return builder.zeros(self.n());
        }
        let coefficients = builder.parameters(self.network.end(), self.n());
        let drag = builder.product(coefficients, v);
        builder.scaled(-1.0, drag)
    }
}
