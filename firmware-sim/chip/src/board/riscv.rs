use core::arch::asm;
use riscv::register::minstret;

/// The counter counts instructions.
pub const INSTRUCTIONS_PER_TICK: u32 = 1;

/// The counter runs from the beginning.
pub fn start() {}

/// Ticks between two readings, the first of which is `since`; less than 2³².
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

/// Name of the processor.
pub fn name() -> &'static [u8] {
    b"riscv32imac"
}

/// The serial line of QEMU's board "virt": a 16550, polled. Source: National Semiconductor, "PC16550D", section 8.
pub struct Uart(());

const UART: *mut u8 = 0x1000_0000 as *mut u8;
// Offsets of registers from there.
const DATA: usize = 0;
const LINE_STATUS: usize = 5;
// Bits of the line status.
const HAS_RECEIVED: u8 = 1;
const CAN_SEND: u8 = 1 << 5;

impl Uart {
    /// Takes the line as the reset left it: the emulator needs no divisor, and enabling the queues would empty them of the bytes that have
    /// already arrived.
    pub fn start() -> Self {
        Self(())
    }

    /// Receives a byte, if one has arrived.
    pub fn receive(&mut self) -> Option<u8> {
        // SAFETY: as above; reading the data takes the byte.
        unsafe {
            let arrived = UART.add(LINE_STATUS).read_volatile() & HAS_RECEIVED != 0;
            arrived.then(|| UART.add(DATA).read_volatile())
        }
    }

    /// Sends a byte; `false` if there is no room for it yet.
    pub fn send(&mut self, byte: u8) -> bool {
        // SAFETY: as above.
        unsafe {
            let free = UART.add(LINE_STATUS).read_volatile() & CAN_SEND != 0;
            if free {
                UART.add(DATA).write_volatile(byte);
            }
            free
        }
    }
}
