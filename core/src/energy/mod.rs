//! Families of energies: each gives a [`Lagrangian`](crate::lagrangian::Lagrangian).
//!
//! - [`rigid`]: inertia matrix and potential from one network (SyMo, L-NODE, DeLaN);
//! - [`trigonometric`]: exact mechanisms whose inertia and potential are sums of cosines: references and plants.

pub mod rigid;
pub mod trigonometric;
