//! The world on this machine: words through two pipes, by semihosting. The processor's time stands still meanwhile.

use core::arch::asm;

/// Word that begins a message: the program has begun, or it begins anew.
pub const BEGUN: u32 = 0xb;
/// Word that begins a message: a program has started over its model, and repeats its order.
pub const STARTED: u32 = 0xe;
/// Word that begins a message: the program waits for its next tick.
pub const READY: u32 = 0xa;
/// Word that begins a message: the outcome of a tick, whose number is in the upper bits.
pub const DONE: u32 = 0xd;
/// Word that begins a message: a handler has stopped the processor and commands no force.
pub const STOPPED: u32 = 0x5;

/// Handles of the pipes: the first two files that the emulator opens.
const IN: u32 = 1;
const OUT: u32 = 2;

// Operations. Source: Arm, "Semihosting for AArch32 and AArch64", 2.0.
const OPEN: u32 = 1;
const CLOSE: u32 = 2;
const WRITE: u32 = 5;
const READ: u32 = 6;
// Ways of opening a file.
const TO_READ: u32 = 0;
const TO_WRITE: u32 = 4;

fn call(operation: u32, parameters: [u32; 3]) -> u32 {
    let result;
    // SAFETY: the emulator reads the parameters, and writes nothing but what they point to.
    unsafe { asm!("bkpt 0xab", inout("r0") operation => result, in("r1") &parameters) }
    result
}

/// Opens the pipes, also after a reset, through which the emulator keeps them open.
pub fn open() {
    for (name, way) in [(b"in\0".as_slice(), TO_READ), (b"out\0", TO_WRITE)] {
        let handle = if way == TO_READ { IN } else { OUT };
        call(CLOSE, [handle, 0, 0]);
        call(OPEN, [name.as_ptr() as u32, way, name.len() as u32 - 1]);
    }
}

/// Sends a message.
pub fn say(words: &[u32; 6]) {
    call(WRITE, [OUT, words.as_ptr() as u32, size_of_val(words) as u32]);
}

/// Waits for a message.
pub fn hear<const WORDS: usize>() -> [u32; WORDS] {
    let mut words = [0; WORDS];
    hear_into(&mut words);
    words
}

/// Waits for a message, and puts it in place.
pub fn hear_into<const WORDS: usize>(words: &mut [u32; WORDS]) {
    call(READ, [IN, words.as_mut_ptr() as u32, size_of_val(words) as u32]);
}
