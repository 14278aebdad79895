//! Protection of memory: stores to flash fault, as on a chip, where the emulated board has RAM in its place; and nothing in RAM is executed.

use cortex_m::asm::{dsb, isb};
use cortex_m::peripheral::MPU;

// Registers. Source: Arm, "ARMv7-M Architecture Reference Manual", DDI 0403, section B3.5.
/// Enabled, and memory outside all regions is as without protection.
const ON: u32 = 1 | 1 << 2;
/// Address that is valid, with the region's number.
const VALID: u32 = 1 << 4;
/// Enabled region of 4 MB, normal memory with a cache that writes through.
const REGION: u32 = 1 | 21 << 1 | 1 << 17;
const READ_ONLY: u32 = 0b110 << 24;
const NOT_EXECUTED: u32 = 1 << 28 | 0b011 << 24;
/// Address and attributes of the regions: flash and RAM.
const REGIONS: [[u32; 2]; 2] = [[0, REGION | READ_ONLY], [0x2000_0000, REGION | NOT_EXECUTED]];

/// Protects memory.
pub fn protect() {
    // SAFETY: the program writes nothing to flash but in `unprotected`, and executes nothing in RAM.
    unsafe {
        for (number, [address, attributes]) in (0..).zip(REGIONS) {
            (*MPU::PTR).rbar.write(address | VALID | number);
            (*MPU::PTR).rasr.write(attributes);
        }
    }
    switch(ON);
}

/// Runs without protection: an injected fault obeys none.
pub fn unprotected(work: impl FnOnce()) {
    switch(0);
    work();
    switch(ON);
}

fn switch(control: u32) {
    // SAFETY: as above; the barriers let the change precede what follows.
    unsafe { (*MPU::PTR).ctrl.write(control) };
    dsb();
    isb();
}
