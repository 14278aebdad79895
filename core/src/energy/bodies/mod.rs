//! Trees of rigid bodies on joints, in the plane.
//!
//! The frame of a body sits at its joint and is rotated by the sum of all joint angles up to its own; a revolute joint adds q to the angle,
//! a prismatic one moves the frame by q along its x axis. With the centre of mass x of a body, its angle φ, the acceleration of gravity γ,
//! and the rotor of a drive that sits on the parent and turns g times as fast as the joint,
//!
//! T = Σ ½m|ẋ|² + ½I φ̇² + ½J(φ̇_parent + g q̇)²,  V = −Σ m γ·x.

mod inertia;
mod motion;
mod parameters;
mod vector;

pub use super::modular::TreeError;
pub use super::multibody::{Bodies, BodyTree, Joint, TreeBody};
pub use inertia::{PLANAR_INERTIAL_PARAMETERS, PlanarInertia};
pub use parameters::{BODY_PARAMETERS, BodyParameters, GRAVITY_PARAMETERS};
pub use vector::Vector;

/// A tree of N rigid bodies on joints in the plane: γ and the [`BodyParameters`] of every body.
pub type PlanarBodies<'a, W, const N: usize> = Bodies<'a, W, GRAVITY_PARAMETERS, BODY_PARAMETERS, N>;
