//! Fingerprint of the elementary functions, and the check that the floating-point unit rounds as it must.
#![no_std]
#![no_main]

use leastaction_chip::{image, print};
use leastaction_core::scalar::check_fpu;
use leastaction_firmware_sim::trajectory::Fingerprint;

fn run() -> Result<(), &'static [u8]> {
    check_fpu().map_err(|_| b"the floating-point unit is in another mode".as_slice())?;
    print::hash(b"hash", Fingerprint::of_elementary_functions().value());
    Ok(())
}

image!(run);
