//! Energies, forces and constraints against plain formulas and exact derivatives.

#[path = "../common/mod.rs"]
mod common;

mod arms;
mod bodies;
mod columns;
mod constraints;
mod continuous;
mod coulomb;
mod directional;
mod forces;
mod graph;
mod graph_union;
mod inertia_network;
mod modular;
mod network_laws;
mod servo;
mod trigonometric;
