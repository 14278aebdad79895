//! Instructions of ARM's single-precision floating-point unit.
//!
//! Separate functions, not inline assembly: the compiler does not know these registers by name on every target. They preserve the registers
//! that the procedure call standard requires (s16 and up).

mod aligned;
#[macro_use]
mod load;
mod loops;
mod sine;

pub use loops::{half, single};
pub use sine::sin_cos;

use core::arch::naked_asm;

/// Takes and returns s0.
#[unsafe(naked)]
pub extern "C" fn sqrt(x: f32) -> f32 {
    naked_asm!(".fpu vfpv2", "vsqrt.f32 s0, s0", "bx lr")
}

/// Takes r0, returns s0.
#[unsafe(naked)]
extern "C" fn widened_asm(bits: u32) -> f32 {
    naked_asm!(".fpu vfpv3-fp16", "vmov s0, r0", "vcvtb.f32.f16 s0, s0", "bx lr")
}

#[inline]
pub fn widened(w: crate::f16) -> f32 {
    widened_asm(w.to_bits().into())
}

/// Reads FPSCR. Returns r0.
#[unsafe(naked)]
pub extern "C" fn fpscr() -> u32 {
    naked_asm!(".fpu vfpv2", "vmrs r0, fpscr", "bx lr")
}
