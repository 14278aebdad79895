//! The tree of elements and its two linear maps: from the coordinates' displacements to the elements' centres, and back from forces on the
//! centres to the coordinates.

use core::fmt;

use crate::expected::expected;
use crate::scalar::Scalar;

/// Number of dimensions of the elements' space.
pub const SPACE: usize = 2;
/// A point or a direction in that space.
pub type Vector<S> = [S; SPACE];

/// Description of one element of a tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TreeElement {
    /// Type of the element.
    pub kind: u8,
    /// The element that this one hangs from, which is described earlier; `None`: the ground.
    pub parent: Option<u8>,
}

/// Reason for refusing a tree.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum TreeError {
    /// The tree has no elements.
    Empty,
    /// An element hangs from itself or from one described later; every cycle contains such an element.
    Parent {
        /// The element, from 0.
        element: usize,
        /// The element that it hangs from.
        parent: usize,
    },
    /// An element is of a type that does not exist.
    Kind {
        /// The element, from 0.
        element: usize,
        /// The type that the element names.
        kind: usize,
        /// Number of element types.
        kinds: usize,
    },
    /// The elements do not have the number of coordinates that was compiled in.
    Coordinates {
        /// Coordinates of the tree.
        found: usize,
        /// Coordinates compiled in.
        compiled: usize,
    },
}

impl fmt::Display for TreeError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Empty => write!(f, "a tree without elements"),
            Self::Parent { element, parent } => write!(
                f,
                "element {element} hangs from element {parent}, which does not come before it (a cycle?): list parents first"
            ),
            Self::Kind { element, kind, kinds } => {
                write!(f, "element {element} is of type {kind}, but there are only {kinds} types (from 0)")
            }
            Self::Coordinates { found, compiled } => {
                write!(f, "a tree of {found} coordinates, but this program was compiled for {compiled}")
            }
        }
    }
}

impl core::error::Error for TreeError {}

/// An element with the range of its coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Element {
    pub kind: usize,
    pub parent: Option<usize>,
    /// Index of the first coordinate, and number of coordinates.
    pub first: usize,
    pub count: usize,
}

/// A tree of elements with N coordinates in total.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tree<const N: usize> {
    elements: [Option<Element>; N],
}

impl<const N: usize> Tree<N> {
    /// Creates a tree of elements, parents first. `coordinates(kind)` is the number of coordinates of an element of that type, at least 1;
    /// `None` for a type that does not exist. `kinds` is the number of types.
    ///
    /// # Errors
    /// See [`TreeError`].
    pub fn new(
        nodes: impl IntoIterator<Item = TreeElement>,
        kinds: usize,
        coordinates: impl Fn(usize) -> Option<usize>,
    ) -> Result<Self, TreeError> {
        let mut elements = [None; N];
        let (mut total, mut slots) = (0usize, elements.iter_mut());
        for (e, node) in nodes.into_iter().enumerate() {
            let (kind, parent) = (usize::from(node.kind), node.parent.map(usize::from));
            if let Some(parent) = parent.filter(|parent| *parent >= e) {
                return Err(TreeError::Parent { element: e, parent });
            }
            let count = coordinates(kind).ok_or(TreeError::Kind { element: e, kind, kinds })?;
            let element = Element { kind, parent, first: total, count };
            total = total.saturating_add(count);
            if let Some(slot) = slots.next() {
                *slot = Some(element);
            }
        }
        match total {
            0 => Err(TreeError::Empty),
            total if total == N => Ok(Self { elements }),
            found => Err(TreeError::Coordinates { found, compiled: N }),
        }
    }

    /// Number of elements.
    pub fn len(&self) -> usize {
        self.elements().count()
    }

    /// The element type of every coordinate.
    pub fn kinds(&self) -> [u8; N] {
        let mut kinds = [0; N];
        for (_, element) in self.elements() {
            for slot in kinds.iter_mut().skip(element.first).take(element.count) {
                *slot = element.kind as u8;
            }
        }
        kinds
    }

    /// Always false: a tree has at least one element.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The elements in order, with their indices.
    #[inline(always)]
    pub(super) fn elements(&self) -> impl DoubleEndedIterator<Item = (usize, &Element)> {
        self.elements.iter().enumerate().filter_map(|(e, element)| Some((e, element.as_ref()?)))
    }

    /// Maps the displacements that the coordinates add to the displacement of every element's centre: the sum
    /// along the path from the ground, in which the element's own part is multiplied by `centre[e]`.
    #[inline]
    pub(super) fn centres<S: Scalar>(&self, centre: &[S; N], moved: &[Vector<S>; N]) -> [Vector<S>; N] {
        let mut tips = [[S::zero(); SPACE]; N];
        let mut centres = tips;
        for (e, element) in self.elements() {
            let ground = [S::zero(); SPACE];
            let base = element.parent.map_or(ground, |parent| expected(tips.get(parent).copied(), ground));
            let own = element.own(moved);
            if let (Some(tip), Some(slot), Some(centre)) =
                (tips.get_mut(e), centres.get_mut(e), centre.get(e))
            {
                *tip = add(&base, &own);
                *slot = add(&base, &scale(*centre, &own));
            }
        }
        centres
    }

    /// The transpose of [`Tree::centres`]: maps forces on the elements' centres to forces on each coordinate's displacement.
    #[inline]
    pub(super) fn joints<S: Scalar>(&self, centre: &[S; N], force: &[Vector<S>; N]) -> [Vector<S>; N] {
        let mut carried = [[S::zero(); SPACE]; N];
        let mut joints = carried;
        for (e, element) in self.elements().rev() {
            let (Some(force), Some(centre), Some(load)) =
                (force.get(e), centre.get(e), carried.get(e).copied())
            else {
                continue;
            };
            let own = add(&scale(*centre, force), &load);
            for joint in joints.iter_mut().skip(element.first).take(element.count) {
                *joint = own;
            }
            if let Some(below) = element.parent.and_then(|parent| carried.get_mut(parent)) {
                *below = add(&add(below, force), &load);
            }
        }
        joints
    }
}

impl Element {
    /// Sum of the displacements of the element's own coordinates.
    #[inline(always)]
    pub fn own<S: Scalar, const N: usize>(&self, moved: &[Vector<S>; N]) -> Vector<S> {
        let own = moved.iter().skip(self.first).take(self.count);
        own.fold([S::zero(); SPACE], |sum, x| add(&sum, x))
    }
}

/// a + b.
#[inline(always)]
pub(super) fn add<S: Scalar>(a: &Vector<S>, b: &Vector<S>) -> Vector<S> {
    [a[0] + b[0], a[1] + b[1]]
}

/// ca.
#[inline(always)]
pub(super) fn scale<S: Scalar>(c: S, a: &Vector<S>) -> Vector<S> {
    [c * a[0], c * a[1]]
}
