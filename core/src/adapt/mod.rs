//! Adaptation: chosen numbers of a model follow the machine while it runs.
//!
//! A model that was learned is right until the gripper takes something or the grease warms up. Over a window, the balance of momentum
//!
//! p(t₁) − p(t₀) = ∫ (L_q + Q + τ) dt
//!
//! is linear in many numbers π of the model — the inertial numbers of a body, rotors, friction, offsets and gains of drives — and contains
//! no acceleration. A balance takes it over windows of a smooth weight, [`Filter`] estimates from it how far the numbers are from those of
//! the file, with their standard errors, and forgets only what is excited.

mod filter;

pub use filter::{Filter, Innovation, Measurement};
