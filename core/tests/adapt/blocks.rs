//! Moments of a fast loop, from its encoders.

use leastaction_core::adapt::{Blocks, Moment, Reading};

const H: f64 = 1e-3;
const TICKS: u16 = 4;

/// A motion of constant velocity, and a force that grows.
fn at(k: u32) -> Reading<f64, 2> {
    let t = f64::from(k) * H;
    Reading { q: [0.3 + 2.0 * t, -t], command: [t, 0.5], force: [3.0 * t, 1.5] }
}

fn moments(blocks: &mut Blocks<f64, 2>, ticks: u32, missing: u32) -> Vec<Option<Moment<f64, 2>>> {
    let reading = |k: u32| (k != missing).then(|| at(k));
    (0..ticks).filter_map(|k| blocks.take(reading(k).as_ref())).collect()
}

#[test]
fn a_moment_is_the_middle_of_the_block_before() {
    let found = moments(&mut Blocks::new(TICKS, H), 40, u32::MAX);
    assert_eq!((found.len(), &found[..2]), (10, &[None; 2][..]));
    for (block, moment) in found.into_iter().enumerate().skip(2) {
        let moment = moment.expect("a moment");
        let t = H * (f64::from(TICKS) * (block as f64 - 1.0) + 1.5);
        let expected =
            Moment { q: [0.3 + 2.0 * t, -t], v: [2.0, -1.0], command: [t, 0.5], force: [3.0 * t, 1.5] };
        for (found, expected) in [
            (moment.q, expected.q),
            (moment.v, expected.v),
            (moment.command, expected.command),
            (moment.force, expected.force),
        ] {
            assert!(
                found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12),
                "{found:?}, {expected:?}"
            );
        }
    }
}

#[test]
fn a_missing_reading_costs_its_block_and_the_neighbours() {
    let found = moments(&mut Blocks::new(TICKS, H), 40, 21);
    let gaps: Vec<usize> = (0..found.len()).filter(|i| found[*i].is_none()).collect();
    assert_eq!(gaps, [0, 1, 5, 6, 7]);
}

#[test]
fn a_block_of_one_tick_is_a_central_difference() {
    let found = moments(&mut Blocks::new(1, H), 3, u32::MAX);
    let moment = found[2].expect("a moment");
    assert!((moment.q[0] - at(1).q[0]).abs() < 1e-15 && (moment.v[0] - 2.0).abs() < 1e-9);
}
