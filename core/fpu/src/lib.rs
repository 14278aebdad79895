//! The innermost loops of leastaction-core, in f32: products with panels of a matrix, the square root, sine and cosine.
//!
//! A panel holds the weights of P outputs input by input, `rows[j][l]` from input j to output l, in single precision
//! ([`single`]) or in half precision, widened as they are read ([`half`]). On a Cortex-M with a floating-point unit,
//! the loops are written in its instructions, because a compiler loads the weights one by one where a single
//! instruction loads sixteen: 36 instructions for 16 multiply-adds, 53 with weights in half precision. Elsewhere the
//! loops are plain Rust. Multiplications and additions are the same in the same order, each rounded, and widening is
//! exact, so the bits are the same everywhere.
//!
//! The instructions need a unit that converts numbers in half precision. A stable compiler does not say whether the processor
//! has one (`rustc --print cfg` lists no feature of ARM's), so the build script goes by the target:
//!
//! | target | loops |
//! |---|---|
//! | `thumbv7em-none-eabihf`, `thumbv8m.main-none-eabihf` (Cortex-M4F, M7, M33F, M55) | instructions |
//! | other ARM targets `…eabihf` (Cortex-R, Cortex-A, Linux) | plain Rust, for a Cortex-R5F or A8 has no half precision; instructions where a nightly compiler lists `vfp4` |
//! | all others | plain Rust |
//!
//! `LEASTACTION_FPU=arm` or `=portable` in the environment of the build overrules this choice.
#![no_std]

#[cfg(arm_instructions)]
mod arm;
pub mod portable;
mod rounding;
mod trigonometry;

pub use ::half::f16;
#[cfg(arm_instructions)]
use arm as chosen;
pub use rounding::{FpuError, check_fpu};
/// The portable loops under the names of the instruction loops.
#[cfg(not(arm_instructions))]
mod chosen {
    pub use crate::portable::{sin_cos, sqrt, widened};

    macro_rules! portable {
        ($precision:ident, $weight:ty, $wide:expr) => {
            pub mod $precision {
                use crate::portable::{accumulate, transposed};

                pub fn accumulate_8(rows: &[[$weight; 8]], x: &[f32], sum: &mut [f32; 8]) {
                    accumulate(rows, x, sum, $wide);
                }

                pub fn accumulate_4(rows: &[[$weight; 4]], x: &[f32], sum: &mut [f32; 4]) {
                    accumulate(rows, x, sum, $wide);
                }

                pub fn transposed_8(rows: &[[$weight; 8]], y_bar: &[f32; 8], x_bar: &mut [f32]) {
                    transposed(rows, y_bar, x_bar, $wide);
                }

                pub fn transposed_4(rows: &[[$weight; 4]], y_bar: &[f32; 4], x_bar: &mut [f32]) {
                    transposed(rows, y_bar, x_bar, $wide);
                }
            }
        };
    }
    portable!(single, f32, |w| w);
    portable!(half, crate::f16, super::widened);
}

/// √x, correctly rounded; NaN for x < 0.
#[inline(always)]
pub fn sqrt(x: f32) -> f32 {
    chosen::sqrt(x)
}

/// (sin x, cos x), x in radians; NaN if x is not within ±65,536. The error is at most 2 ulp for |x| ≤ 8192, except next to a multiple of
/// π/2, where the result itself vanishes: 1.2e-7 there.
#[inline(always)]
pub fn sin_cos(x: f32) -> (f32, f32) {
    chosen::sin_cos(x)
}

/// Converts a number to single precision, exactly.
#[inline(always)]
pub fn widened(w: f16) -> f32 {
    chosen::widened(w)
}

macro_rules! loops {
    ($doc:literal, $precision:ident, $weight:ty) => {
        #[doc = $doc]
        pub mod $precision {
            use crate::chosen::$precision as chosen;

            /// s_l ← ((s_l + w₀ₗx₀) + w₁ₗx₁) + … for eight outputs l; the shorter of `rows` and `x` sets the number
            /// of inputs.
            pub fn accumulate_8(rows: &[[$weight; 8]], x: &[f32], sum: &mut [f32; 8]) {
                chosen::accumulate_8(rows, x, sum);
            }

            /// `accumulate_8` for four outputs.
            pub fn accumulate_4(rows: &[[$weight; 4]], x: &[f32], sum: &mut [f32; 4]) {
                chosen::accumulate_4(rows, x, sum);
            }

            /// x̄_j ← x̄_j + Σ_l w_jl ȳ_l over eight outputs l, products added in halves: lane l to lane l + 4, and so on.
            pub fn transposed_8(rows: &[[$weight; 8]], y_bar: &[f32; 8], x_bar: &mut [f32]) {
                chosen::transposed_8(rows, y_bar, x_bar);
            }

            /// `transposed_8` over four outputs.
            pub fn transposed_4(rows: &[[$weight; 4]], y_bar: &[f32; 4], x_bar: &mut [f32]) {
                chosen::transposed_4(rows, y_bar, x_bar);
            }
        }
    };
}
loops!("With weights in single precision.", single, f32);
loops!("With weights in half precision.", half, crate::f16);
