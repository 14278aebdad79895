//! Shared parts of the images: the board, counting instructions, watching the stack, and printing.
//!
//! An image runs under QEMU with one instruction per virtual nanosecond (`-icount shift=0`), so counts are equal in every run. They are
//! instructions, not cycles. Output goes by semihosting, as lines of a name and a value.
#![no_std]

pub mod board;
pub mod instructions;
pub mod models;
pub mod print;
pub mod receding;
pub mod report;
pub mod serial;
pub mod stack;

/// Panic handler that calls an undefined symbol: a panic that can be reached is a linker error.
#[cfg(not(test))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    unsafe extern "C" {
        fn a_panic_can_be_reached() -> !;
    }
    // SAFETY: never called, or the image would not link.
    unsafe { a_panic_can_be_reached() }
}

/// Bytes at a multiple of 4, as required for a model file in flash.
#[repr(C, align(4))]
pub struct Aligned<const N: usize>(
    /// The bytes.
    pub [u8; N],
);

/// The entry of an image: runs `$run`, and ends the emulation with its success or failure.
#[macro_export]
macro_rules! image {
    ($run:path) => {
        $crate::entry!($crate::board::end($run()));
    };
}

/// The entry of an image that prints nothing: runs `$run`, and ends the emulation with its success (`Some`) or failure.
#[macro_export]
macro_rules! bare {
    ($run:path) => {
        $crate::entry!(semihosting::process::exit(if $run().is_some() { 0 } else { 1 }));
    };
}

/// The function that a board starts: `$last` does not return.
#[macro_export]
macro_rules! entry {
    ($last:expr) => {
        #[cfg_attr(target_arch = "arm", cortex_m_rt::entry)]
        #[cfg_attr(target_arch = "riscv32", riscv_rt::entry)]
        fn main() -> ! {
            $crate::board::start();
            $last
        }
    };
}
