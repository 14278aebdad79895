//! Guards find what is damaged, and nothing else.

use leastaction_core::guard::{Disagreed, Sweep, Voted};
use leastaction_core::model::{ModelError, checksum};
use proptest::prelude::*;

fn file(body: &[u8]) -> Vec<u8> {
    [body, &checksum(body).to_le_bytes()].concat()
}

proptest! {
    /// Rounds of a whole file end after as many calls as asked for, at most.
    #[test]
    fn rounds_end(body in prop::collection::vec(any::<u8>(), 1..300), calls in 1_usize..20) {
        let (file, mut sweep) = (file(&body), Sweep::new());
        let bytes = Sweep::slice(file.len(), calls);
        for _ in 0..3 {
            let taken = (1..).find(|_| sweep.advance(&file, bytes).unwrap()).unwrap();
            prop_assert!(taken <= calls, "{taken} calls for {} bytes by {bytes}", body.len());
        }
    }

    /// A bit that flips at any time during a round is found before two more rounds have ended.
    #[test]
    fn flips_are_found(
        body in prop::collection::vec(any::<u8>(), 1..300),
        (calls, before) in (1_usize..20, 0_usize..40),
        (byte, bit) in (any::<prop::sample::Index>(), 0_u32..8),
    ) {
        let (mut file, mut sweep) = (file(&body), Sweep::new());
        let bytes = Sweep::slice(file.len(), calls);
        for _ in 0..before {
            sweep.advance(&file, bytes).unwrap();
        }
        file[byte.index(body.len())] ^= 1_u8 << bit;
        let found = (0..2 * calls).find_map(|_| sweep.advance(&file, bytes).err());
        let (stored, computed) = (checksum(&body), checksum(&file[..body.len()]));
        prop_assert_eq!(found, Some(ModelError::Checksum { stored, computed }));
    }

    /// One damaged copy of three changes no outcome, wherever the damage is, and is repaired.
    #[test]
    fn one_copy_is_outvoted(
        xs in prop::collection::vec(-10.0_f32..10.0, 6),
        (call, place, bit) in (0_usize..3, 0_usize..3, 0_u32..32),
    ) {
        let (mut expected, mut voted) = ([0.0_f32, 1.0], Voted::new(0.75_f32, [0.0, 1.0]));
        for (tick, x) in xs.into_iter().enumerate() {
            let wanted = filter(&0.75, &mut expected, x);
            let mut calls = 0;
            let agreed = voted.run(&[x; 3], |gain, state, x| {
                let (mut gain, mut x, damaged) = (*gain, *x, tick == 3 && calls == call);
                calls += 1;
                if damaged {
                    flip([&mut gain, &mut state[1], &mut x][place], bit);
                }
                filter(&gain, state, x)
            });
            prop_assert_eq!(agreed.unwrap().outcome, wanted);
            prop_assert_eq!(voted.state(), &expected);
        }
    }
}

/// A filter with a state that is damaged for long if it is damaged once.
fn filter(gain: &f32, state: &mut [f32; 2], x: f32) -> f32 {
    state[0] += gain * (x - state[0]);
    state[1] += x;
    state[0] + state[1]
}

fn flip(x: &mut f32, bit: u32) {
    *x = f32::from_bits(x.to_bits() ^ 1 << bit);
}

#[test]
fn a_file_without_a_checksum_is_refused() {
    assert_eq!(Sweep::new().advance(&[1, 2, 3], 4), Err(ModelError::TooShort { bytes: 3 }));
}

/// Each tick calls the work twice; a difference calls it once more and is reported.
#[test]
fn faults_are_told() {
    let (mut voted, mut calls) = (Voted::new((), 0), 0);
    for damaged in [0, 1, 2] {
        let before = calls;
        let agreed = voted.run(&[(); 3], |(), state, ()| {
            calls += 1;
            *state += 1 + i32::from(calls - before == damaged);
            *state
        });
        assert_eq!(agreed.map(|agreed| agreed.outvoted), Ok(damaged > 0), "call {damaged}");
        assert_eq!(calls - before, if damaged > 0 { 3 } else { 2 });
    }
    assert_eq!(voted.state(), &3);
    let lost = voted.run(&[(); 3], |(), _, ()| {
        calls += 1;
        calls
    });
    assert_eq!(lost, Err(Disagreed));
}

/// A number that compares as no number should, once it is 13, as bits do that are no value of their type.
#[derive(Clone, Copy, Debug)]
struct Odd(i32);

impl PartialEq for Odd {
    fn eq(&self, other: &Self) -> bool {
        other.0 == 13 || self.0 == other.0
    }
}

/// A damaged copy to which the third seems equal is replaced all the same.
#[test]
fn the_third_copy_replaces_both() {
    let (mut voted, mut calls) = (Voted::new((), Odd(0)), 0);
    let agreed = voted.run(&[(); 3], |(), state, ()| {
        state.0 = if calls == 0 { 13 } else { 5 };
        calls += 1;
        *state
    });
    assert_eq!(agreed.map(|agreed| (agreed.outcome.0, agreed.outvoted)), Ok((5, true)));
    assert_eq!(voted.state().0, 5);
}

/// A constant that is damaged for good is found by its first effect, and replaced.
#[test]
fn constants_are_repaired() {
    use std::cell::Cell;
    let constant = || Cell::new(1.0_f32);
    let mut voted = Voted::new(constant(), 0.0_f32);
    let (mut outvoted, mut calls) = ([false; 4], 0);
    for (tick, outvoted) in outvoted.iter_mut().enumerate() {
        // The first copy, at the second tick.
        let agreed = voted.run(&[(); 3], |gain, sum, ()| {
            calls += 1;
            if tick == 1 && calls == 3 {
                gain.set(-1.0);
            }
            *sum += gain.get();
        });
        *outvoted = agreed.unwrap().outvoted;
    }
    assert_eq!((outvoted, *voted.state()), ([false, true, false, false], 4.0));
}
