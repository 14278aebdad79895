//! Guards of a running controller's memory, in which a bit may flip: of its files in flash, and of its state.
//!
//! - [`Sweep`] compares a file with its checksum in slices, so that every tick takes a small part of the time.
//! - [`Voted`] keeps three copies of a state and computes every tick twice. If the two differ, the third copy decides, and the outvoted one is
//!   repaired: no single fault in the copies, or in what a tick computes from one of them, reaches a command.
//!
//! Neither guards against a processor that runs astray: that is left to the handler of its faults and to a watchdog. An example of a firmware
//! with all of them is `firmware-sim/chip/src/bin/faults`.

mod sweep;
mod voted;

pub use sweep::Sweep;
pub use voted::{Agreed, Disagreed, Voted};
