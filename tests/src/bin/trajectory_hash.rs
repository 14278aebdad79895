//! Prints the hash of a fixed f32 trajectory of each order; `.ci/run` compares it between optimisation levels.

use leastaction_core::discrete::{Galerkin, Midpoint};
use leastaction_tests::trajectory_hash;

fn main() {
    let steps = 100_000;
    println!("order 2: {:016x?}", trajectory_hash::<Midpoint>(steps));
    println!("order 4: {:016x?}", trajectory_hash::<Galerkin>(steps));
}
