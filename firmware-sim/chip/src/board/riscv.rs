use core::arch::asm;
use riscv::register::minstret;

/// The counter counts instructions.
pub const INSTRUCTIONS_PER_TICK: u32 = 1;

/// The counter runs from the beginning.
pub fn start() {}

/// Ticks between two readings, of which the first is `since`; less than 2³².
#[inline(always)]
pub fn ticks(since: u32) -> u32 {
    (minstret::read() as u32).wrapping_sub(since)
}

/// The stack pointer.
#[inline(always)]
pub fn stack_pointer() -> usize {
    let pointer;
    // SAFETY: reads a register.
    unsafe { asm!("mv {}, sp", out(reg) pointer, options(nomem, nostack, preserves_flags)) };
    pointer
}

/// Of the processor.
pub fn name() -> &'static [u8] {
    b"riscv32imac"
}
