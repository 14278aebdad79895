//! Host-side shape of a tree of elements.

pub mod config;
pub mod describe;

use crate::family::{Family, OpenGauge, Parts};
use crate::layers::{hidden, layers, random_layers};
use crate::names::{NumberName, named};
use crate::number::{Number, known_positions};
use crate::source::{ConstantType, LoadedType};
use leastaction_core::energy::modular::{
    ELEMENT_PARAMETERS, Input, ModularShape, NetworkShape, TransformShape, TypeShape,
};
use leastaction_core::model::{Law, Laws, MAX_TREES, ModelError, ModularHeader, TreeHeader};
use leastaction_programs::energies::{Energies, ModularEnergies};
use serde::{Deserialize, Serialize};

/// Smallest mass that training may reach, kg.
const LEAST_MASS: f64 = 1e-6;

/// Count of the numbers of an element type: its parameters and its damping.
pub const TYPE_NUMBERS: usize = ELEMENT_PARAMETERS + 1;
/// Number of the coefficients c₁ and c₂.
const COEFFICIENTS: usize = 2;

/// Name and numbers of an element type.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NamedType {
    /// Name.
    pub name: String,
    /// Mass, moment of inertia, centre, length, damping.
    pub numbers: [Number; TYPE_NUMBERS],
}

/// A tree with its name.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct NamedTree {
    /// Name.
    pub name: String,
    /// Encoded elements, see [`TreeHeader::elements`].
    pub elements: Vec<u8>,
}

impl NamedTree {
    /// Returns a tree of elements of these types in which each element hangs from the one before it.
    pub fn chain(name: &str, kinds: &[u8]) -> Self {
        let elements = kinds.iter().zip(0..).flat_map(|(kind, parent)| [*kind, parent]).collect();
        Self { name: name.to_owned(), elements }
    }

    /// Returns a tree of elements of these types in which no element hangs from another.
    pub fn apart(name: &str, kinds: &[u8]) -> Self {
        Self { name: name.to_owned(), elements: kinds.iter().flat_map(|kind| [*kind, 0]).collect() }
    }

    fn header(&self) -> TreeHeader<'_> {
        TreeHeader { name: &self.name, elements: &self.elements }
    }
}

/// Shape of a modular model: its element types, its trees, and the selected tree.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModularArchitecture {
    /// Networks and types.
    pub shape: ModularShape,
    /// Names and numbers of the types.
    pub types: Vec<NamedType>,
    /// Comma-separated names of the types, as in the file.
    names: String,
    /// Coefficients c₁ and c₂.
    pub coefficients: [Number; 2],
    /// Whether the element types have viscous damping, whose numbers are then at the end of the weight block.
    pub damped: bool,
    /// All trees.
    pub trees: Vec<NamedTree>,
    /// Position of the selected tree, which is trained or evaluated.
    pub tree: usize,
}

/// Names and units of the numbers of an element type.
const NUMBERS_OF_TYPE: [(&str, &str); TYPE_NUMBERS] = [
    ("mass", "kg"),
    ("inertia about the centre of mass", "kg m²"),
    ("centre of mass", "m"),
    ("length", "m"),
    ("viscous friction", ""),
];

impl ModularArchitecture {
    /// Returns a model with these types and trees, and with damping that belongs to the types; the first tree is
    /// selected.
    pub fn new(
        shape: ModularShape,
        types: Vec<NamedType>,
        coefficients: [Number; 2],
        trees: Vec<NamedTree>,
    ) -> Self {
        let names = types.iter().map(|t| t.name.as_str()).collect::<Vec<_>>().join(",");
        Self { shape, types, names, coefficients, damped: true, trees, tree: 0 }
    }

    /// Calls `read` with the shape as the model file states it.
    pub(crate) fn with_header<T>(&self, read: impl FnOnce(ModularHeader) -> T) -> T {
        read(self.header())
    }

    /// Shape as the model file states it.
    pub fn header(&self) -> ModularHeader<'_> {
        let mut trees = [TreeHeader::default(); MAX_TREES];
        for (slot, tree) in trees.iter_mut().zip(&self.trees) {
            *slot = tree.header();
        }
        ModularHeader { shape: self.shape, names: &self.names, trees }
    }

    /// Returns the shape described by a model file; all numbers are known, as in the file.
    pub(crate) fn from_header(header: &ModularHeader, laws: Laws, weights: &[f64]) -> Self {
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

    /// Returns the shape with this tree in place of all others.
    #[must_use]
    pub fn with_tree(&self, tree: NamedTree) -> Self {
        Self { trees: vec![tree], tree: 0, ..self.clone() }
    }

    /// Returns the shape with the tree of that name selected; `None` if there is none.
    #[must_use]
    pub fn with_tree_named(&self, name: &str) -> Option<Self> {
        let mut own = self.clone();
        own.mean_part(name).then_some(own)
    }

    /// The selected tree as the model file states it; without elements if there is none.
    pub fn tree_header(&self) -> TreeHeader<'_> {
        self.trees.get(self.tree).map(NamedTree::header).unwrap_or_default()
    }

    /// Name of the selected tree.
    pub fn tree_name(&self) -> &str {
        self.tree_header().name
    }

    /// Numbers after the networks, in the order of the weight block.
    pub fn numbers(&self) -> impl Iterator<Item = Number> {
        let parameters = self.types.iter().flat_map(|kind| kind.numbers.into_iter().take(ELEMENT_PARAMETERS));
        let damping = self.types.iter().flat_map(|kind| kind.numbers.into_iter().skip(ELEMENT_PARAMETERS));
        parameters.chain(self.coefficients).chain(damping.filter(|_| self.damped))
    }

    /// Position of the first of these numbers in the weight block, after the networks.
    pub fn numbers_start(&self) -> usize {
        self.shape.networks.iter().filter_map(NetworkShape::parameters).sum()
    }

    /// Types of the elements of the selected tree.
    pub fn kinds(&self) -> impl Iterator<Item = usize> {
        self.tree_header().elements.iter().step_by(2).map(|kind| usize::from(*kind))
    }

    /// Returns the shape with the numbers (masses and so on) of a weight block.
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

    /// Whether every mass of the tree is learned and no moment of inertia is known. Free motion then leaves a common
    /// factor of them all undetermined.
    pub fn learns_every_mass(&self) -> bool {
        self.kinds().filter_map(|kind| self.types.get(kind)).all(|named| {
            let [mass, inertia, ..] = named.numbers;
            mass.learned && (inertia.learned || inertia.value == 0.0)
        })
    }
}

impl Family for ModularArchitecture {
    fn laws(&self) -> Laws<'static> {
        if self.damped { Laws::VISCOUS } else { Laws::NONE }
    }

    fn coordinates(&self) -> String {
        let letters = |kind: &TypeShape| match kind.transform {
            TransformShape::Free => "tt",
            TransformShape::Slide | TransformShape::Network { input: Input::Translation, .. } => "t",
            TransformShape::Rod | TransformShape::Network { .. } => "a",
        };
        self.kinds().filter_map(|kind| self.shape.types.get(kind)).map(letters).collect()
    }

    fn n(&self) -> usize {
        self.tree_header().coordinates(&self.shape).unwrap_or(0)
    }

    fn initial_weights(&self, seed: u64) -> Vec<f64> {
        let mut weights = random_layers(self.shape.networks.iter().flat_map(layers), seed);
        weights.extend(self.numbers().map(|number| number.value));
        weights
    }

    fn fixed_positions(&self) -> Vec<usize> {
        known_positions(self.numbers_start(), self.numbers())
    }

    fn group_of_coordinates(&self) -> Vec<usize> {
        let of = |kind: usize| (kind, self.shape.types.get(kind).map_or(0, |t| t.coordinates()));
        self.kinds().map(of).flat_map(|(kind, n)| std::iter::repeat_n(kind, n)).collect()
    }

    fn project(&self, weights: &mut [f64]) {
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

    fn shows_scale(&self) -> bool {
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

    fn groups(&self) -> usize {
        self.types.len()
    }

    fn group_name(&self, group: usize) -> String {
        self.types.get(group).map_or(String::new(), |kind| kind.name.clone())
    }

    fn energies(&self) -> Result<Box<dyn Energies>, ModelError> {
        let elements: Vec<_> = self.tree_header().nodes().collect();
        Ok(Box::new(ModularEnergies::new(&self.shape, &elements, self.damped)?))
    }

    fn number_names(&self) -> Vec<Option<NumberName>> {
        let mut names = vec![None; self.numbers_start()];
        for kind in &self.types {
            let of_kind = NUMBERS_OF_TYPE[..ELEMENT_PARAMETERS].iter();
            names.extend(of_kind.map(|(name, unit)| Some(named(&kind.name, name, unit))));
        }
        let coefficient = |k: usize| NumberName { name: format!("coefficient {}", k + 1), unit: "" };
        names.extend((0..self.coefficients.len()).map(|k| Some(coefficient(k))));
        names
    }

    fn mismatch(&self, data: usize) -> String {
        let (tree, model) = (self.tree_name(), self.n());
        let names = self.kinds().filter_map(|kind| self.types.get(kind)).map(|kind| kind.name.as_str());
        let elements = names.collect::<Vec<_>>().join(", ");
        format!(
            "[model] tree = {tree:?} has {model} coordinates, one after the other those of {elements}, but the data has {data}; \
             name the tree that the data is of, its elements in the order of q"
        )
    }

    fn open_gauge(&self) -> Option<OpenGauge> {
        self.learns_every_mass().then_some(OpenGauge::Masses { types: "types", of: "tree" })
    }

    fn networks(&self) -> Vec<Vec<usize>> {
        self.shape.networks.iter().map(|network| hidden(network).collect()).collect()
    }

    fn parts(&self) -> Option<Parts<'_>> {
        let names = self.trees.iter().map(|tree| tree.name.as_str()).collect();
        Some(Parts { what: "tree", names, meant: self.tree_name() })
    }

    fn mean_part(&mut self, name: &str) -> bool {
        let found = self.trees.iter().position(|tree| tree.name == name);
        self.tree = found.unwrap_or(self.tree);
        found.is_some()
    }

    fn loaded_type(&self) -> LoadedType {
        let header = self.header();
        let trees: Vec<String> = header
            .trees()
            .map(|tree| format!("({:?}, {})", tree.name, tree.coordinates(&self.shape).unwrap_or(0)))
            .collect();
        let constants = format!(
            "/// Element types.\npub const E: usize = {};\n/// The tree of elements.\npub const TREE: &str = {:?};\n\
             /// All trees in the file, and their coordinates.\npub const TREES: [(&str, usize); {}] = [{}];\n",
            self.types.len(),
            self.tree_name(),
            trees.len(),
            trees.join(", ")
        );
        LoadedType { constants, ..LoadedType::new("ModularModel", "M, E, H, L") }
    }

    fn constant_type(&self) -> Result<ConstantType, &'static str> {
        Err("a tree of elements")
    }
}
