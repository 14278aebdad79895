use core::arch::asm;
use cortex_m::Peripherals;
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;

/// SysTick runs at 25 MHz, the emulated processor at 1 GHz.
pub const INSTRUCTIONS_PER_TICK: u32 = 40;
/// SysTick counts 24 bits.
const MASK: u32 = 0x00ff_ffff;

/// Starts the counter.
pub fn start() {
    // SAFETY: one processor, no interrupt, and nobody else has the peripherals.
    let mut peripherals = unsafe { Peripherals::steal() };
    peripherals.SYST.set_clock_source(SystClkSource::Core);
    peripherals.SYST.set_reload(MASK);
    peripherals.SYST.clear_current();
    peripherals.SYST.enable_counter();
}

/// Ticks between two readings, of which the first is `since`; at most 2²⁴.
#[inline(always)]
pub fn ticks(since: u32) -> u32 {
    (MASK - SYST::get_current()).wrapping_sub(since) & MASK
}

/// The stack pointer.
#[inline(always)]
pub fn stack_pointer() -> usize {
    let pointer;
    // SAFETY: reads a register.
    unsafe { asm!("mov {}, sp", out(reg) pointer, options(nomem, nostack, preserves_flags)) };
    pointer
}

/// Of the processor: M7 where it is told so by its identification register.
pub fn name() -> &'static [u8] {
    const CPUID: *const u32 = 0xe000_ed00 as *const u32;
    // SAFETY: the identification register of every Cortex-M.
    let part = unsafe { CPUID.read_volatile() } >> 4 & 0xfff;
    if part == 0xc27 { b"cortex-m7" } else { b"cortex-m4f" }
}
