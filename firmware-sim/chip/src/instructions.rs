//! Counts of instructions.

use crate::board::{INSTRUCTIONS_PER_TICK, ticks};

/// Instructions of one call, as the mean of `calls` calls, without the loop around them.
pub fn mean(calls: u32, mut call: impl FnMut()) -> u32 {
    let start = ticks(0);
    for _ in 0..calls {
        core::hint::black_box(());
    }
    let empty = ticks(start);
    let start = ticks(0);
    for _ in 0..calls {
        call();
        core::hint::black_box(());
    }
    // The division comes last, because a tick is many instructions.
    (ticks(start) - empty) * INSTRUCTIONS_PER_TICK / calls
}

/// Bits of a class within an octave of counts: 64 classes, each 1.6% to 0.8% wide.
const CLASS_BITS: u32 = 6;
/// Number of classes, from 2⁸ to 2³⁰ instructions.
const CLASSES: usize = 22 << CLASS_BITS;

/// Counts of many calls: their median and the largest.
pub struct Counts {
    classes: [u32; CLASSES],
    calls: u32,
    /// Largest count, instructions.
    pub worst: u32,
}

impl Default for Counts {
    fn default() -> Self {
        Self { classes: [0; CLASSES], calls: 0, worst: 0 }
    }
}

/// The class of a count: the leading bits of its floating-point representation.
fn class(count: u32) -> usize {
    let bits = (count as f32).to_bits() >> (23 - CLASS_BITS);
    (bits as usize).saturating_sub((127 + 8) << CLASS_BITS)
}

fn middle(class: usize) -> u32 {
    let bits = (class as u32 + ((127 + 8) << CLASS_BITS)) << (23 - CLASS_BITS);
    f32::from_bits(bits | 1 << (22 - CLASS_BITS)) as u32
}

impl Counts {
    /// Counts a call.
    #[inline(always)]
    pub fn of<T>(&mut self, call: impl FnOnce() -> T) -> T {
        let start = ticks(0);
        let outcome = call();
        self.add(ticks(start) * INSTRUCTIONS_PER_TICK);
        outcome
    }

    fn add(&mut self, count: u32) {
        self.worst = self.worst.max(count);
        self.calls += 1;
        if let Some(class) = self.classes.get_mut(class(count)) {
            *class += 1;
        }
    }

    /// The median, within 1%.
    pub fn median(&self) -> u32 {
        let mut below = 0;
        let at = self.classes.iter().position(|class| {
            below += class;
            2 * below >= self.calls
        });
        middle(at.unwrap_or(0)).min(self.worst)
    }
}
