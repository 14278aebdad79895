//! One trajectory, one fingerprint: the f32 arithmetic is the same at every optimisation level and vector width, and on every target
//! (`firmware-sim/chip/run.sh`).

use leastaction_core::discrete::{Del, Midpoint};
use leastaction_firmware_sim::trajectory::reference::{STEP, newton};
use leastaction_firmware_sim::trajectory::{Fingerprint, Motion, SystemMotion};
use leastaction_tests::Reference;

/// Fingerprints after [`Reference::steps`], from `cargo run --release -p leastaction-tests --bin trajectory_hash`.
const EXPECTED: [(&str, u8, u64); 17] = [
    ("inertia-network", 2, 0xb71d_c8e9_d362_0964),
    ("inertia-network", 4, 0x4c97_2f12_2ed9_ed3f),
    ("modular", 2, 0xaffa_1254_3be8_c2ee),
    ("modular", 4, 0xcd6d_7c08_f89e_170e),
    ("graph", 2, 0xf2cd_73a9_1647_306a),
    ("graph", 4, 0x7753_1922_2e73_700a),
    ("bodies", 2, 0x8a14_fd4f_5d4c_7be4),
    ("bodies", 4, 0x648f_3168_8112_8fbe),
    ("inertia-network-f16", 2, 0x8596_c215_b354_eafd),
    ("inertia-network-dry", 2, 0xf17a_3e8e_bb3c_6a48),
    ("adapting", 2, 0x6d37_ef9c_63ca_8595),
    ("bodies-dry", 2, 0xbeb8_d63f_0ebb_d76c),
    ("bodies-dry", 4, 0xd717_bb99_bcea_9bf9),
    ("arm", 2, 0x018f_83a2_81ac_dd93),
    ("arm", 4, 0x2f95_6e0c_9e25_fdc0),
    ("bodies-sticking", 2, 0x4843_e50a_c470_c24a),
    ("bodies-sticking", 4, 0x99f2_322e_d4ce_f2ca),
];

#[test]
fn every_family_and_order_has_its_fingerprint() {
    std::thread::scope(|scope| {
        for ((family, order, expected), reference) in EXPECTED.into_iter().zip(Reference::all()) {
            assert_eq!((family, order), (reference.family, reference.order));
            scope.spawn(move || {
                assert_eq!(reference.hash(reference.steps()), Ok(expected), "{family} {order}")
            });
        }
    });
}

#[test]
fn elementary_functions_have_their_fingerprint() {
    assert_eq!(Fingerprint::of_elementary_functions().value(), 0x2e88_9d71_6010_1587);
}

/// The trace of the cart that sticks has all that its laws do: the cart rests, slides, and ends on both stops.
#[test]
fn the_cart_between_stops_sticks_and_strikes() {
    let model = leastaction_tests::sticking_bodies().unwrap();
    let mut motion =
        SystemMotion::new(&model.system, Del::<f32, Midpoint>::with_newton(STEP, newton())).unwrap();
    let (mut before, mut rests, mut strikes, mut slides) = (f32::NAN, 0, [0; 2], 0);
    for index in 0..1_000 {
        motion.step(index).unwrap();
        let mut cart = None;
        motion.positions(|x| _ = *cart.get_or_insert(x));
        let (q, limits) = (cart.unwrap(), [0.0625, 0.125]);
        assert!((limits[0]..=limits[1]).contains(&q), "{q}");
        for (count, limit) in strikes.iter_mut().zip(limits) {
            *count += usize::from(q == limit && before != limit);
        }
        rests += usize::from(q == before && !limits.contains(&q));
        slides += usize::from(q != before);
        before = q;
    }
    assert!(
        rests > 20 && strikes.iter().all(|count| *count > 2) && slides > 200,
        "{rests} {strikes:?} {slides}"
    );
}

/// The command `sticking_model firmware-sim/chip/models/cartpole-sticking.postcard` wrote the file.
#[test]
fn the_cart_between_stops_is_as_its_program_writes_it() {
    let file = include_bytes!("../../firmware-sim/chip/models/cartpole-sticking.postcard");
    assert_eq!(leastaction_tests::sticking::model_file().as_deref(), Ok(&file[..]));
}

/// The command `arm_model firmware-sim/chip/models/arm.postcard` wrote the file.
#[test]
fn the_arm_of_the_chip_is_as_its_program_writes_it() {
    let file = include_bytes!("../../firmware-sim/chip/models/arm.postcard");
    assert_eq!(leastaction_tests::arm::model_file().as_deref(), Ok(&file[..]));
}
