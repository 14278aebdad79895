//! Adaptation of a model's numbers against dense algebra, exact motions and statistics.

#[path = "../common/mod.rs"]
mod common;

mod blocks;
mod catalogue;
mod filter;
mod limits;
mod motion;
mod networks;
mod patch;
mod settings;
mod tuned;
mod verdict;
