//! Exact motions, and predictions measured against them.

mod exact_motion;
mod modlanet_protocol;
mod prediction;
mod truss;
