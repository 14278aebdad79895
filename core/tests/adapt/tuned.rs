//! A model in memory whose numbers are changed.

use crate::common::manipulator;
use leastaction_core::adapt::{Number, Tunable};
use leastaction_core::energy::arm::{ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS};
use leastaction_core::forces::{Coefficient, Coulomb, Forces, Viscous};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::model::{ArmHeader, ModelError, Tuned, parse_as};

type Laws = (Viscous<f32, 3>, Coulomb<f32, 3>);
/// Gravity, three bodies, damping, and dry friction with four numbers a joint; two places are left over.
const K: usize = ARM_GRAVITY_PARAMETERS + 3 * ARM_PARAMETERS + 3 + 12 + 2;
type Arm<'f> = Tuned<'f, Laws, ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS, 3, K>;

const NUMBERS: [Number; 4] = [
    Number::Inertia { body: 2, index: 0 },
    Number::Rotor(1),
    Number::Friction(Coefficient::Viscous, 2),
    Number::Friction(Coefficient::Coulomb, 0),
];

/// Bytes at an address that is a multiple of four.
fn aligned(bytes: &[u8]) -> Vec<u32> {
    bytes
        .chunks(4)
        .map(|four| u32::from_ne_bytes(core::array::from_fn(|i| *four.get(i).unwrap_or(&0))))
        .collect()
}

fn with_arm(check: impl FnOnce(Arm)) {
    let bytes = manipulator::with_friction();
    let words = aligned(&bytes);
    let file = &bytemuck::cast_slice(&words)[..bytes.len()];
    let parsed = parse_as::<ArmHeader, f32>(file).expect("a file");
    check(Tuned::new(&parsed, parsed.shape.tree().expect("a tree")).expect("a model"));
}

#[test]
fn numbers_of_the_file_are_read() {
    with_arm(|arm| {
        let of = |number| arm.value(number);
        assert_eq!(NUMBERS.map(of), [Some(0.5), Some(0.25), Some(0.0), Some(0.5)]);
        assert_eq!(of(Number::Offset(0)), None);
        assert_eq!(of(Number::Friction(Coefficient::Sticking, 0)), None);
        assert_eq!(of(Number::Friction(Coefficient::Coulomb, 3)), None);
    });
}

#[test]
fn changed_numbers_act_and_the_file_stays() {
    with_arm(|mut arm| {
        let (q, v, tau) = ([0.3, -0.2, 0.5], [0.4, 0.7, -0.6], [0.1, 0.2, 0.3]);
        let before = arm.of_file().lagrangian.gradient(&q, &v);
        assert_eq!(arm.in_use().lagrangian.gradient(&q, &v), before);
        arm.set(&NUMBERS, &[1.5, 0.25, 0.125, 0.25]);
        let (used, file) = (arm.in_use(), arm.of_file());
        assert_eq!(used.lagrangian.numbers[2][15], 2.0);
        assert_eq!(used.lagrangian.numbers[1][25], 0.5);
        assert_eq!(used.forces.0.coefficients[2], 0.125);
        assert_eq!(used.forces.1.coordinates[0].constant, 0.75);
        assert_ne!(used.lagrangian.gradient(&q, &v), before);
        assert_ne!(used.forces.force(&q, &v, &tau), file.forces.force(&q, &v, &tau));
        assert_eq!(file.lagrangian.gradient(&q, &v), before);
        arm.set(&NUMBERS, &[0.0; 4]);
        assert_eq!(arm.in_use().lagrangian.gradient(&q, &v), before);
        assert_eq!(arm.in_use().forces, arm.of_file().forces);
    });
}

#[test]
fn a_longer_block_is_refused() {
    let bytes = manipulator::with_friction();
    let words = aligned(&bytes);
    let file = &bytemuck::cast_slice(&words)[..bytes.len()];
    let parsed = parse_as::<ArmHeader, f32>(file).expect("a file");
    let tree = parsed.shape.tree::<3>().expect("a tree");
    let short = Tuned::<Laws, ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS, 3, { K - 3 }>::new(&parsed, tree);
    assert_eq!(short.map(|_| ()), Err(ModelError::WeightCount { found: K - 2, needed: K - 3 }));
}
