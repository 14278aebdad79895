//! One trajectory, one hash: the f32 arithmetic is the same at every optimisation level and vector width.

use leastaction_core::discrete::{Galerkin, Midpoint};
use leastaction_tests::trajectory_hash;

#[test]
fn order_2_has_its_hash() {
    assert_eq!(trajectory_hash::<Midpoint>(100_000), Ok(0x196f_a15a_5243_67d7));
}

#[test]
fn order_4_has_its_hash() {
    assert_eq!(trajectory_hash::<Galerkin>(100_000), Ok(0xeac2_62df_1479_c09c));
}
