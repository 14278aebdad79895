//! Faults of memory in a controller on an emulated chip (`firmware-sim/chip/src/bin/faults`): the world around it, and a judge.

mod bench;
mod chip;
mod judge;

pub use bench::{Bench, Costs, Fault, Place, Run, TICKS_BEFORE};
pub use chip::{Chip, Silence};
pub use judge::{Caught, Guard, Judged, Record, Stop, judge};
