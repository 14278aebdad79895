use super::{
    ActuatorBytes, ArmHeader, BodiesHeader, GraphHeader, Laws, ModelError, ShapeHeader, TrainedStep,
    TrainingRange,
};
use crate::energy::inertia_network::{Coordinate, Inertia, feature_count, network_shape};
use crate::energy::modular::{self, TreeElement, TreeError};
use crate::energy::{MAX_HIDDEN, NetworkShape};
use crate::expected::expected;
use crate::network::Activation;
use crate::scalar::FileWeightFormat;
use serde::{Deserialize, Serialize};

/// The first four bytes of every model file.
pub const MAGIC: [u8; 4] = *b"LACT";
/// The format this build reads and writes.
pub const FORMAT_VERSION: u8 = 2;
/// Coordinates at most.
pub(super) const MAX_COORDINATES: usize = 16;
/// Coordinates of a tree at most.
pub(super) const MAX_TREE_COORDINATES: usize = 64;
/// Trees in one file at most.
pub const MAX_TREES: usize = 8;

/// What a model is, apart from its weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Header<'a> {
    /// The family of the energies and its shape.
    pub family: Family<'a>,
    /// The laws of force beside them.
    pub laws: Laws<'a>,
    /// Between command and force; `None`: the command is the force.
    pub actuator: Option<ActuatorBytes<'a>>,
    /// The step that the model was trained with, where it was.
    pub trained_step: Option<TrainedStep>,
    /// The unit of every coordinate, `m` or `rad`, separated by commas; one alone is that of all, empty: not stated.
    pub units: &'a str,
    /// What the training data covered; of several trees the first one's.
    pub range: Option<TrainingRange<'a>>,
    /// Where the model comes from: free text for people.
    pub provenance: &'a str,
}

impl<'a> Header<'a> {
    /// A family alone: no laws, an ideal actuator, no step, no range, no text.
    pub const fn new(family: Family<'a>) -> Self {
        Self {
            family,
            laws: Laws::NONE,
            actuator: None,
            trained_step: None,
            units: "",
            range: None,
            provenance: "",
        }
    }

    /// Numbers in the weight block: those of the energies, then those of the laws.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] for a shape that the format does not allow.
    pub fn parameters(&self) -> Result<usize, ModelError> {
        let (energies, laws) = (self.family.parameters()?, self.laws.parameters(self.family.groups()));
        sum(energies, laws)
    }
}

/// Numbers of energies and of laws.
pub(super) fn sum(energies: usize, laws: Option<usize>) -> Result<usize, ModelError> {
    laws.and_then(|laws| energies.checked_add(laws))
        .ok_or(ModelError::OutOfRange { what: "number of weights" })
}

/// A family of energies and its shape.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[allow(clippy::large_enum_variant, reason = "read once, and there is no heap to box it on")]
pub enum Family<'a> {
    /// Inertia matrix and potential from one network.
    InertiaNetwork(InertiaNetworkHeader<'a>),
    /// Trees of reusable elements.
    Modular(ModularHeader<'a>),
    /// Particles with energies of nodes and edges.
    Graph(GraphHeader<'a>),
    /// A tree of rigid bodies on joints in the plane.
    Bodies(BodiesHeader<'a>),
    /// A tree of rigid bodies on joints in space.
    Arm(ArmHeader<'a>),
}

/// The shape of a modular model, types and trees apart: one set of types serves many trees.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModularHeader<'a> {
    /// Networks and element types.
    pub shape: modular::ModularShape,
    /// What the types are called, separated by commas.
    pub names: &'a str,
    /// The trees, by name; the first without elements ends the list.
    #[serde(borrow)]
    pub trees: [TreeHeader<'a>; MAX_TREES],
}

/// A tree of elements.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TreeHeader<'a> {
    /// What it is called.
    pub name: &'a str,
    /// Two bytes an element: its type, and 0 (it hangs from the ground) or 1 + the element that it hangs from.
    pub elements: &'a [u8],
}

/// The shape of an inertia network.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct InertiaNetworkHeader<'a> {
    /// One letter a coordinate: `t` translation, `a` angle, `c` cyclic.
    pub coordinates: &'a str,
    /// Units of the hidden layers; the first 0 ends the list.
    pub widths: [u16; MAX_HIDDEN],
    /// Of the hidden layers.
    pub activation: Activation,
    /// Of the inertia matrix.
    pub inertia: Inertia,
}

impl Coordinate {
    /// The letter that stands for this kind in a model file and on the command line.
    pub const fn letter(self) -> char {
        match self {
            Self::Translation => 't',
            Self::Angle => 'a',
            Self::Cyclic => 'c',
        }
    }

    /// The kind that a letter stands for.
    pub const fn from_letter(letter: char) -> Option<Self> {
        match letter {
            't' => Some(Self::Translation),
            'a' => Some(Self::Angle),
            'c' => Some(Self::Cyclic),
            _ => None,
        }
    }
}

impl Family<'_> {
    /// What the family is called.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::InertiaNetwork(_) => InertiaNetworkHeader::FAMILY.1,
            Self::Modular(_) => ModularHeader::FAMILY.1,
            Self::Graph(_) => GraphHeader::FAMILY.1,
            Self::Bodies(_) => BodiesHeader::FAMILY.1,
            Self::Arm(_) => ArmHeader::FAMILY.1,
        }
    }

    /// Groups of coordinates that laws have numbers of their own for: coordinates of inertia networks, of bodies and of arms,
    /// element types of the modular one, node types of graphs.
    pub fn groups(&self) -> usize {
        match self {
            Self::InertiaNetwork(inertia_network) => inertia_network.groups(),
            Self::Modular(modular) => modular.groups(),
            Self::Graph(graph) => graph.groups(),
            Self::Bodies(bodies) => bodies.groups(),
            Self::Arm(arm) => arm.groups(),
        }
    }

    /// Numbers in the weight block.
    pub fn parameters(&self) -> Result<usize, ModelError> {
        match self {
            Self::InertiaNetwork(inertia_network) => inertia_network.parameters(),
            Self::Modular(modular) => modular.parameters(),
            Self::Graph(graph) => graph.parameters(),
            Self::Bodies(bodies) => bodies.parameters(),
            Self::Arm(arm) => arm.parameters(),
        }
    }
}

impl<'a> ModularHeader<'a> {
    /// Coordinates of the tree that has fewest.
    pub fn fewest_coordinates(&self) -> usize {
        self.trees().filter_map(|tree| tree.coordinates(&self.shape)).min().unwrap_or(0)
    }

    /// The trees in order.
    pub fn trees(&self) -> impl Iterator<Item = &TreeHeader<'a>> + Clone {
        self.trees.iter().take_while(|tree| !tree.elements.is_empty())
    }

    /// The tree of that name.
    ///
    /// # Errors
    /// [`ModelError::NoSuchTree`] where there is none.
    pub fn tree(&self, name: &str) -> Result<&TreeHeader<'a>, ModelError> {
        let none = || ModelError::NoSuchTree { trees: self.trees().count() };
        self.trees().find(|tree| tree.name == name).ok_or_else(none)
    }

    /// Groups of coordinates: one an element type.
    pub(super) fn groups(&self) -> usize {
        self.shape.types.len()
    }

    /// Numbers in the weight block.
    pub fn parameters(&self) -> Result<usize, ModelError> {
        self.shape.parameters().ok_or(ModelError::OutOfRange { what: "number of weights" })
    }

    pub(super) fn validate<W: FileWeightFormat>(&self, weights: &[W]) -> Result<(), ModelError> {
        if let Some(what) = self.shape.invalid_part() {
            return Err(ModelError::OutOfRange { what });
        }
        let kinds = self.shape.types.len();
        check_names(self.names, kinds, "element types")?;
        self.check_trees()?;
        let start = weights.len().saturating_sub(modular::ELEMENT_PARAMETERS * kinds + 2);
        let numbers = expected(weights.get(start..), &[]).as_chunks().0;
        numbers.iter().take(kinds).try_for_each(|numbers| check_numbers(&numbers.map(W::wide)))
    }

    fn check_trees(&self) -> Result<(), ModelError> {
        let written = self.trees.iter().filter(|tree| **tree != TreeHeader::default()).count();
        require(self.trees().next().is_some(), "number of trees")?;
        require(self.trees().count() == written, "list of trees")?;
        if !are_names(self.trees().map(|tree| tree.name.as_bytes())) {
            return Err(ModelError::Names { of: "trees" });
        }
        self.trees().try_for_each(|tree| self.check_tree(tree))
    }

    /// Checks a tree whatever its number of coordinates.
    fn check_tree(&self, tree: &TreeHeader) -> Result<(), ModelError> {
        require(tree.elements.len().is_multiple_of(2), "length of a tree")?;
        match self.shape.tree::<0>(tree.nodes()) {
            Ok(_) => Ok(()),
            Err(TreeError::Coordinates { found, .. }) => {
                require(found <= MAX_TREE_COORDINATES, "number of coordinates of a tree")
            }
            Err(error) => Err(ModelError::Tree(error)),
        }
    }
}

impl TreeHeader<'_> {
    /// The elements in order.
    pub fn nodes(&self) -> impl Iterator<Item = TreeElement> {
        let (pairs, _) = self.elements.as_chunks::<2>();
        pairs.iter().map(|[kind, parent]| TreeElement { kind: *kind, parent: parent.checked_sub(1) })
    }

    /// Coordinates of the tree, with the types of `shape`; `None` where a type does not exist.
    pub fn coordinates(&self, shape: &modular::ModularShape) -> Option<usize> {
        let of = |node: TreeElement| Some(shape.types.get(node.kind)?.coordinates());
        self.nodes().try_fold(0, |sum, node| Some(sum + of(node)?))
    }
}

impl<'a> InertiaNetworkHeader<'a> {
    /// Number of coordinates n.
    pub fn n(&self) -> usize {
        self.coordinates.len()
    }

    /// Groups of coordinates: one each.
    pub(super) fn groups(&self) -> usize {
        self.n()
    }

    /// The kinds of coordinates, which must be N.
    pub fn kinds<const N: usize>(&self) -> Result<[Coordinate; N], ModelError> {
        let mut kinds = [Coordinate::Cyclic; N];
        if self.n() != N {
            return Err(ModelError::Shape { what: "coordinates", found: self.n(), compiled: N });
        }
        for (slot, kind) in kinds.iter_mut().zip(self.letters()) {
            *slot = kind.ok_or(ModelError::OutOfRange { what: "coordinate kind" })?;
        }
        Ok(kinds)
    }

    /// Inputs of the network: one a translation, two an angle.
    pub fn features(&self) -> usize {
        self.letters().flatten().map(|kind| feature_count(&[kind])).sum()
    }

    /// The kind of every coordinate, `None` for a letter that stands for none. Bytes: to decode characters takes code.
    fn letters(&self) -> impl Iterator<Item = Option<Coordinate>> {
        self.coordinates.as_bytes().iter().map(|letter| Coordinate::from_letter(char::from(*letter)))
    }

    /// The shape of the network.
    pub fn network(&self) -> Result<NetworkShape, ModelError> {
        let shape = network_shape(self.features(), &self.widths, (self.inertia, self.n()), self.activation);
        shape.ok_or(ModelError::OutOfRange { what: "number of coordinates" })
    }

    /// Numbers in the weight block.
    pub fn parameters(&self) -> Result<usize, ModelError> {
        require((1..=MAX_COORDINATES).contains(&self.n()), "number of coordinates")?;
        require(self.inertia.has_valid_rows(self.n()), "rows of the inertia matrix")?;
        self.network()?.parameters().ok_or(ModelError::OutOfRange { what: "number of weights" })
    }

    pub(super) fn validate<W: FileWeightFormat>(&self, _: &[W]) -> Result<(), ModelError> {
        require(self.letters().all(|kind| kind.is_some()), "coordinate kind")?;
        require(self.network()?.is_valid(), "hidden width")?;
        let epsilon = self.inertia.epsilon();
        require(epsilon.is_finite() && epsilon >= 0.0, "epsilon of the inertia matrix")
    }
}

/// Whether none is empty and no two are the same.
pub(super) fn are_names<'a>(names: impl Iterator<Item = &'a [u8]> + Clone) -> bool {
    let mut others = names.clone().enumerate();
    others.all(|(i, name)| !name.is_empty() && names.clone().take(i).all(|other| other != name))
}

/// Checks names that are separated by commas.
pub(super) fn check_names(names: &str, count: usize, of: &'static str) -> Result<(), ModelError> {
    // Bytes: to split a str holds a panic that the compiler cannot exclude.
    let each = names.as_bytes().split(|byte| *byte == b',');
    let none = count == 0 && names.is_empty();
    if none || (each.clone().count() == count && are_names(each)) {
        return Ok(());
    }
    Err(ModelError::Names { of })
}

/// Checks the numbers of an element type.
fn check_numbers(numbers: &[f32; modular::ELEMENT_PARAMETERS]) -> Result<(), ModelError> {
    let [mass, inertia, _, _] = *numbers;
    require(mass > 0.0, "mass of an element type")?;
    require(inertia >= 0.0, "moment of inertia of an element type")
}

pub(super) fn require(condition: bool, what: &'static str) -> Result<(), ModelError> {
    if condition { Ok(()) } else { Err(ModelError::OutOfRange { what }) }
}
