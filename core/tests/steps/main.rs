//! Discrete steps: convergence, order, conservation, rods.

#[path = "../common/mod.rs"]
mod common;

mod conservation;
mod coulomb_bodies;
mod coulomb_steps;
mod derivative;
mod forced_order;
mod interval;
mod newton;
mod order;
mod rattle;
mod rattle_order;
mod rattle_start;
mod rattle_state;
mod rattle_sticking;
mod sticking;
mod stops;
