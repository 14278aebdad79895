//! A timer that interrupts a tick and flips a bit of memory.

use super::memory;
use core::arch::{asm, naked_asm};
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// Timer 0 of the MPS2 boards, the CMSDK's, at 25 MHz. Source: Arm, "Cortex-M System Design Kit", DDI 0479, section 4.4.
const TIMER: *mut u32 = 0x4000_0000 as *mut u32;
// Offsets from there, in words.
const CONTROL: usize = 0;
const VALUE: usize = 1;
const RELOAD: usize = 2;
const CLEAR: usize = 3;
/// Enabled, with its interrupt.
const ON: u32 = 1 | 1 << 3;
/// Register that enables interrupts, and the timer's.
const NVIC: *mut u32 = 0xe000_e100 as *mut u32;
const INTERRUPT: u32 = 1 << 8;

// Places of a flipped bit.
const STATE: u32 = 1;
const STACK: u32 = 2;
const WEIGHTS: u32 = 3;

/// Bytes of an exception's frame, without and with registers of floating-point numbers, and of its padding.
const FRAMES: [usize; 2] = [0x20, 0x68];
const PADDING: usize = 4;

unsafe extern "C" {
    /// Top of the stack, by the linker script.
    static _stack_start: u32;
}

/// Time, place and bit of a flip.
#[derive(Clone, Copy)]
pub struct Flip {
    /// Counts of the timer from the beginning of the tick, at least 1.
    pub counts: u32,
    /// Turns of an empty loop before, which take less than a count.
    pub turns: u32,
    /// State, stack, weights; or no place, for an interrupt without a flip.
    pub place: u32,
    /// Number that chooses the byte.
    pub byte: u32,
    /// Bit of the byte.
    pub bit: u32,
}

// The flip, as the interrupt reads it, and the bytes of state and of weights: first address and number.
static FLIP: [AtomicU32; 3] = [const { AtomicU32::new(0) }; 3];
static BYTES: [[AtomicU32; 2]; 2] = [const { [const { AtomicU32::new(0) }; 2] }; 2];

/// Tells the bytes of state and of weights.
pub fn know(state: (usize, usize), weights: &[u8]) {
    let weights = (weights.as_ptr() as usize, weights.len());
    for (known, (address, length)) in BYTES.iter().zip([state, weights]) {
        known[0].store(address as u32, Relaxed);
        known[1].store(length as u32, Relaxed);
    }
}

/// Starts the timer.
pub fn arm(flip: Flip) {
    for (known, number) in FLIP.iter().zip([flip.place, flip.byte, flip.bit]) {
        known.store(number, Relaxed);
    }
    // SAFETY: registers of a device that only this module touches; the handler is below.
    unsafe {
        NVIC.write_volatile(INTERRUPT);
        TIMER.add(CONTROL).write_volatile(0);
        TIMER.add(CLEAR).write_volatile(1);
        TIMER.add(RELOAD).write_volatile(0);
        TIMER.add(VALUE).write_volatile(flip.counts);
        for _ in 0..flip.turns {
            asm!("nop", options(nomem, nostack, preserves_flags));
        }
        TIMER.add(CONTROL).write_volatile(ON);
    }
}

/// Stops the timer if it has not fired.
pub fn disarm() {
    // SAFETY: as above.
    unsafe {
        TIMER.add(CONTROL).write_volatile(0);
        TIMER.add(CLEAR).write_volatile(1);
    }
}

/// Handler of all interrupts, which are the timer's: passes the frame of the interrupted program on.
#[unsafe(naked)]
#[unsafe(export_name = "DefaultHandler")]
unsafe extern "C" fn interrupted() {
    naked_asm!("mov r0, sp", "mov r1, lr", "b {flip}", flip = sym flip)
}

/// Flips the bit. `frame` is the address of the frame on the stack; the return value `link` of the exception and the saved status tell its size.
extern "C" fn flip(frame: usize, link: u32) {
    disarm();
    let [place, byte, bit] = [&FLIP[0], &FLIP[1], &FLIP[2]].map(|number| number.load(Relaxed));
    // SAFETY: the eighth word of a frame is the saved status.
    let status = unsafe { (frame as *const u32).add(7).read_volatile() };
    let padding = if status >> 9 & 1 == 1 { PADDING } else { 0 };
    let begin = frame + FRAMES[usize::from(link & 0x10 == 0)] + padding;
    let stack = (begin, &raw const _stack_start as usize - begin);
    let known = |i: usize| (BYTES[i][0].load(Relaxed) as usize, BYTES[i][1].load(Relaxed) as usize);
    let (address, length) = match place {
        STATE => known(0),
        STACK => stack,
        WEIGHTS => known(1),
        _ => return,
    };
    if let Some(offset) = (byte as usize).checked_rem(length) {
        let byte = (address + offset) as *mut u8;
        // SAFETY: memory of the program, which is damaged on purpose.
        memory::unprotected(|| unsafe { byte.write_volatile(byte.read_volatile() ^ (1 << (bit & 7))) });
    }
}
