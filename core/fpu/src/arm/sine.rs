//! Sine and cosine, with the constants loaded eight at a time.

use crate::trigonometry::{COSINE, LIMIT, PIO2_1, PIO2_2, PIO2_3, PIO2_4, ROUND, SINE, TWO_OVER_PI};
use core::arch::naked_asm;

/// Two numbers, returned in s0 and s1.
#[repr(C)]
struct Pair(f32, f32);

/// Takes s0. Follows [`crate::portable::sin_cos`] step by step.
#[unsafe(naked)]
extern "C" fn sin_cos_asm(x: f32) -> Pair {
    naked_asm!(
        ".fpu vfpv2",
        "adr r1, 5f",
        "vldmia r1!, {{s2-s9}}",
        // NaN if x is beyond the limit or not a number.
        "vabs.f32 s10, s0",
        "vcmp.f32 s10, s2",
        "vmrs APSR_nzcv, fpscr",
        "it hi",
        "vmovhi.f32 s0, s3",
        // Quarter turns, and the remainder.
        "vmul.f32 s10, s0, s4",
        "vadd.f32 s10, s10, s5",
        "vsub.f32 s11, s10, s5",
        "vmul.f32 s12, s11, s6",
        "vsub.f32 s0, s0, s12",
        "vmul.f32 s12, s11, s7",
        "vsub.f32 s0, s0, s12",
        "vmul.f32 s12, s11, s8",
        "vsub.f32 s0, s0, s12",
        "vmul.f32 s12, s11, s9",
        "vsub.f32 s0, s0, s12",
        "vldmia r1, {{s2-s9}}",
        "vmul.f32 s1, s0, s0",
        // Sine of the remainder, to s0.
        "vmul.f32 s12, s2, s1",
        "vadd.f32 s12, s12, s3",
        "vmul.f32 s12, s12, s1",
        "vadd.f32 s12, s12, s4",
        "vmul.f32 s12, s12, s1",
        "vmul.f32 s12, s12, s0",
        "vadd.f32 s0, s12, s0",
        // Cosine of the remainder, to s1.
        "vmul.f32 s12, s5, s1",
        "vadd.f32 s12, s12, s6",
        "vmul.f32 s12, s12, s1",
        "vadd.f32 s12, s12, s7",
        "vmul.f32 s12, s12, s1",
        "vmul.f32 s12, s12, s1",
        "vmul.f32 s1, s1, s8",
        "vsub.f32 s12, s12, s1",
        "vadd.f32 s1, s12, s9",
        // Odd turns exchange sine and cosine, and signs change.
        "vmov r0, s10",
        "lsls r1, r0, #31",
        "ittt ne",
        "vmovne.f32 s2, s0",
        "vmovne.f32 s0, s1",
        "vmovne.f32 s1, s2",
        "vmov r2, r3, s0, s1",
        "and r1, r0, #2",
        "eor r2, r2, r1, lsl #30",
        "add r0, r0, #1",
        "and r0, r0, #2",
        "eor r3, r3, r0, lsl #30",
        "vmov s0, s1, r2, r3",
        "bx lr",
        ".balign 4",
        "5:",
        ".word {limit}, {nan}, {two_over_pi}, {round}, {pio2_1}, {pio2_2}, {pio2_3}, {pio2_4}",
        ".word {s3}, {s2}, {s1}, {c3}, {c2}, {c1}, {half}, {one}",
        limit = const LIMIT.to_bits(),
        nan = const f32::NAN.to_bits(),
        two_over_pi = const TWO_OVER_PI.to_bits(),
        round = const ROUND.to_bits(),
        pio2_1 = const PIO2_1.to_bits(),
        pio2_2 = const PIO2_2.to_bits(),
        pio2_3 = const PIO2_3.to_bits(),
        pio2_4 = const PIO2_4.to_bits(),
        s3 = const SINE[0].to_bits(),
        s2 = const SINE[1].to_bits(),
        s1 = const SINE[2].to_bits(),
        c3 = const COSINE[0].to_bits(),
        c2 = const COSINE[1].to_bits(),
        c1 = const COSINE[2].to_bits(),
        half = const 0.5_f32.to_bits(),
        one = const 1.0_f32.to_bits(),
    )
}

#[inline]
pub fn sin_cos(x: f32) -> (f32, f32) {
    let Pair(sin, cos) = sin_cos_asm(x);
    (sin, cos)
}
