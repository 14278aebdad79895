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
use leastaction_firmware_sim::link::Flash;

unsafe extern "C" {
    /// The last 64 KB of flash, by the linker script: a number, then files, each at a multiple of 4 and after its length in bytes: a model,
    /// and perhaps a plan.
    static _slot: [u32; 2];
}

/// Size of the slot, bytes.
const SLOT: usize = 64 << 10;
/// Size of a word, bytes.
const WORD: usize = size_of::<u32>();

/// The number that the emulator was told to put into flash; `None` if it is 0.
pub fn argument() -> Option<u32> {
    // SAFETY: flash that the linker leaves free; the emulator writes before the program starts.
    let number = unsafe { (&raw const _slot).cast::<u32>().read_volatile() };
    (number != 0).then_some(number)
}

/// The files that the emulator was told to put into flash, in place.
pub fn flash() -> Flash<'static> {
    let model = file(1);
    let plan = model.and_then(|model| file(2 + model.len().div_ceil(WORD)));
    Flash { model, plan }
}

/// The file whose length is this word of the slot; `None` if there is none.
fn file(word: usize) -> Option<&'static [u8]> {
    let slot = (&raw const _slot).cast::<u32>();
    let room = SLOT.checked_sub((word + 1) * WORD)?;
    // SAFETY: as above, within the slot, which nobody writes while the program runs.
    let length = unsafe { slot.add(word).read_volatile() } as usize;
    // SAFETY: as above.
    (1..=room)
        .contains(&length)
        .then(|| unsafe { core::slice::from_raw_parts(slot.add(word + 1).cast(), length) })
}

/// Ends the emulation: with exit code 0, or with the error printed and 1.
pub fn end(outcome: Result<(), &'static [u8]>) -> ! {
    if let Err(error) = outcome {
        print::line(b"error", error);
    }
    semihosting::process::exit(outcome.is_err().into())
}
