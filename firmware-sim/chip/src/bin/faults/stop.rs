//! Handler of processor faults, watchdog, and end of the program: all command no force, and reset the chip.

use super::host;
use core::arch::naked_asm;
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};
use cortex_m::peripheral::SCB;

/// Watchdog of the MPS2 boards, the CMSDK's, at 25 MHz; its interrupt cannot be masked. Source: Arm, "Cortex-M System Design Kit", DDI 0479,
/// section 4.6.
const WATCHDOG: *mut u32 = 0x4000_8000 as *mut u32;
// Offsets from there, in words.
const LOAD: usize = 0;
const VALUE: usize = 1;
const CONTROL: usize = 2;
const CLEAR: usize = 3;
/// Interrupts, and does not reset the chip by itself.
const INTERRUPTS: u32 = 1;
/// Longest time between the beginnings of two ticks, counts of 40 instructions: half a tick of 10 ms at 100 million instructions a second. The
/// world takes no time.
pub const BOUND: u32 = 500_000 / 40;

const FAULT: u32 = 1;
const LATE: u32 = 2;
const ENDED: u32 = 3;

// Stages of the program.
const STARTED: u32 = 0x5a17_0001;
const TICKING: u32 = 0x5a17_0002;

/// Stage of the program, which survives a jump to its beginning; a reset is told by 0, which [`stop`] leaves behind, or by any other number.
#[unsafe(link_section = ".uninit.STAGE")]
static STAGE: AtomicU32 = AtomicU32::new(0);

/// Begins the program, after a reset. A processor that runs astray may come here too, which ends the program.
pub fn begin_program() {
    if [STARTED, TICKING].contains(&STAGE.swap(STARTED, Relaxed)) {
        end()
    }
}

/// Begins the ticks, once in a program.
pub fn begin_ticks() {
    if STAGE.swap(TICKING, Relaxed) != STARTED {
        end()
    }
}

/// Ends the program.
pub fn end() -> ! {
    stop(ENDED)
}

/// Begins a tick: the watchdog waits anew.
pub fn begin_tick() {
    // SAFETY: registers of a device that only this module touches; the handler is below.
    unsafe {
        WATCHDOG.add(CLEAR).write_volatile(1);
        WATCHDOG.add(LOAD).write_volatile(BOUND);
        WATCHDOG.add(CONTROL).write_volatile(INTERRUPTS);
    }
}

/// Instructions since the beginning of the tick.
fn instructions(cause: u32) -> u32 {
    // SAFETY: as above; only read.
    let left = unsafe { WATCHDOG.add(VALUE).read_volatile() };
    // After the interrupt, the watchdog counts from its bound again.
    let before = if cause == LATE { BOUND } else { 0 };
    (before + BOUND.saturating_sub(left)).saturating_mul(40)
}

/// Commands no force, says so, and resets the chip.
extern "C" fn stop(cause: u32) -> ! {
    let force = 0.0_f32.to_bits();
    host::say(&[host::STOPPED, force, force, cause, 0, instructions(cause)]);
    STAGE.store(0, Relaxed);
    // The emulator takes its time for a reset, in which the watchdog would call again.
    // SAFETY: as above.
    unsafe { WATCHDOG.add(CONTROL).write_volatile(0) };
    SCB::sys_reset()
}

/// Handler of processor faults. The stack pointer may be damaged: it is set to the top of the stack.
#[unsafe(naked)]
#[unsafe(export_name = "HardFault")]
unsafe extern "C" fn fault() -> ! {
    naked_asm!(
        "movw r0, #:lower16:_stack_start",
        "movt r0, #:upper16:_stack_start",
        "msr msp, r0",
        "movs r0, #{cause}",
        "b {stop}",
        cause = const FAULT,
        stop = sym stop
    )
}

/// Handler of the watchdog.
#[unsafe(naked)]
#[unsafe(export_name = "NonMaskableInt")]
unsafe extern "C" fn late() -> ! {
    naked_asm!(
        "movw r0, #:lower16:_stack_start",
        "movt r0, #:upper16:_stack_start",
        "msr msp, r0",
        "movs r0, #{cause}",
        "b {stop}",
        cause = const LATE,
        stop = sym stop
    )
}
