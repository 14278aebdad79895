//! One trajectory, one fingerprint: the f32 arithmetic is the same at every optimisation level and vector width, and on every
//! target (`firmware-sim/chip/run.sh`).

use leastaction_tests::Reference;

/// After 100,000 steps; by `cargo run --release -p leastaction-tests --bin trajectory_hash`.
const EXPECTED: [(&str, u8, u64); 7] = [
    ("rigid", 2, 0xa547_80e5_a3c3_76ad),
    ("rigid", 4, 0xaa37_a525_7f40_2399),
    ("modular", 2, 0xc717_13c9_063f_7ac3),
    ("modular", 4, 0x90e6_5862_bd7f_f989),
    ("graph", 2, 0xd551_a4d4_1d18_c57a),
    ("graph", 4, 0x73b5_29b4_b177_5cb6),
    ("rigid-f16", 2, 0xd900_8b72_d062_0d1d),
];

#[test]
fn every_family_and_order_has_its_fingerprint() {
    for ((family, order, expected), reference) in EXPECTED.into_iter().zip(Reference::all()) {
        assert_eq!((family, order), (reference.family, reference.order));
        assert_eq!(reference.hash(100_000), Ok(expected), "{family} {order}");
    }
}
