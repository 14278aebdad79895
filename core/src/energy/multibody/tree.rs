//! The tree of bodies: parent and joint of every body.

use crate::energy::modular::TreeError;
use serde::{Deserialize, Serialize};

/// Motion of a body on its parent.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Joint {
    /// The body rotates about the origin of the joint's frame, in space about the joint's axis; q is an angle, rad.
    Revolute,
    /// The body slides along the x axis of the joint's frame, in space along the joint's axis; q is a length, m.
    Prismatic,
}

/// One body of a tree; it has one coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TreeBody {
    /// Joint between the body and its parent.
    pub joint: Joint,
    /// The body that the joint sits on, which is described earlier; `None`: the ground.
    pub parent: Option<u8>,
}

/// A tree of N bodies, parents first; the coordinates are in the order of the bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BodyTree<const N: usize> {
    bodies: [TreeBody; N],
}

impl<const N: usize> BodyTree<N> {
    /// Creates a tree of the given bodies.
    ///
    /// # Errors
    /// [`TreeError::Empty`], [`TreeError::Parent`] and [`TreeError::Coordinates`], whose elements are the bodies.
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
