//! A firmware whose model follows what its arm carries: it finds a load, and no input takes the numbers out of their limits or keeps them there.

use leastaction_core::adapt::{Number, Patch};
use leastaction_core::model::fingerprint;
use leastaction_firmware_sim::Processor;
use leastaction_firmware_sim::control::Target;
use leastaction_firmware_sim::trajectory::carrying::{AdaptingArm, ArmTuning, Carrying, adapting, tuning};
use proptest::prelude::*;

#[repr(align(4))]
struct Aligned<T: ?Sized>(T);
static ARM: &Aligned<[u8]> = &Aligned(*include_bytes!("../../chip/models/arm.postcard"));

const N: usize = 7;
/// Attached mass, kg.
const LOAD: f32 = 1.5;

type Arm<'f> = Carrying<'f, AdaptingArm<'f>>;

fn arm(tuning: &ArmTuning) -> Arm<'_> {
    Carrying::new(&ARM.0, adapting(&ARM.0, tuning).expect("a firmware")).expect("an arm")
}

/// Takes ticks whose readings and whose elapsed time are changed by `disturb`.
fn ticks(
    arm: &mut Arm,
    ticks: core::ops::Range<u32>,
    mut disturb: impl FnMut(u32, &mut [Option<f32>; N]) -> u32,
) {
    for index in ticks {
        let run = |firmware: &mut AdaptingArm, measured: &[Option<f32>; N], target: &_| {
            let mut measured = *measured;
            let elapsed = disturb(index, &mut measured);
            let Ok(outcome) = firmware.run(elapsed, &measured, target);
            (outcome, ())
        };
        arm.tick(index, run).expect("a step");
    }
}

fn undisturbed(_: u32, _: &mut [Option<f32>; N]) -> u32 {
    1
}

/// Whether the numbers in use are within their limits.
fn within(arm: &Arm, tuning: &ArmTuning) -> bool {
    let limits = tuning.limits.lower.iter().zip(&tuning.limits.upper);
    arm.firmware
        .adapter()
        .applied()
        .iter()
        .zip(limits)
        .all(|(used, (lower, upper))| (*lower..=*upper).contains(used))
}

fn mass(arm: &Arm) -> f32 {
    arm.firmware.adapter().applied()[0]
}

#[test]
fn a_load_is_found_and_saved() {
    let tuning = tuning(&ARM.0).expect("a tuning");
    let mut first = arm(&tuning);
    ticks(&mut first, 0..1_500, undisturbed);
    assert!((mass(&first) - LOAD).abs() < 0.03 * LOAD, "{} kg", mass(&first));
    let model = fingerprint(&ARM.0).expect("a model");
    let (patch, mut memory) = (first.firmware.patch(model), [0; 256]);
    let bytes = patch.write(&mut memory).expect("room");
    let read = Patch::read(bytes, model).expect("a patch");
    assert_eq!(read.numbers[0].number, Number::Inertia { body: 6, index: 0 });
    let mut second = arm(&tuning);
    second.firmware.reset(Some(&read)).expect("numbers");
    assert_eq!(second.firmware.adapter().applied(), first.firmware.adapter().applied());
    ticks(&mut second, 0..200, undisturbed);
    assert!((mass(&second) - LOAD).abs() < 0.1 * LOAD, "{} kg", mass(&second));
    second.firmware.reset(None).expect("numbers");
    assert_eq!(mass(&second), 0.0);
}

#[test]
fn frozen_numbers_stay_and_go_on_from_there() {
    let tuning = tuning(&ARM.0).expect("a tuning");
    let mut arm = arm(&tuning);
    ticks(&mut arm, 0..300, undisturbed);
    let before = *arm.firmware.adapter();
    arm.firmware.frozen = true;
    ticks(&mut arm, 300..600, undisturbed);
    assert_eq!(arm.firmware.adapter().applied(), before.applied());
    assert_eq!(arm.firmware.adapter().filter(), before.filter());
    arm.firmware.frozen = false;
    let mut last = *before.applied();
    for index in 600..700 {
        ticks(&mut arm, index..index + 1, undisturbed);
        let used = *arm.firmware.adapter().applied();
        let moved = used.iter().zip(last).zip(tuning.prior).map(|((a, b), prior)| (a - b).abs() / prior);
        assert!(moved.fold(0.0, f32::max) < 0.1, "the numbers jump");
        last = used;
    }
}

/// Drives that weaken, saturate, or push: nothing that the numbers could be explains it.
#[test]
fn weak_drives_do_not_last() {
    let tuning = tuning(&ARM.0).expect("a tuning");
    let drives: [fn(f32) -> f32; 3] = [|u| 0.25 * u, |u| u.clamp(-5.0, 5.0), |u| u + 3.0];
    for drive in drives {
        let mut arm = arm(&tuning);
        ticks(&mut arm, 0..200, undisturbed);
        for index in 200..500 {
            let run = |firmware: &mut AdaptingArm, measured: &[Option<f32>; N], target: &_| {
                let Ok(mut outcome) = firmware.run(1, measured, target);
                outcome.command.u = outcome.command.u.map(drive);
                (outcome, ())
            };
            arm.tick(index, run).expect("a step");
            assert!(within(&arm, &tuning), "{:?}", arm.firmware.adapter().applied());
        }
        ticks(&mut arm, 500..2_000, undisturbed);
        assert!((mass(&arm) - LOAD).abs() < 0.1 * LOAD, "{} kg", mass(&arm));
    }
}

/// Nothing that is learned at rest is forgotten there, and nothing is known less than at first.
#[test]
fn rest_changes_little() {
    let tuning = tuning(&ARM.0).expect("a tuning");
    let mut arm = arm(&tuning);
    ticks(&mut arm, 0..1_000, undisturbed);
    let found = mass(&arm);
    let rest = Target::of(&arm.position(), 0.0, 1.0);
    for index in 1_000..4_000 {
        let run = |firmware: &mut AdaptingArm, measured: &[Option<f32>; N], _: &_| {
            let Ok(outcome) = firmware.run(1, measured, &rest);
            (outcome, ())
        };
        arm.tick(index, run).expect("a step");
    }
    assert!((mass(&arm) - found).abs() < 0.03 * found, "{} kg, {found} kg in motion", mass(&arm));
    let filter = arm.firmware.adapter().filter();
    for (j, prior) in tuning.prior.iter().enumerate() {
        assert!(filter.variance(j) < 1.1 * prior * prior, "number {j}");
    }
}

/// A reading as a damaged encoder, cable or bus may give it.
fn reading() -> impl Strategy<Value = Option<f32>> {
    prop_oneof![
        Just(None),
        Just(Some(f32::NAN)),
        Just(Some(f32::INFINITY)),
        Just(Some(f32::MAX)),
        (-1e6_f32..1e6).prop_map(Some),
        (-7.0_f32..7.0).prop_map(Some),
    ]
}

/// A tick: which coordinate reads wrong, if any does, what it reads, and the ticks that have passed.
fn disturbance() -> impl Strategy<Value = (Option<usize>, Option<f32>, u32)> {
    let coordinate = prop_oneof![4 => Just(None), 1 => (0..N).prop_map(Some)];
    let elapsed = prop_oneof![20 => Just(1_u32), 1 => 0_u32..4, 1 => Just(u32::MAX)];
    (coordinate, reading(), elapsed)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]
    /// Whatever is read, the numbers in use stay within their limits, and come back when the readings are right again.
    #[test]
    fn wrong_readings_do_not_last(disturbances in prop::collection::vec(disturbance(), 50..400)) {
        let tuning = tuning(&ARM.0).expect("a tuning");
        let mut arm = arm(&tuning);
        ticks(&mut arm, 0..200, undisturbed);
        let begin = 200;
        for (k, (coordinate, reading, elapsed)) in disturbances.iter().enumerate() {
            let index = begin + k as u32;
            ticks(&mut arm, index..index + 1, |_, measured| {
                coordinate.iter().for_each(|i| measured[*i] = *reading);
                *elapsed
            });
            prop_assert!(within(&arm, &tuning), "{:?}", arm.firmware.adapter().applied());
        }
        let begin = begin + disturbances.len() as u32;
        ticks(&mut arm, begin..begin + 1_500, undisturbed);
        prop_assert!((mass(&arm) - LOAD).abs() < 0.1 * LOAD, "{} kg", mass(&arm));
    }
}
