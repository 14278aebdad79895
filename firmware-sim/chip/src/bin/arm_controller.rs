//! The controller of an arm of seven joints: observer, model and control law, at the other end of a serial line from the world.
//!
//! It works like `controller.rs`; the model in the slot of the flash is a tree of seven bodies in space; targets come with the samples, or from a plan.
#![no_std]
#![no_main]

use leastaction_chip::serial::Serial;
use leastaction_chip::{board, image};
use leastaction_core::energy::arm::{ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS};
use leastaction_firmware_sim::link::serve_arm;

/// Number of joints.
const N: usize = 7;
/// Numbers of a model: those of gravity and of bodies, and at most five of friction for each joint.
const NUMBERS: usize = ARM_GRAVITY_PARAMETERS + N * (ARM_PARAMETERS + 5);

fn run() -> Result<(), &'static [u8]> {
    let name = str::from_utf8(board::name()).unwrap_or("");
    serve_arm::<_, N, NUMBERS>(&mut Serial::new(), board::flash(), name).map_err(|_| b"nobody speaks".as_slice())
}

image!(run);
