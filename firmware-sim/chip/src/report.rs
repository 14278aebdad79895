//! The run of a model: its fingerprint, the instructions of its steps and the depth of its stack.

use crate::instructions::{Counts, mean};
use crate::{board, print, stack};
use leastaction_firmware_sim::trajectory::{Fingerprint, Motion};

/// Number of steps if no number was left in flash.
const STEPS: u32 = 1_000;
/// Number of calls in a mean.
const CALLS: u32 = 100;

/// Prints instructions and stack of an evaluation.
pub fn evaluation(name: &[u8], stack_name: &[u8], mut evaluate: impl FnMut()) {
    let (depth, ()) = stack::deepest(&mut evaluate);
    print::number(stack_name, depth as u32);
    print::number(name, mean(CALLS, evaluate));
}

/// Follows a motion for the number of steps in flash, and prints its cost.
pub fn motion<M: Motion>(motion: &mut M, counts: &mut Counts) -> Result<(), &'static [u8]> {
    let steps = board::argument().unwrap_or(STEPS);
    let mut fingerprint = Fingerprint::default();
    let (depth, first) = stack::deepest(|| motion.step(0).is_ok());
    let refused: &[u8] = b"a step is refused";
    if !first {
        return Err(refused);
    }
    fingerprint.update(motion);
    for index in 1..steps {
        counts.of(|| motion.step(index)).map_err(|_| refused)?;
        fingerprint.update(motion);
    }
    print::number(b"steps", steps);
    print::hash(b"hash", fingerprint.value());
    print::number(b"step_stack", depth as u32);
    print::number(b"step_instructions", counts.median());
    print::number(b"step_instructions_worst", counts.worst);
    Ok(())
}
