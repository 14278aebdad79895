//! The shape of a tree of elements on the host.

use super::{known_positions, layers, random_layers};
use leastaction_core::energy::modular::{
    ELEMENT_PARAMETERS, Input, ModularShape, NetworkShape, TransformShape, TypeShape,
};
use leastaction_core::model::{Law, Laws, MAX_TREES, ModularHeader, TreeHeader};
use serde::{Deserialize, Serialize};

/// The smallest mass, kg, that training may reach.
const LEAST_MASS: f64 = 1e-6;

/// Numbers of an element type: its parameters, and its damping.
pub const TYPE_NUMBERS: usize = ELEMENT_PARAMETERS + 1;
/// c₁ and c₂.
const COEFFICIENTS: usize = 2;

/// A number of an element type.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Number {
    /// Its value, where training begins if it is learned.
    pub value: f64,
    /// Whether it is learned.
    pub learned: bool,
}

impl Number {
    /// A known number.
    pub const fn known(value: f64) -> Self {
        Self { value, learned: false }
    }

    /// A number to learn, from `value` on.
    pub const fn learned(value: f64) -> Self {
        Self { value, learned: true }
    }
}

/// An element type's name and numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NamedType {
    /// What it is called.
    pub name: String,
    /// Mass, moment of inertia, centre, length, damping.
    pub numbers: [Number; TYPE_NUMBERS],
}

/// A tree by its name.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct NamedTree {
    /// What it is called.
    pub name: String,
    /// As in [`TreeHeader::elements`].
    pub elements: Vec<u8>,
}

impl NamedTree {
    /// A tree in which every element of these types hangs from the one before it.
    pub fn chain(name: &str, kinds: &[u8]) -> Self {
        let elements = kinds.iter().zip(0..).flat_map(|(kind, parent)| [*kind, parent]).collect();
        Self { name: name.to_owned(), elements }
    }

    /// Elements of these types, none of which hangs from another.
    pub fn apart(name: &str, kinds: &[u8]) -> Self {
        Self { name: name.to_owned(), elements: kinds.iter().flat_map(|kind| [*kind, 0]).collect() }
    }

    fn header(&self) -> TreeHeader<'_> {
        TreeHeader { name: &self.name, elements: &self.elements }
    }
}

/// The shape of a modular model: its element types, its trees, and the tree that is meant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModularArchitecture {
    /// Networks and types.
    pub shape: ModularShape,
    /// The names and numbers of the types.
    pub types: Vec<NamedType>,
    /// Names of the types as the file has them.
    names: String,
    /// c₁ and c₂.
    pub coefficients: [Number; 2],
    /// Whether element types have viscous damping of their own, which ends the weight block.
    pub damped: bool,
    /// All trees.
    pub trees: Vec<NamedTree>,
    /// The tree that is trained or evaluated.
    pub tree: usize,
}

impl ModularArchitecture {
    /// A model of these types and trees, of which the first tree is meant, with damping of its own.
    pub fn new(
        shape: ModularShape,
        types: Vec<NamedType>,
        coefficients: [Number; 2],
        trees: Vec<NamedTree>,
    ) -> Self {
        let names = types.iter().map(|t| t.name.as_str()).collect::<Vec<_>>().join(",");
        Self { shape, types, names, coefficients, damped: true, trees, tree: 0 }
    }

    /// The shape in the words of the model file.
    pub fn header(&self) -> ModularHeader<'_> {
        let mut trees = [TreeHeader::default(); MAX_TREES];
        for (slot, tree) in trees.iter_mut().zip(&self.trees) {
            *slot = tree.header();
        }
        ModularHeader { shape: self.shape, names: &self.names, trees }
    }

    /// The shape that a model file has; all numbers are known, as in the file.
    pub fn from_header(header: &ModularHeader, laws: Laws, weights: &[f64]) -> Self {
        let named =
            |name: &str| NamedType { name: name.to_owned(), numbers: [Number::known(0.0); TYPE_NUMBERS] };
        let named_tree =
            |tree: &TreeHeader| NamedTree { name: tree.name.to_owned(), elements: tree.elements.to_vec() };
        let new = Self::new(
            header.shape,
            header.names.split(',').map(named).collect(),
            [Number::known(1.0); COEFFICIENTS],
            header.trees().map(named_tree).collect(),
        );
        Self { damped: laws.contains(Law::Viscous), ..new }.with_numbers(weights)
    }

    /// The laws of force that its element types have numbers for.
    pub fn laws(&self) -> Laws<'static> {
        if self.damped { Laws::VISCOUS } else { Laws::NONE }
    }

    /// The same with another tree in place of all others.
    #[must_use]
    pub fn with_tree(&self, tree: NamedTree) -> Self {
        Self { trees: vec![tree], tree: 0, ..self.clone() }
    }

    /// The same with the tree of that name in mind; `None` where there is none.
    #[must_use]
    pub fn with_tree_named(&self, name: &str) -> Option<Self> {
        let tree = self.trees.iter().position(|tree| tree.name == name)?;
        Some(Self { tree, ..self.clone() })
    }

    /// The tree in the words of the model file; without elements where there is none.
    pub fn tree_header(&self) -> TreeHeader<'_> {
        self.trees.get(self.tree).map(NamedTree::header).unwrap_or_default()
    }

    /// One letter a coordinate: `t` translation, `a` angle.
    pub fn coordinates(&self) -> String {
        let letters = |kind: &TypeShape| match kind.transform {
            TransformShape::Free => "tt",
            TransformShape::Slide | TransformShape::Network { input: Input::Translation, .. } => "t",
            TransformShape::Rod | TransformShape::Network { .. } => "a",
        };
        self.kinds().filter_map(|kind| self.shape.types.get(kind)).map(letters).collect()
    }

    /// What the tree is called.
    pub fn tree_name(&self) -> &str {
        self.tree_header().name
    }

    /// Number of coordinates n; 0 where the tree names a type that does not exist.
    pub fn n(&self) -> usize {
        self.tree_header().coordinates(&self.shape).unwrap_or(0)
    }

    /// Random networks, the numbers as given.
    pub fn initial_weights(&self, seed: u64) -> Vec<f64> {
        let mut weights = random_layers(self.shape.networks.iter().flat_map(layers), seed);
        weights.extend(self.numbers().map(|number| number.value));
        weights
    }

    /// The numbers after the networks, in the order of the weight block.
    pub fn numbers(&self) -> impl Iterator<Item = Number> {
        let parameters = self.types.iter().flat_map(|kind| kind.numbers.into_iter().take(ELEMENT_PARAMETERS));
        let damping = self.types.iter().flat_map(|kind| kind.numbers.into_iter().skip(ELEMENT_PARAMETERS));
        parameters.chain(self.coefficients).chain(damping.filter(|_| self.damped))
    }

    /// Where the numbers begin in the weight block, after the networks.
    pub fn numbers_start(&self) -> usize {
        self.shape.networks.iter().filter_map(NetworkShape::parameters).sum()
    }

    /// The positions of the known numbers.
    pub fn fixed_positions(&self) -> Vec<usize> {
        known_positions(self.numbers_start(), self.numbers())
    }

    /// The type of every element of the tree.
    pub fn kinds(&self) -> impl Iterator<Item = usize> {
        self.tree_header().elements.iter().step_by(2).map(|kind| usize::from(*kind))
    }

    /// The type of the element that each coordinate of the tree moves.
    pub fn type_of_coordinates(&self) -> Vec<usize> {
        let of = |kind: usize| (kind, self.shape.types.get(kind).map_or(0, |t| t.coordinates()));
        self.kinds().map(of).flat_map(|(kind, n)| std::iter::repeat_n(kind, n)).collect()
    }

    /// Masses above 0, moments of inertia and damping not below.
    pub fn project(&self, weights: &mut [f64]) {
        let numbers = weights.get_mut(self.numbers_start()..).unwrap_or_default();
        let (parameters, rest) =
            numbers.split_at_mut(numbers.len().min(ELEMENT_PARAMETERS * self.types.len()));
        for [mass, inertia, ..] in parameters.as_chunks_mut::<ELEMENT_PARAMETERS>().0 {
            *mass = mass.max(LEAST_MASS);
            *inertia = inertia.max(0.0);
        }
        let damping = if self.damped { self.types.len() } else { 0 };
        rest.iter_mut().skip(COEFFICIENTS).take(damping).for_each(|damping| *damping = damping.max(0.0));
    }

    /// The same with the numbers (masses and so on) that a weight block has.
    #[must_use]
    pub fn with_numbers(mut self, weights: &[f64]) -> Self {
        let start = self.numbers_start();
        let values = weights.get(start..).unwrap_or_default();
        let (parameters, rest) = values.split_at(values.len().min(ELEMENT_PARAMETERS * self.types.len()));
        let (coefficients, damping) = rest.split_at(rest.len().min(COEFFICIENTS));
        for (kind, values) in self.types.iter_mut().zip(parameters.as_chunks::<ELEMENT_PARAMETERS>().0) {
            kind.numbers.iter_mut().zip(values).for_each(|(number, value)| number.value = *value);
        }
        self.coefficients.iter_mut().zip(coefficients).for_each(|(number, value)| number.value = *value);
        for (kind, damping) in self.types.iter_mut().zip(damping).filter(|_| self.damped) {
            kind.numbers[TYPE_NUMBERS - 1].value = *damping;
        }
        self
    }

    /// Whether the scale of L is known without a force: a known mass moves in a known way, or turns with a known moment of
    /// inertia.
    pub fn shows_scale(&self) -> bool {
        let known = |kind: usize| {
            let (shape, named) = (self.shape.types.get(kind)?, self.types.get(kind)?);
            let [mass, inertia, centre, length, _] = named.numbers;
            let moves = match shape.transform {
                TransformShape::Free | TransformShape::Slide => true,
                TransformShape::Rod => !length.learned && !centre.learned && centre.value != 0.0,
                TransformShape::Network { .. } => false,
            };
            Some(!mass.learned && moves || !inertia.learned && inertia.value > 0.0)
        };
        self.kinds().any(|kind| known(kind).unwrap_or(false))
    }

    /// Whether every mass of the tree is learned and no moment of inertia is known: then a common factor of all of them is in
    /// no free motion.
    pub fn learns_every_mass(&self) -> bool {
        self.kinds().filter_map(|kind| self.types.get(kind)).all(|named| {
            let [mass, inertia, ..] = named.numbers;
            mass.learned && (inertia.learned || inertia.value == 0.0)
        })
    }
}
