//! Which body hangs from which, by what joint, and the numbers of a body.

use super::{TreeError, Vector};
use serde::{Deserialize, Serialize};

/// How a body moves on its parent.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Joint {
    /// It turns about the origin of the joint's frame, in space about the joint's axis; q is an angle, rad.
    Revolute,
    /// It slides along the x axis of the joint's frame, in space along the joint's axis; q is a length, m.
    Prismatic,
}

/// One body of a tree; it has one coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TreeBody {
    /// How it moves on its parent.
    pub joint: Joint,
    /// The body that its joint sits on, described before it; `None`: the ground.
    pub parent: Option<u8>,
}

/// Components of the acceleration of gravity γ, m/s², which come first in the weight block.
pub const GRAVITY_PARAMETERS: usize = 2;
/// Number of [`BodyParameters`] of a body.
pub const BODY_PARAMETERS: usize = 9;

/// The numbers of a body, in the order of the weight block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyParameters<S> {
    /// Where the joint sits in the parent's frame, m.
    pub place: Vector<S>,
    /// How far the joint's frame is turned from the parent's, rad.
    pub angle: S,
    /// m > 0, kg.
    pub mass: S,
    /// The centre of mass in the body's frame, m.
    pub centre: Vector<S>,
    /// I > 0 about the centre of mass, kg m².
    pub inertia: S,
    /// J ≥ 0 of the rotor that drives the joint and sits on the parent, kg m².
    pub rotor: S,
    /// g: the rotor turns g q̇ against the parent; 1, or 1/m of a prismatic joint.
    pub gear: S,
}

impl<S> BodyParameters<S> {
    /// In the order of the weight block.
    pub fn from_array(numbers: [S; BODY_PARAMETERS]) -> Self {
        let [x, y, angle, mass, centre_x, centre_y, inertia, rotor, gear] = numbers;
        Self { place: [x, y], angle, mass, centre: [centre_x, centre_y], inertia, rotor, gear }
    }

    /// The same as the weight block has them.
    pub fn into_array(self) -> [S; BODY_PARAMETERS] {
        let Self { place: [x, y], angle, mass, centre: [centre_x, centre_y], inertia, rotor, gear } = self;
        [x, y, angle, mass, centre_x, centre_y, inertia, rotor, gear]
    }
}

/// A tree of N bodies, parents first; the coordinates are in the order of the bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BodyTree<const N: usize> {
    bodies: [TreeBody; N],
}

impl<const N: usize> BodyTree<N> {
    /// The tree of these bodies.
    ///
    /// # Errors
    /// [`TreeError::Empty`], [`TreeError::Parent`] and [`TreeError::Coordinates`]; their elements are the bodies.
    pub fn new(bodies: impl IntoIterator<Item = TreeBody>) -> Result<Self, TreeError> {
        let mut tree = Self { bodies: [TreeBody { joint: Joint::Revolute, parent: None }; N] };
        let (mut found, mut slots) = (0, tree.bodies.iter_mut());
        for (element, body) in bodies.into_iter().enumerate() {
            if let Some(parent) = body.parent.map(usize::from).filter(|parent| *parent >= element) {
                return Err(TreeError::Parent { element, parent });
            }
            found += 1;
            if let Some(slot) = slots.next() {
                *slot = body;
            }
        }
        match found {
            0 => Err(TreeError::Empty),
            found if found == N => Ok(tree),
            found => Err(TreeError::Coordinates { found, compiled: N }),
        }
    }

    /// The bodies, in order.
    pub fn bodies(&self) -> &[TreeBody; N] {
        &self.bodies
    }
}
