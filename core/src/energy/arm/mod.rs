//! Trees of rigid bodies on joints, in space.
//!
//! A revolute joint rotates the body's frame by q about a unit axis a of the joint's frame, a prismatic one shifts it by q along a. The
//! joint's frame has a constant pose in the parent's frame, x_parent = Rx + p at q = 0. With the angular velocity ω of a body and the
//! velocity ṙ of its origin, its mass m, first moments mc and inertia I about that origin, the acceleration of gravity γ, and the rotor
//! inertia J reflected to the joint,
//!
//! T = Σ ½m|ṙ|² + ṙ·(ω × mc) + ½ω·Iω + ½Jq̇²,  V = −Σ γ·(mr + mc).
//!
//! Sources: Featherstone, *Rigid Body Dynamics Algorithms*, 2008 (recursions); Carpentier and Mansard, *Analytical derivatives of
//! rigid body dynamics algorithms*, 2018, and Singh, Russell and Wensing, 2022 (their derivatives).

mod bodies;
mod body;
mod derivatives;
mod forward;
mod inertia;
mod links;
mod motion;
mod parameters;
mod vector;

pub use super::modular::TreeError;
pub use super::multibody::{Bodies, BodyTree, Joint, TreeBody};
pub use bodies::ArmBodies;
pub use derivatives::InverseDynamicsDerivatives;
pub use inertia::{BodyInertia, INERTIAL_PARAMETERS};
pub use parameters::{ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS, ArmParameters};
pub use vector::{Rotation, Vector};
