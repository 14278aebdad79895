//! Networks, their derivatives and the arithmetic below them.

#[path = "../common/mod.rs"]
mod common;

mod componentwise;
mod extremes;
mod micro;
mod network;
mod precision;
mod scalar;
