//! Which element hangs from which, and the two linear maps of a tree: from the coordinates' displacements to the elements'
//! centres, and back from forces on the centres to the coordinates.

use core::fmt;

use crate::expected::expected;
use crate::scalar::Scalar;

/// Dimensions of the space that elements lie in.
pub const SPACE: usize = 2;
/// A point or a direction of that space.
pub type Vector<S> = [S; SPACE];

/// One element of a tree, as it is described.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TreeElement {
    /// Which type the element is of.
    pub kind: u8,
    /// The element that it hangs from, described before it; `None`: the ground.
    pub parent: Option<u8>,
}

/// Why a tree was refused.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum TreeError {
    /// No element.
    Empty,
    /// An element hangs from itself or from one that is described later, which a cycle always makes.
    Parent {
        /// The element, from 0.
        element: usize,
        /// What it hangs from.
        parent: usize,
    },
    /// An element is of a type that does not exist.
    Kind {
        /// The element, from 0.
        element: usize,
        /// The type it names.
        kind: usize,
        /// Types there are.
        kinds: usize,
    },
    /// The elements do not have the number of coordinates that was compiled in.
    Coordinates {
        /// Of the tree.
        found: usize,
        /// Compiled in.
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

/// One element with its place among the coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Element {
    pub kind: usize,
    pub parent: Option<usize>,
    /// The first of its coordinates, and how many it has.
    pub first: usize,
    pub count: usize,
}

/// A tree of elements with N coordinates in all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tree<const N: usize> {
    elements: [Option<Element>; N],
}

impl<const N: usize> Tree<N> {
    /// A tree of elements, parents first. `coordinates(kind)` is the number of coordinates, at least 1, that an element of a
    /// type has; `None` for a type that does not exist, of `kinds`.
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

    /// Always false: a tree has an element.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The elements in order, with their numbers.
    #[inline(always)]
    pub(super) fn elements(&self) -> impl DoubleEndedIterator<Item = (usize, &Element)> {
        self.elements.iter().enumerate().filter_map(|(e, element)| Some((e, element.as_ref()?)))
    }

    /// From what each coordinate adds to everything that its element carries, to the displacement of every element's
    /// centre: the sum along the way from the ground, of which the element's own part counts `centre[e]` times.
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

    /// The transpose of [`Tree::centres`]: from forces on the elements' centres to what acts on each coordinate's
    /// displacement.
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
    /// The sum of what its own coordinates give.
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
