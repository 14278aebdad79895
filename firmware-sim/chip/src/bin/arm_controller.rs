//! The controller of an arm of seven joints: observer, model and control law, at the other end of a serial line from the world.
//!
//! It works like `controller.rs`; the model in the slot of the flash is a tree of seven bodies in space; targets come with the samples, or from a plan.
#![no_std]
#![no_main]

use leastaction_chip::serial::Serial;
use leastaction_chip::{board, image};
use leastaction_firmware_sim::link::serve_arm;

fn run() -> Result<(), &'static [u8]> {
    let name = str::from_utf8(board::name()).unwrap_or("");
    serve_arm::<_, 7>(&mut Serial::new(), board::flash(), name).map_err(|_| b"nobody speaks".as_slice())
}

image!(run);
