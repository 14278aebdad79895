//! Models of every family: from a configuration to training.

mod arms;
mod bodies;
mod control;
mod corrections;
mod coverage;
mod documented_bodies;
mod documented_graphs;
mod documented_trees;
mod free_states;
mod friction;
mod friction_config;
mod graph_config;
mod graphs;
mod next_state;
mod page;
mod rods;
mod servo;
mod start_from;
mod stops;
mod trees;
mod units;
mod windows;
