//! Rounding mode of the floating-point unit. Results have the same bits everywhere only in the default mode.

use core::fmt;
use core::hint::black_box;

/// Reason why results have other bits than on other processors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FpuError {
    /// The unit does not round to nearest, ties to even (ARM: FPSCR bits 22 and 23, RMode, are not 0).
    Rounding,
    /// The unit treats numbers below 2⁻¹²⁶ as 0, or flushes them to 0 (ARM: FPSCR bit 24, FZ, is 1; x86: MXCSR bits 6
    /// and 15).
    FlushToZero,
    /// The unit returns one NaN in place of all others (ARM: FPSCR bit 25, DN, is 1).
    DefaultNan,
    /// The unit reads numbers in half precision without infinities (ARM: FPSCR bit 26, AHP, is 1).
    AlternativeHalf,
}

impl FpuError {
    /// Number of the error, from 1, for programs that print no words.
    pub const fn code(self) -> u8 {
        match self {
            Self::Rounding => 1,
            Self::FlushToZero => 2,
            Self::DefaultNan => 3,
            Self::AlternativeHalf => 4,
        }
    }
}

impl fmt::Display for FpuError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Rounding => "the floating-point unit does not round to nearest: clear RMode (bits 22 and 23) of FPSCR and FPDSCR",
            Self::FlushToZero => "the floating-point unit flushes small numbers to 0: clear FZ (bit 24) of FPSCR and FPDSCR",
            Self::DefaultNan => "the floating-point unit gives default NaNs: clear DN (bit 25) of FPSCR and FPDSCR",
            Self::AlternativeHalf => {
                "the floating-point unit has ARM's alternative half precision: clear AHP (bit 26) of FPSCR and FPDSCR"
            }
        })
    }
}

impl core::error::Error for FpuError {}

/// Checks that the floating-point unit works as IEEE 754 prescribes by default, and reports the first deviation.
///
/// On a Cortex-M with the instruction loops, FPSCR is read as well. An interrupt handler does not inherit FPSCR: the
/// processor gives it the bits of FPDSCR (0xE000EF3C). Call this function in the context that takes the steps. It
/// takes some thirty instructions.
///
/// # Errors
/// [`FpuError`] for the first deviation.
pub fn check_fpu() -> Result<(), FpuError> {
    #[cfg(arm_instructions)]
    of_register(crate::arm::fpscr())?;
    by_arithmetic()
}

/// Checks the bits of ARM's FPSCR.
#[cfg_attr(not(any(arm_instructions, test)), allow(dead_code, reason = "only a Cortex-M has the register"))]
const fn of_register(fpscr: u32) -> Result<(), FpuError> {
    const ROUNDING: u32 = 3 << 22;
    const FLUSH: u32 = 1 << 24;
    const DEFAULT_NAN: u32 = 1 << 25;
    const ALTERNATIVE_HALF: u32 = 1 << 26;
    if fpscr & ROUNDING != 0 {
        return Err(FpuError::Rounding);
    }
    if fpscr & FLUSH != 0 {
        return Err(FpuError::FlushToZero);
    }
    if fpscr & DEFAULT_NAN != 0 {
        return Err(FpuError::DefaultNan);
    }
    if fpscr & ALTERNATIVE_HALF != 0 { Err(FpuError::AlternativeHalf) } else { Ok(()) }
}

/// Checks by arithmetic, on any processor.
fn by_arithmetic() -> Result<(), FpuError> {
    // Half a unit and three halves: to nearest, ties to even, both signs.
    let half = black_box(f32::EPSILON / 2.0);
    let [one, next] = [black_box(1.0_f32), black_box(1.0 + f32::EPSILON)];
    let rounds = [(one + half, one), (next + half, 1.0 + 2.0 * f32::EPSILON), (-one - half, -one)];
    if rounds.iter().any(|(found, expected)| found.to_bits() != expected.to_bits()) {
        return Err(FpuError::Rounding);
    }
    let (least, two) = (black_box(f32::MIN_POSITIVE), black_box(2.0_f32));
    let small = black_box(least / two);
    let kept =
        small.to_bits() == f32::MIN_POSITIVE.to_bits() >> 1 && (small * two).to_bits() == least.to_bits();
    if !kept {
        return Err(FpuError::FlushToZero);
    }
    // The largest exponent of half precision is infinity, not 65,536.
    let infinity = crate::widened(crate::f16::from_bits(black_box(0x7c00)));
    if infinity.is_infinite() { Ok(()) } else { Err(FpuError::AlternativeHalf) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_register_says_what_is_not_as_it_should_be() {
        // Flags and conditions alone.
        assert_eq!(of_register(0xf000_009f), Ok(()));
        for (bit, error) in [
            (22, FpuError::Rounding),
            (23, FpuError::Rounding),
            (24, FpuError::FlushToZero),
            (25, FpuError::DefaultNan),
            (26, FpuError::AlternativeHalf),
        ] {
            assert_eq!(of_register(1 << bit), Err(error));
            assert!(error.code() > 0 && error.code() < 5);
        }
    }

    #[test]
    fn this_machine_works_as_it_should() {
        assert_eq!(check_fpu(), Ok(()));
    }

    /// Settings that a library compiled with `-ffast-math` leaves in a process.
    #[cfg(target_arch = "x86_64")]
    #[test]
    fn another_mode_of_this_machine_is_found() {
        fn with(change: u32) -> Result<(), FpuError> {
            let found;
            let mut saved = 0_u32;
            // SAFETY: MXCSR is read, changed in bits that say how to round, and restored before anything else is computed.
            unsafe {
                core::arch::asm!("stmxcsr [{}]", in(reg) &raw mut saved);
                found = saved | change;
                core::arch::asm!("ldmxcsr [{}]", in(reg) &raw const found);
            }
            let outcome = check_fpu();
            // SAFETY: as above.
            unsafe { core::arch::asm!("ldmxcsr [{}]", in(reg) &raw const saved) };
            outcome
        }
        assert_eq!(with(0), Ok(()));
        for (change, error) in [
            (1 << 13, FpuError::Rounding),
            (2 << 13, FpuError::Rounding),
            (3 << 13, FpuError::Rounding),
            (1 << 15, FpuError::FlushToZero),
            (1 << 6, FpuError::FlushToZero),
        ] {
            assert_eq!(with(change), Err(error), "{change:x}");
        }
    }
}
