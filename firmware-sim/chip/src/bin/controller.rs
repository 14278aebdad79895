//! The controller of a scenario: observer, model and control law, at the other end of a serial line from the world.
//!
//! The model lies in the slot of the flash, weights and all, and runs there, and so does a plan for it; the model has 1 or 2 coordinates and at most 2 hidden layers of 32
//! units. `leastaction simulate … --on` is the world; `firmware-sim/LINK.md` describes their messages.
#![no_std]
#![no_main]

use leastaction_chip::serial::Serial;
use leastaction_chip::{board, image};
use leastaction_firmware_sim::link::{Workspace, serve};

/// Maximum number of units of a hidden layer.
const UNITS: usize = 32;
/// Maximum number of hidden layers.
const LAYERS: usize = 2;

/// Memory of decisions at every tick.
static mut WORKSPACE: Workspace = Workspace::new();

fn run() -> Result<(), &'static [u8]> {
    let name = str::from_utf8(board::name()).unwrap_or("");
    let workspace = &raw mut WORKSPACE;
    // SAFETY: the image runs this function once, and nobody else has the workspace.
    let workspace = unsafe { &mut *workspace };
    serve::<_, UNITS, LAYERS>(&mut Serial::new(), board::flash(), workspace, name)
        .map_err(|_| b"nobody speaks".as_slice())
}

image!(run);
