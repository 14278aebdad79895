use core::arch::asm;
use cortex_m::Peripherals;
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;

/// Instructions per tick: SysTick runs at 25 MHz, the emulated processor at 1 GHz.
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

/// Ticks between two readings, the first of which is `since`; at most 2²⁴.
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

/// Name of the processor: M7 if its identification register says so.
pub fn name() -> &'static [u8] {
    const CPUID: *const u32 = 0xe000_ed00 as *const u32;
    // SAFETY: the identification register of every Cortex-M.
    let part = unsafe { CPUID.read_volatile() } >> 4 & 0xfff;
    if part == 0xc27 { b"cortex-m7" } else { b"cortex-m4f" }
}

/// UART 0 of the MPS2 boards, the CMSDK's, polled. Source: Arm, "Cortex-M System Design Kit", DDI 0479, section 4.3.
pub struct Uart(());

const UART: *mut u32 = 0x4000_4000 as *mut u32;
// Offsets from there, in words.
const DATA: usize = 0;
const STATE: usize = 1;
const CONTROL: usize = 2;
const DIVISOR: usize = 4;
// Bits of the state.
const CANNOT_SEND: u32 = 1;
const HAS_RECEIVED: u32 = 2;
// Bits of the control.
const ENABLE_BOTH: u32 = 3;
/// The smallest divisor, the fastest line.
const FASTEST: u32 = 16;

impl Uart {
    /// Enables the line.
    pub fn start() -> Self {
        // SAFETY: registers of a device that only this type touches.
        unsafe {
            UART.add(DIVISOR).write_volatile(FASTEST);
            UART.add(CONTROL).write_volatile(ENABLE_BOTH);
        }
        Self(())
    }

    /// Receives a byte, if one has arrived.
    pub fn receive(&mut self) -> Option<u8> {
        // SAFETY: as above; reading the data takes the byte.
        unsafe {
            let arrived = UART.add(STATE).read_volatile() & HAS_RECEIVED != 0;
            arrived.then(|| UART.add(DATA).read_volatile() as u8)
        }
    }

    /// Sends a byte; `false` if the previous one is still on its way.
    pub fn send(&mut self, byte: u8) -> bool {
        // SAFETY: as above.
        unsafe {
            let free = UART.add(STATE).read_volatile() & CANNOT_SEND == 0;
            if free {
                UART.add(DATA).write_volatile(byte.into());
            }
            free
        }
    }
}
