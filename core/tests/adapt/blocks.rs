//! Motion of a fast loop, from its encoders.

use leastaction_core::adapt::{Block, Blocks, Reading};

const H: f64 = 1e-3;
const TICKS: u16 = 4;

/// A motion of constant velocity, and a force that grows.
fn at(k: u32) -> Reading<f64, 2> {
    let t = f64::from(k) * H;
    Reading { q: [0.3 + 2.0 * t, -t], force: [3.0 * t, 1.5] }
}

fn blocks_of(blocks: &mut Blocks<f64, 2>, ticks: u32, missing: u32) -> Vec<Option<Block<f64, 2>>> {
    let reading = |k: u32| (k != missing).then(|| at(k));
    (0..ticks).filter_map(|k| blocks.take(reading(k).as_ref())).collect()
}

#[test]
fn a_motion_is_the_middle_of_the_block_before() {
    let found = blocks_of(&mut Blocks::new(TICKS, H), 40, u32::MAX);
    assert_eq!((found.len(), &found[..2]), (10, &[None; 2][..]));
    for (k, block) in found.into_iter().enumerate().skip(2) {
        let block = block.expect("a motion");
        let t = H * (f64::from(TICKS) * (k as f64 - 1.0) + 1.5);
        let expected = Block { q: [0.3 + 2.0 * t, -t], v: [2.0, -1.0], force: [3.0 * t, 1.5] };
        let all = [(block.q, expected.q), (block.v, expected.v), (block.force, expected.force)];
        for (found, expected) in all {
            assert!(
                found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12),
                "{found:?}, {expected:?}"
            );
        }
    }
}

#[test]
fn a_missing_reading_costs_its_block_and_the_neighbours() {
    let found = blocks_of(&mut Blocks::new(TICKS, H), 40, 21);
    let gaps: Vec<usize> = (0..found.len()).filter(|i| found[*i].is_none()).collect();
    assert_eq!(gaps, [0, 1, 5, 6, 7]);
}

#[test]
fn a_block_of_one_tick_is_a_central_difference() {
    let found = blocks_of(&mut Blocks::new(1, H), 3, u32::MAX);
    let block = found[2].expect("a block");
    assert!((block.q[0] - at(1).q[0]).abs() < 1e-15 && (block.v[0] - 2.0).abs() < 1e-9);
}
