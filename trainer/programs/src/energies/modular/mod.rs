//! Trees of reusable elements of any size (ModLaNet; Lu et al., ICML 2022; [`leastaction_core::energy::modular`]).

mod element;
mod pair;

use super::{Energies, Network};
use crate::builder::Builder;
use crate::operation::Node;
use element::ElementType;
use leastaction_core::energy::NetworkShape;
use leastaction_core::energy::modular::{
    ELEMENT_PARAMETERS, ModularShape, SPACE, TreeElement, TreeError, TypeShape,
};
use leastaction_core::model::ModelError;
use pair::Pair;
use std::collections::BTreeMap;
use std::ops::Range;

/// Number of the coefficients c₁ and c₂.
const COEFFICIENTS: usize = 2;

/// A tree of elements; with x_e the centre of element e,
///
/// L = ½Σ m_e|ẋ_e|² + ½Σ I_e q̇² − c₁Σ m_e U₁(x_e) − c₂Σ_{e<f} m_e m_f U₂(x_e, x_f)   (ModLaNet eqs. 8–10; I_e is ours),
///
/// and viscous damping Q = −c v with one coefficient per element type, if it is learned.
///
/// A tree may have any number of elements; a [`TreeElement`] lets the first 256 of them carry others, and a model file holds trees of at
/// most 64 coordinates. [`ModularShape`] limits element types (6), networks (8) and their hidden layers (4).
#[derive(Clone, Debug, PartialEq)]
pub struct ModularEnergies {
    types: Vec<ElementType>,
    pair: Option<Pair>,
    elements: Vec<Element>,
    /// Position of the numbers of the first element type in the weight block.
    numbers: usize,
    damped: bool,
}

/// An element and its range of coordinates.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Element {
    kind: usize,
    parent: Option<usize>,
    coordinates: Range<usize>,
}

impl ModularEnergies {
    /// Creates the tree of these elements, parents first. Its weight block holds the networks in order, then the
    /// [`ElementParameters`](leastaction_core::energy::modular::ElementParameters) of each type, then c₁ and c₂; and
    /// finally, with damping, one coefficient per type for all its coordinates, N s/m or N m s/rad.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] for an inconsistent shape ([`ModularShape::invalid_part`]), [`ModelError::Tree`] for
    /// elements that do not form a tree of its types.
    pub fn new(shape: &ModularShape, nodes: &[TreeElement], damped: bool) -> Result<Self, ModelError> {
        if let Some(what) = shape.invalid_part() {
            return Err(ModelError::OutOfRange { what });
        }
        match shape.tree::<0>(nodes.iter().copied()) {
            // Any number of coordinates is allowed.
            Ok(_) | Err(TreeError::Coordinates { .. }) => {}
            Err(error) => return Err(ModelError::Tree(error)),
        }
        let (networks, numbers) = placed(shape.networks.iter());
        let types = shape.types.iter().zip((numbers..).step_by(ELEMENT_PARAMETERS));
        Ok(Self {
            types: types.map(|(kind, start)| ElementType::new(kind, &networks, start)).collect(),
            pair: shape.pair.map(|pair| Pair::new(&pair, &networks)),
            elements: elements(shape, nodes),
            numbers,
            damped,
        })
    }

    fn element_type(&self, element: &Element) -> &ElementType {
        &self.types[element.kind]
    }

    /// Position of c₁ in the weight block.
    fn coefficients(&self) -> usize {
        self.numbers + ELEMENT_PARAMETERS * self.types.len()
    }

    /// Displacements of all elements' centres, from the displacements of the single elements (ModLaNet eq. 7): the sum
    /// along the path from the ground, in which the displacement of the element itself is weighted by the position of
    /// its centre.
    ///
    /// Elements are separate vectors rather than parts of one vector, so that derivatives along a coordinate only
    /// involve the elements that it carries.
    fn centres(&self, builder: &mut Builder, own: &[Node]) -> Vec<Node> {
        let mut tips: Vec<Node> = Vec::new();
        let mut centres = Vec::new();
        for (element, own) in self.elements.iter().zip(own) {
            let centre = self.element_type(element).centre(builder);
            let part = builder.product(centre, *own);
            let base = element.parent.map(|parent| tips[parent]);
            let from_base = |builder: &mut Builder, x| base.map_or(x, |base| builder.sum(base, x));
            centres.push(from_base(builder, part));
            tips.push(from_base(builder, *own));
        }
        centres
    }

    /// Displacements by each element's own coordinates, and their rates.
    fn displacements(&self, builder: &mut Builder, q: Node, v: Node) -> [Vec<Node>; 2] {
        let of = |builder: &mut Builder, x, element: &Element| builder.part(x, element.coordinates.clone());
        let displacements = self.elements.iter().map(|element| {
            let q = of(builder, q, element);
            self.element_type(element).displacement(builder, q)
        });
        let displacements: Vec<Node> = displacements.collect();
        let mut rates = builder.tangents(&displacements, &[(q, v)]);
        for (element, rate) in self.elements.iter().zip(&mut rates) {
            let (q, v) = (of(builder, q, element), of(builder, v, element));
            if let Some(velocity) = self.element_type(element).velocity(builder, q, v) {
                *rate = velocity;
            }
        }
        [displacements, rates]
    }

    /// Kinetic energy ½Σ m_e|ẋ_e|² + ½Σ I_e q̇².
    fn kinetic(&self, builder: &mut Builder, rates: &[Node], v: Node) -> Node {
        let velocities = self.centres(builder, rates);
        let (mut squares, mut turning) = (Sums::default(), Sums::default());
        for (element, velocity) in self.elements.iter().zip(velocities) {
            let square = builder.dot(velocity, velocity);
            squares.add(builder, element.kind, square);
            let v = builder.part(v, element.coordinates.clone());
            let square = builder.dot(v, v);
            turning.add(builder, element.kind, square);
        }
        let of_masses = squares.weighted(builder, |builder, kind| self.types[kind].mass(builder));
        let of_inertias = turning.weighted(builder, |builder, kind| self.types[kind].inertia(builder));
        let twice = builder.sum(of_masses, of_inertias);
        builder.scaled(0.5, twice)
    }

    /// Potential c₁Σ m_e U₁(x_e) + c₂Σ_{e<f} m_e m_f U₂(x_e, x_f).
    fn potential(&self, builder: &mut Builder, displacements: &[Node]) -> Node {
        let x = self.centres(builder, displacements);
        let (mut alone, mut pairs) = (Sums::default(), Sums::default());
        for (e, element) in self.elements.iter().enumerate() {
            if let Some(potential) = self.element_type(element).potential(builder, x[e]) {
                alone.add(builder, element.kind, potential);
            }
            let Some(pair) = &self.pair else { continue };
            for (before, other) in self.elements[..e].iter().enumerate() {
                let potential = pair.potential(builder, x[before], x[e]);
                let kinds = (element.kind.min(other.kind), element.kind.max(other.kind));
                pairs.add(builder, kinds, potential);
            }
        }
        let alone = alone.weighted(builder, |builder, kind| self.types[kind].mass(builder));
        let pairs = pairs.weighted(builder, |builder, (one, other)| {
            let [one, other] = [one, other].map(|kind| self.types[kind].mass(builder));
            builder.product(one, other)
        });
        let [c1, c2] = [0, 1].map(|i| builder.parameters(self.coefficients() + i, 1));
        let (alone, pairs) = (builder.product(c1, alone), builder.product(c2, pairs));
        builder.sum(alone, pairs)
    }
}

impl Energies for ModularEnergies {
    fn n(&self) -> usize {
        self.elements.last().map_or(0, |element| element.coordinates.end)
    }

    fn parameters(&self) -> usize {
        self.coefficients() + COEFFICIENTS + if self.damped { self.types.len() } else { 0 }
    }

    fn energies(&self, builder: &mut Builder, q: Node, v: Node) -> [Node; 2] {
        let [displacements, rates] = self.displacements(builder, q, v);
        [self.kinetic(builder, &rates, v), self.potential(builder, &displacements)]
    }

    fn force(&self, builder: &mut Builder, _: Node, v: Node, _: Node) -> Node {
        if !self.damped {
            return builder.zeros(self.n());
        }
        let of_types = builder.parameters(self.coefficients() + COEFFICIENTS, self.types.len());
        let kinds =
            self.elements.iter().flat_map(|element| element.coordinates.clone().map(|_| element.kind));
        let coefficients = builder.gather(of_types, &kinds.collect::<Vec<_>>());
        let drag = builder.product(coefficients, v);
        builder.scaled(-1.0, drag)
    }
}

/// Networks placed one after the other from the front of the weight block, and the position after the last.
fn placed<'s>(shapes: impl Iterator<Item = &'s NetworkShape>) -> (Vec<Network>, usize) {
    let mut end = 0;
    let networks = shapes.map(|shape| {
        let network = Network::new(shape, end);
        end = network.end();
        network
    });
    let networks = networks.collect();
    (networks, end)
}

/// Elements with their coordinates, in order.
fn elements(shape: &ModularShape, nodes: &[TreeElement]) -> Vec<Element> {
    let mut end = 0;
    let place = |node: &TreeElement| {
        let start = end;
        end += shape.types.get(node.kind).map_or(0, TypeShape::coordinates);
        Element { kind: node.kind.into(), parent: node.parent.map(usize::from), coordinates: start..end }
    };
    nodes.iter().map(place).collect()
}

/// Sums of terms for each element type that they belong to, so that each type's sum is multiplied by a mass only once.
struct Sums<K>(BTreeMap<K, Node>);

impl<K> Default for Sums<K> {
    fn default() -> Self {
        Self(BTreeMap::new())
    }
}

impl<K: Ord + Copy> Sums<K> {
    fn add(&mut self, builder: &mut Builder, kind: K, x: Node) {
        let before = self.0.get(&kind).copied();
        let sum = before.map_or(x, |before| builder.sum(before, x));
        self.0.insert(kind, sum);
    }

    /// Sum over all kinds, each multiplied by the `factor` of its kind.
    fn weighted(&self, builder: &mut Builder, factor: impl Fn(&mut Builder, K) -> Node) -> Node {
        let mut sum = builder.zeros(1);
        for (kind, own) in &self.0 {
            let factor = factor(builder, *kind);
            let term = builder.product(factor, *own);
            sum = builder.sum(sum, term);
        }
        sum
    }
}

/// Repeats a number for every axis of space.
fn on_axes(builder: &mut Builder, x: Node) -> Node {
    builder.repeated(x, SPACE)
}
