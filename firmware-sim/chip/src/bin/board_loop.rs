//! The loop of the board templates (`firmware-sim/boards`) around a simulated machine: the whole run, whose trace must be the desk's.
#![no_std]
#![no_main]

use leastaction_chip::{image, print};
use leastaction_core::energy::trigonometric::CARTPOLE;
use leastaction_core::forces::System;
use leastaction_firmware_sim::scenario::{SwingUpConfig, run_on};
use leastaction_machine::{Counted, control, model};

fn run() -> Result<(), &'static [u8]> {
    let model = model().map_err(|_| b"the model is refused".as_slice())?;
    let control = control(&model).map_err(|_| b"the program is refused".as_slice())?;
    let (plant, setup) = (System::conservative(CARTPOLE), SwingUpConfig::cartpole().setup);
    let summary = run_on(&plant, Counted::new(control), &setup, [0.0; 2], |_| ());
    let summary = summary.map_err(|_| b"the run is refused".as_slice())?;
    print::hash(b"hash", summary.hash);
    summary.success.then_some(()).ok_or(b"it did not come upright")
}

image!(run);
