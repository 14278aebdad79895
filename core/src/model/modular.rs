use super::header::{MAX_TREE_COORDINATES, are_names, check_names, require};
use super::load_forces::load_forces;
use super::{LawNumbers, Laws, LoadForces, Model, ModelError, ParsedAs};
use crate::energy::modular::{self, Modular, TreeElement, TreeError};
use crate::expected::expected;
use crate::forces::{System, Viscous};
use crate::scalar::{FileWeightFormat, Scalar, WeightFormat};
use serde::{Deserialize, Serialize};

/// Maximum number of trees in one file.
pub const MAX_TREES: usize = 8;

/// The shape of a modular model. Types are kept apart from trees: one set of types serves many trees.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModularHeader<'a> {
    /// Shape of the networks and element types.
    pub shape: modular::ModularShape,
    /// Names of the types, separated by commas.
    pub names: &'a str,
    /// The trees, by name; the first tree without elements ends the list.
    #[serde(borrow)]
    pub trees: [TreeHeader<'a>; MAX_TREES],
}

/// A tree of elements.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TreeHeader<'a> {
    /// Name.
    pub name: &'a str,
    /// Two bytes per element: its type, then 0 if it hangs from the ground or 1 + the index of the element that it hangs from.
    pub elements: &'a [u8],
}

/// A tree of elements in N coordinates: at most `E` element types, networks of at most `L` hidden layers of at most `H` units.
///
/// `W` and `F` are as in [`InertiaNetworkModel`](super::InertiaNetworkModel).
pub type ModularModel<
    'a,
    const N: usize,
    const E: usize,
    const H: usize,
    const L: usize,
    W = f32,
    F = Viscous<f32, N>,
> = Model<'a, System<Modular<'a, W, N, E, H, L>, F>>;

impl<'a> ModularHeader<'a> {
    /// Number of coordinates of the smallest tree.
    pub fn fewest_coordinates(&self) -> usize {
        self.trees().filter_map(|tree| tree.coordinates(&self.shape)).min().unwrap_or(0)
    }

    /// The trees in order.
    pub fn trees(&self) -> impl Iterator<Item = &TreeHeader<'a>> + Clone {
        self.trees.iter().take_while(|tree| !tree.elements.is_empty())
    }

    /// Returns the tree with the given name.
    ///
    /// # Errors
    /// [`ModelError::NoSuchTree`] if there is none.
    pub fn tree(&self, name: &str) -> Result<&TreeHeader<'a>, ModelError> {
        let none = || ModelError::NoSuchTree { trees: self.trees().count() };
        self.trees().find(|tree| tree.name == name).ok_or_else(none)
    }

    /// Number of groups of coordinates, one per element type.
    pub(super) fn groups(&self) -> usize {
        self.shape.types.len()
    }

    /// Number of coordinates that every mechanism of a file has.
    pub(super) fn common_coordinates(&self) -> usize {
        self.fewest_coordinates()
    }

    /// Length of the weight block, in numbers.
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

    /// Checks a tree of any number of coordinates.
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

    /// Number of coordinates of the tree with the types of `shape`; `None` if a type does not exist.
    pub fn coordinates(&self, shape: &modular::ModularShape) -> Option<usize> {
        let of = |node: TreeElement| Some(shape.types.get(node.kind)?.coordinates());
        self.nodes().try_fold(0, |sum, node| Some(sum + of(node)?))
    }
}

impl ModularHeader<'_> {
    /// The system of a tree and these laws over a weight block in any scalar: f32 as shipped, f64 on the host, lanes in
    /// training.
    ///
    /// # Errors
    /// [`ModelError`] if the block or the compiled sizes do not fit, or the program lacks one of the laws.
    pub fn system<'w, W, S, F, const N: usize, const E: usize, const H: usize, const L: usize>(
        &self,
        tree: &TreeHeader,
        laws: Laws,
        weights: &'w [W],
    ) -> Result<System<Modular<'w, W, N, E, H, L>, F>, ModelError>
    where
        W: WeightFormat,
        S: Scalar<Weight = W::Wide>,
        F: LoadForces<'w, W, S, N>,
    {
        self.shape.check_size::<E, H, L>()?;
        let tree = self.shape.tree(tree.nodes()).map_err(ModelError::Tree)?;
        let mut block = weights;
        let needed = self.parameters()?;
        let lagrangian = Modular::take(&mut block, &self.shape, tree)
            .ok_or(ModelError::WeightCount { found: weights.len(), needed })?;
        // Coordinates of elements of the same type form a group.
        let groups = tree.kinds();
        let forces = load_forces(LawNumbers::new(laws, block, self.groups()), &groups)?;
        Ok(System { lagrangian, forces })
    }
}

impl<
    'a,
    const N: usize,
    const E: usize,
    const H: usize,
    const L: usize,
    W: FileWeightFormat,
    F: LoadForces<'a, W, f32, N>,
> ModularModel<'a, N, E, H, L, W, F>
{
    /// Reads, validates and borrows a model file, and takes the tree called `name`; `bytes` must be 4-aligned.
    ///
    /// # Errors
    /// See [`ModelError`].
    pub fn load(bytes: &'a [u8], name: &str) -> Result<Self, ModelError> {
        Self::read(bytes, F::knows, |parsed: &ParsedAs<ModularHeader, W>| {
            let tree = parsed.shape.tree(name)?;
            let first = parsed.shape.trees().next().is_some_and(|first| first.name == name);
            Ok((parsed.shape.system(tree, parsed.laws, parsed.weights)?, first))
        })
    }
}

/// Checks the numbers of an element type.
fn check_numbers(numbers: &[f32; modular::ELEMENT_PARAMETERS]) -> Result<(), ModelError> {
    let [mass, inertia, _, _] = *numbers;
    require(mass > 0.0, "mass of an element type")?;
    require(inertia >= 0.0, "moment of inertia of an element type")
}
