//! Families of energies, each of which implements [`Lagrangian`](crate::lagrangian::Lagrangian). They give no
//! derivatives with respect to the weights: training takes those from programs of the same energies.
//!
//! - [`inertia_network`]: inertia matrix and potential from one network (SyMo, L-NODE, DeLaN);
//! - [`bodies`]: trees of rigid bodies on joints in the plane, given by masses, lengths and inertias;
//! - [`arm`]: trees of rigid bodies on joints in space;
//! - [`modular`]: a tree of reusable elements (ModLaNet);
//! - [`graph`]: any number of particles with potentials of single nodes, of pairs and of messages (LGNN);
//! - [`trigonometric`]: exact mechanisms whose inertia and potential are sums of cosines, for references and plants.

pub mod arm;
pub mod bodies;
mod distance;
pub mod graph;
pub mod inertia_network;
mod list;
pub mod modular;
mod multibody;
mod network_shape;
mod pull_back;
pub mod trigonometric;

pub use list::List;
pub use network_shape::{MAX_HIDDEN, NetworkShape, SizeError};
