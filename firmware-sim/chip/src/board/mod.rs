//! The boards: a counter of instructions, the stack pointer, the serial line, the data that the emulator leaves in flash, and the end of an
//! emulation.

#[cfg(target_arch = "arm")]
mod arm;
#[cfg(target_arch = "riscv32")]
mod riscv;

#[cfg(target_arch = "arm")]
use arm as this;
#[cfg(target_arch = "riscv32")]
use riscv as this;

pub use this::{INSTRUCTIONS_PER_TICK, Uart, name, stack_pointer, start, ticks};

use crate::print;
use leastaction_firmware_sim::link::{Files, Flash};

unsafe extern "C" {
    /// The last 64 KB of flash, by the linker script: a number, then [`Files`]: a model, and perhaps plans.
    static _slot: [u32; 2];
}

/// Size of the slot, bytes.
const SLOT: usize = 64 << 10;

/// The number that the emulator was told to put into flash; `None` if it is 0.
pub fn argument() -> Option<u32> {
    // SAFETY: flash that the linker leaves free; the emulator writes before the program starts.
    let number = unsafe { (&raw const _slot).cast::<u32>().read_volatile() };
    (number != 0).then_some(number)
}

/// The files that the emulator was told to put into flash, in place.
pub fn flash() -> Flash<'static> {
    let slot = (&raw const _slot).cast::<u32>();
    // SAFETY: as above, within the slot, which nobody writes while the program runs.
    Flash(Files(unsafe { core::slice::from_raw_parts(slot.add(1), SLOT / size_of::<u32>() - 1) }))
}

/// Ends the emulation: with exit code 0, or with the error printed and 1.
pub fn end(outcome: Result<(), &'static [u8]>) -> ! {
    if let Err(error) = outcome {
        print::line(b"error", error);
    }
    semihosting::process::exit(outcome.is_err().into())
}
