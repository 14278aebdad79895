//! The controller of a scenario: observer, model and control law, at the other end of a serial line from the world.
//!
//! The model lies in the slot of the flash, weights and all, and is run there: of 1 or 2 coordinates with at most 2 hidden
//! layers of 32 units. `leastaction simulate … --on` is the world; `firmware-sim/LINK.md` is what they say.
#![no_std]
#![no_main]

use leastaction_chip::serial::Serial;
use leastaction_chip::{board, image};
use leastaction_firmware_sim::link::serve;

/// Units of a hidden layer at most.
const UNITS: usize = 32;
/// Hidden layers at most.
const LAYERS: usize = 2;

fn run() -> Result<(), &'static [u8]> {
    let name = str::from_utf8(board::name()).unwrap_or("");
    serve::<_, UNITS, LAYERS>(&mut Serial::new(), board::model(), name)
        .map_err(|_| b"nobody speaks".as_slice())
}

image!(run);
