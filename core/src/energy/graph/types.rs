//! Node types and edge types over borrowed weights, and their energies at a single node or edge.

use super::GraphError;
use super::messages::collected;
use super::radial::{Radial, square};
use super::shape::{Drag, EDGE_NUMBERS, EdgeShape, GraphShape, Kinetic, MAX_EMBEDDING, NodeShape, Potential};
use crate::energy::List;
use crate::expected::{expected, present};
use crate::network::{Jet, Mlp};
use crate::scalar::{Real, Scalar, WeightFormat};
use heapless::Vec;

/// Maximum number of inputs of a network: two embeddings.
const MAX_INPUTS: usize = 2 * MAX_EMBEDDING;

/// Inputs of a network.
pub(super) type Inputs<S, const T: usize> = Vec<Jet<S, T>, MAX_INPUTS>;

/// The types of a graph model in `D` dimensions: at most `K` networks of at most `L` hidden layers of at most `H` units.
#[derive(Clone, Copy, Debug)]
pub struct Types<'a, W, const D: usize, const K: usize, const H: usize, const L: usize> {
    shape: GraphShape,
    networks: List<Mlp<'a, W, H, L>, K>,
    /// The numbers of all node types, then of all edge types.
    numbers: &'a [W],
}

/// The numbers of one node type.
struct NodeParameters<'a, W> {
    mass: W,
    drag: W,
    field: &'a [W],
    kinetic_embedding: &'a [W],
    embedding: &'a [W],
}

impl<'a, W: WeightFormat, const D: usize, const K: usize, const H: usize, const L: usize>
    Types<'a, W, D, K, H, L>
{
    /// Takes the types of the given shape from the front of `block` and leaves the rest there. `None` if the block is too short, the shape
    /// is inconsistent (see [`GraphShape::invalid_part`]), or it does not have `D` dimensions, or it has more than `K` networks, `L` hidden
    /// layers or `H` units in a layer.
    pub fn take(block: &mut &'a [W], shape: &GraphShape) -> Option<Self> {
        if shape.invalid_part().is_some() || shape.check_size::<D, K, H, L>().is_err() {
            return None;
        }
        let networks = shape.networks.take(block)?;
        let (numbers, rest) = block.split_at_checked(shape.all_numbers())?;
        *block = rest;
        Some(Self { shape: *shape, networks, numbers })
    }

    /// The shape.
    pub fn shape(&self) -> &GraphShape {
        &self.shape
    }

    #[inline(always)]
    fn node_type(&self, kind: u8) -> Option<&NodeShape> {
        present(self.shape.nodes.get(kind))
    }

    #[inline(always)]
    pub(super) fn edge_type(&self, kind: u8) -> Option<&EdgeShape> {
        present(self.shape.edges.get(kind))
    }

    #[inline(always)]
    pub(super) fn network(&self, network: u8) -> Option<&Mlp<'a, W, H, L>> {
        present(self.networks.get(network))
    }

    #[inline(always)]
    fn numbers(&self, kind: u8) -> Option<NodeParameters<'a, W>> {
        let [kinetic, h] = [self.shape.kinetic_embedding, self.shape.embedding].map(usize::from);
        let stride = self.shape.numbers();
        let start = usize::from(kind) * stride;
        let ([mass, drag], rest) = present(self.numbers.get(start..))?.split_first_chunk::<2>()?;
        let (field, rest) = rest.split_at_checked(D)?;
        let (kinetic_embedding, rest) = rest.split_at_checked(kinetic)?;
        Some(NodeParameters { mass: *mass, drag: *drag, field, kinetic_embedding, embedding: rest.get(..h)? })
    }

    /// Number k of the embedding of a node type.
    pub(super) fn embedding<S: Scalar<Weight = W::Wide>>(&self, kind: u8, k: usize) -> S {
        let number = self.numbers(kind).and_then(|numbers| numbers.embedding.get(k).copied());
        expected(number.map(W::scalar), S::zero())
    }

    /// c₁ and c₂ of an edge type.
    #[inline(always)]
    fn law(&self, kind: u8) -> Option<[W; EDGE_NUMBERS]> {
        let at = self.shape.numbers() * self.shape.nodes.len() + EDGE_NUMBERS * usize::from(kind);
        present(self.numbers.get(at..)?.first_chunk()).copied()
    }

    /// T of a node, with its first `O` derivatives in |v|².
    #[inline(always)]
    pub(super) fn kinetic<S: Scalar<Weight = W::Wide>, const O: usize>(
        &self,
        kind: u8,
        v: &[S; D],
    ) -> Radial<S> {
        let s = square(v);
        let at_rest = Radial::linear(S::zero(), s);
        let (Some(node), Some(numbers)) = (self.node_type(kind), self.numbers(kind)) else { return at_rest };
        match node.kinetic {
            Kinetic::Mass => Radial::linear(numbers.mass.scalar::<S>().half(), s),
            Kinetic::Network(network) => self.network(network).map_or(at_rest, |network| {
                let mut y = [Jet::zero(); 1];
                let x = inputs::<W, S, O>(numbers.kinetic_embedding, &[Jet::parameter(s)]);
                network.series::<S, O>(&x, &mut y);
                Radial::of(&y[0])
            }),
        }
    }

    /// Potential V of a node at x.
    pub(super) fn potential<S: Scalar<Weight = W::Wide>>(&self, kind: u8, x: &[S; D]) -> S {
        let (Some(node), Some(numbers)) = (self.node_type(kind), self.numbers(kind)) else {
            return S::zero();
        };
        let uniform =
            || numbers.field.iter().zip(x).fold(S::zero(), |sum, (g, x)| sum + g.scalar::<S>() * *x);
        match node.potential {
            Potential::None => S::zero(),
            Potential::Uniform => uniform(),
            Potential::Network(network) => self.network(network).map_or(S::zero(), |network| {
                uniform() + network.energy::<S>(&inputs(numbers.embedding, &x.map(Jet::constant)))
            }),
        }
    }

    /// Gradient V_x of a node at x, with tangents.
    pub(super) fn pull<S: Scalar<Weight = W::Wide>, const T: usize>(
        &self,
        kind: u8,
        x: &[Jet<S, T>; D],
    ) -> [Jet<S, T>; D] {
        let mut pull = [Jet::zero(); D];
        let (Some(node), Some(numbers)) = (self.node_type(kind), self.numbers(kind)) else { return pull };
        match node.potential {
            Potential::None => return pull,
            Potential::Uniform => {}
            Potential::Network(network) => {
                let Some(network) = self.network(network) else { return pull };
                let x = inputs(numbers.embedding, x);
                let mut x_bar = x.clone();
                let mut y = [Jet::zero(); 1];
                network.pull_back(&x, &mut x_bar, &mut y, |_| [Jet::constant(S::one())]);
                for (pull, of_x) in pull.iter_mut().zip(x_bar.iter().skip(numbers.embedding.len())) {
                    *pull = *of_x;
                }
            }
        }
        for (pull, g) in pull.iter_mut().zip(numbers.field) {
            pull.value += g.scalar();
        }
        pull
    }

    /// Potential U of an edge across d, with its first `O` derivatives in |d|².
    #[inline(always)]
    pub(super) fn pair<S: Scalar<Weight = W::Wide>, const O: usize>(
        &self,
        kind: u8,
        d: &[S; D],
    ) -> Radial<S> {
        let s = square(d);
        let none = Radial::linear(S::zero(), s);
        let (Some(edge), Some(law)) = (self.edge_type(kind), self.law(kind)) else { return none };
        let z = edge.separation.feature().of_square::<S, O>(s);
        let law = Radial::of(&z).quadratic(law.map(W::scalar));
        let Some(network) = edge.potential.and_then(|network| self.network(network)) else { return law };
        let mut y = [Jet::zero(); 1];
        network.series::<S, O>(&[z], &mut y);
        law.plus(&Radial::of(&y[0]))
    }

    /// Drag Q of a node along each axis, and ∂Q/∂v along the same axis.
    #[inline(always)]
    pub(super) fn drags<S: Scalar<Weight = W::Wide>>(&self, kind: u8, v: &[S; D]) -> [[S; D]; 2] {
        let mut drags = [[S::zero(); D]; 2];
        if self.node_type(kind).is_some_and(|node| node.drag != Drag::None) {
            let [values, slopes] = &mut drags;
            for ((v, value), slope) in v.iter().zip(values).zip(slopes) {
                [*value, *slope] = self.drag(kind, *v);
            }
        }
        drags
    }

    /// Drag Q of a node along one axis, and ∂Q/∂v.
    #[inline(always)]
    pub(super) fn drag<S: Scalar<Weight = W::Wide>>(&self, kind: u8, v: S) -> [S; 2] {
        let none = [S::zero(); 2];
        let (Some(node), Some(numbers)) = (self.node_type(kind), self.numbers(kind)) else { return none };
        let c: S = numbers.drag.scalar();
        let viscous = [-(c * v), -c];
        match node.drag {
            Drag::None => none,
            Drag::Viscous => viscous,
            Drag::Network(network) => self.network(network).map_or(viscous, |network| {
                let mut y = [Jet::<S, 1>::zero(); 1];
                network.series::<S, 1>(&[Jet::parameter(v)], &mut y);
                let [Jet { value, tangent: [slope] }] = y;
                let size = -value.neg_abs();
                [viscous[0] - size * v, viscous[1] - (size + sign(value) * slope * v)]
            }),
        }
    }
}

impl<W: WeightFormat<Wide: Real>, const D: usize, const K: usize, const H: usize, const L: usize>
    Types<'_, W, D, K, H, L>
{
    /// Checks the signs of the numbers, see [`GraphShape::check_numbers`].
    ///
    /// # Errors
    /// [`GraphError::Mass`] and [`GraphError::Drag`] for the first number that is out of range.
    pub fn check_numbers(&self) -> Result<(), GraphError> {
        self.shape.check_numbers(self.numbers)
    }
}

/// Inputs of a network: an embedding, which is constant, then `x`.
fn inputs<W: WeightFormat, S: Scalar<Weight = W::Wide>, const T: usize>(
    embedding: &[W],
    x: &[Jet<S, T>],
) -> Inputs<S, T> {
    let constant = embedding.iter().map(|w| Jet::constant(w.scalar()));
    collected(constant.chain(x.iter().copied()))
}

/// Sign of x: ±1, and 0 at 0.
#[inline(always)]
fn sign<S: Scalar>(x: S) -> S {
    const SMALLEST: f64 = 1e-30;
    x / (-x.neg_abs()).max(S::constant(SMALLEST))
}
