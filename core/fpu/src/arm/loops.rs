//! Products with panels of a matrix: weights are loaded sixteen at a time.

/// The loops, for weights of one precision.
macro_rules! loops {
    ($precision:ident, $weight:ty) => {
        pub mod $precision {
            use super::super::aligned::aligned;
            use core::arch::naked_asm;

            /// Takes rows, x, the sums and the number of inputs in r0 … r3.
            #[unsafe(naked)]
            unsafe extern "C" fn accumulate_8_asm(
                rows: *const $weight,
                x: *const f32,
                sum: *mut f32,
                inputs: usize,
            ) {
                naked_asm!(
                    ".fpu vfpv3-fp16",
                    "vpush {{s16-s25}}",
                    "vldmia r2, {{s0-s7}}",
                    "lsrs r12, r3, #1",
                    "beq 3f",
                    "2:",
                    load!($precision, 16),
                    "vldmia r1!, {{s24-s25}}",
                    "vmul.f32 s8, s8, s24",
                    "vmul.f32 s9, s9, s24",
                    "vmul.f32 s10, s10, s24",
                    "vmul.f32 s11, s11, s24",
                    "vmul.f32 s12, s12, s24",
                    "vmul.f32 s13, s13, s24",
                    "vmul.f32 s14, s14, s24",
                    "vmul.f32 s15, s15, s24",
                    "vmul.f32 s16, s16, s25",
                    "vmul.f32 s17, s17, s25",
                    "vmul.f32 s18, s18, s25",
                    "vmul.f32 s19, s19, s25",
                    "vmul.f32 s20, s20, s25",
                    "vmul.f32 s21, s21, s25",
                    "vmul.f32 s22, s22, s25",
                    "vmul.f32 s23, s23, s25",
                    "vadd.f32 s0, s0, s8",
                    "vadd.f32 s1, s1, s9",
                    "vadd.f32 s2, s2, s10",
                    "vadd.f32 s3, s3, s11",
                    "vadd.f32 s4, s4, s12",
                    "vadd.f32 s5, s5, s13",
                    "vadd.f32 s6, s6, s14",
                    "vadd.f32 s7, s7, s15",
                    "vadd.f32 s0, s0, s16",
                    "vadd.f32 s1, s1, s17",
                    "vadd.f32 s2, s2, s18",
                    "vadd.f32 s3, s3, s19",
                    "vadd.f32 s4, s4, s20",
                    "vadd.f32 s5, s5, s21",
                    "vadd.f32 s6, s6, s22",
                    "vadd.f32 s7, s7, s23",
                    "subs r12, r12, #1",
                    "bne 2b",
                    "3:",
                    "tst r3, #1",
                    "beq 4f",
                    load!($precision, 8),
                    "vldmia r1!, {{s24}}",
                    "vmul.f32 s8, s8, s24",
                    "vmul.f32 s9, s9, s24",
                    "vmul.f32 s10, s10, s24",
                    "vmul.f32 s11, s11, s24",
                    "vmul.f32 s12, s12, s24",
                    "vmul.f32 s13, s13, s24",
                    "vmul.f32 s14, s14, s24",
                    "vmul.f32 s15, s15, s24",
                    "vadd.f32 s0, s0, s8",
                    "vadd.f32 s1, s1, s9",
                    "vadd.f32 s2, s2, s10",
                    "vadd.f32 s3, s3, s11",
                    "vadd.f32 s4, s4, s12",
                    "vadd.f32 s5, s5, s13",
                    "vadd.f32 s6, s6, s14",
                    "vadd.f32 s7, s7, s15",
                    "4:",
                    "vstmia r2, {{s0-s7}}",
                    "vpop {{s16-s25}}",
                    "bx lr",
                )
            }

            #[inline]
            pub fn accumulate_8(rows: &[[$weight; 8]], x: &[f32], sum: &mut [f32; 8]) {
                aligned(rows, |first, rows| {
                    let x = x.get(first..).unwrap_or(&[]);
                    let inputs = rows.len().min(x.len());
                    // SAFETY: it reads `inputs` rows and `inputs` numbers, which both slices have at least, and reads and writes the sums.
                    unsafe { accumulate_8_asm(rows.as_ptr().cast(), x.as_ptr(), sum.as_mut_ptr(), inputs) };
                });
            }

            /// Takes rows, x, the sums and the number of inputs in r0 … r3.
            #[unsafe(naked)]
            unsafe extern "C" fn accumulate_4_asm(
                rows: *const $weight,
                x: *const f32,
                sum: *mut f32,
                inputs: usize,
            ) {
                naked_asm!(
                    ".fpu vfpv3-fp16",
                    "vpush {{s16-s25}}",
                    "vldmia r2, {{s0-s3}}",
                    "lsrs r12, r3, #1",
                    "beq 3f",
                    "2:",
                    load!($precision, 8),
                    "vldmia r1!, {{s24-s25}}",
                    "vmul.f32 s8, s8, s24",
                    "vmul.f32 s9, s9, s24",
                    "vmul.f32 s10, s10, s24",
                    "vmul.f32 s11, s11, s24",
                    "vmul.f32 s12, s12, s25",
                    "vmul.f32 s13, s13, s25",
                    "vmul.f32 s14, s14, s25",
                    "vmul.f32 s15, s15, s25",
                    "vadd.f32 s0, s0, s8",
                    "vadd.f32 s1, s1, s9",
                    "vadd.f32 s2, s2, s10",
                    "vadd.f32 s3, s3, s11",
                    "vadd.f32 s0, s0, s12",
                    "vadd.f32 s1, s1, s13",
                    "vadd.f32 s2, s2, s14",
                    "vadd.f32 s3, s3, s15",
                    "subs r12, r12, #1",
                    "bne 2b",
                    "3:",
                    "tst r3, #1",
                    "beq 4f",
                    load!($precision, 4),
                    "vldmia r1!, {{s24}}",
                    "vmul.f32 s8, s8, s24",
                    "vmul.f32 s9, s9, s24",
                    "vmul.f32 s10, s10, s24",
                    "vmul.f32 s11, s11, s24",
                    "vadd.f32 s0, s0, s8",
                    "vadd.f32 s1, s1, s9",
                    "vadd.f32 s2, s2, s10",
                    "vadd.f32 s3, s3, s11",
                    "4:",
                    "vstmia r2, {{s0-s3}}",
                    "vpop {{s16-s25}}",
                    "bx lr",
                )
            }

            #[inline]
            pub fn accumulate_4(rows: &[[$weight; 4]], x: &[f32], sum: &mut [f32; 4]) {
                aligned(rows, |first, rows| {
                    let x = x.get(first..).unwrap_or(&[]);
                    let inputs = rows.len().min(x.len());
                    // SAFETY: it reads `inputs` rows and `inputs` numbers, which both slices have at least, and reads and writes the sums.
                    unsafe { accumulate_4_asm(rows.as_ptr().cast(), x.as_ptr(), sum.as_mut_ptr(), inputs) };
                });
            }

            /// Takes rows, ȳ, x̄ and the number of inputs in r0 … r3.
            #[unsafe(naked)]
            unsafe extern "C" fn transposed_8_asm(
                rows: *const $weight,
                y_bar: *const f32,
                x_bar: *mut f32,
                inputs: usize,
            ) {
                naked_asm!(
                    ".fpu vfpv3-fp16",
                    "vpush {{s16-s25}}",
                    "vldmia r1, {{s0-s7}}",
                    "lsrs r12, r3, #1",
                    "beq 3f",
                    "2:",
                    load!($precision, 16),
                    "vldmia r2, {{s24-s25}}",
                    "vmul.f32 s8, s8, s0",
                    "vmul.f32 s9, s9, s1",
                    "vmul.f32 s10, s10, s2",
                    "vmul.f32 s11, s11, s3",
                    "vmul.f32 s12, s12, s4",
                    "vmul.f32 s13, s13, s5",
                    "vmul.f32 s14, s14, s6",
                    "vmul.f32 s15, s15, s7",
                    "vmul.f32 s16, s16, s0",
                    "vmul.f32 s17, s17, s1",
                    "vmul.f32 s18, s18, s2",
                    "vmul.f32 s19, s19, s3",
                    "vmul.f32 s20, s20, s4",
                    "vmul.f32 s21, s21, s5",
                    "vmul.f32 s22, s22, s6",
                    "vmul.f32 s23, s23, s7",
                    "vadd.f32 s8, s8, s12",
                    "vadd.f32 s9, s9, s13",
                    "vadd.f32 s10, s10, s14",
                    "vadd.f32 s11, s11, s15",
                    "vadd.f32 s8, s8, s10",
                    "vadd.f32 s9, s9, s11",
                    "vadd.f32 s8, s8, s9",
                    "vadd.f32 s16, s16, s20",
                    "vadd.f32 s17, s17, s21",
                    "vadd.f32 s18, s18, s22",
                    "vadd.f32 s19, s19, s23",
                    "vadd.f32 s16, s16, s18",
                    "vadd.f32 s17, s17, s19",
                    "vadd.f32 s16, s16, s17",
                    "vadd.f32 s24, s24, s8",
                    "vadd.f32 s25, s25, s16",
                    "vstmia r2!, {{s24-s25}}",
                    "subs r12, r12, #1",
                    "bne 2b",
                    "3:",
                    "tst r3, #1",
                    "beq 4f",
                    load!($precision, 8),
                    "vldmia r2, {{s24}}",
                    "vmul.f32 s8, s8, s0",
                    "vmul.f32 s9, s9, s1",
                    "vmul.f32 s10, s10, s2",
                    "vmul.f32 s11, s11, s3",
                    "vmul.f32 s12, s12, s4",
                    "vmul.f32 s13, s13, s5",
                    "vmul.f32 s14, s14, s6",
                    "vmul.f32 s15, s15, s7",
                    "vadd.f32 s8, s8, s12",
                    "vadd.f32 s9, s9, s13",
                    "vadd.f32 s10, s10, s14",
                    "vadd.f32 s11, s11, s15",
                    "vadd.f32 s8, s8, s10",
                    "vadd.f32 s9, s9, s11",
                    "vadd.f32 s8, s8, s9",
                    "vadd.f32 s24, s24, s8",
                    "vstmia r2!, {{s24}}",
                    "4:",
                    "vpop {{s16-s25}}",
                    "bx lr",
                )
            }

            #[inline]
            pub fn transposed_8(rows: &[[$weight; 8]], y_bar: &[f32; 8], x_bar: &mut [f32]) {
                aligned(rows, |first, rows| {
                    let x_bar = x_bar.get_mut(first..).unwrap_or_default();
                    let inputs = rows.len().min(x_bar.len());
                    // SAFETY: it reads `inputs` rows, and reads and writes `inputs` numbers; both slices have at least as many.
                    unsafe {
                        transposed_8_asm(rows.as_ptr().cast(), y_bar.as_ptr(), x_bar.as_mut_ptr(), inputs)
                    };
                });
            }

            /// Takes rows, ȳ, x̄ and the number of inputs in r0 … r3.
            #[unsafe(naked)]
            unsafe extern "C" fn transposed_4_asm(
                rows: *const $weight,
                y_bar: *const f32,
                x_bar: *mut f32,
                inputs: usize,
            ) {
                naked_asm!(
                    ".fpu vfpv3-fp16",
                    "vpush {{s16-s25}}",
                    "vldmia r1, {{s0-s3}}",
                    "lsrs r12, r3, #1",
                    "beq 3f",
                    "2:",
                    load!($precision, 8),
                    "vldmia r2, {{s24-s25}}",
                    "vmul.f32 s8, s8, s0",
                    "vmul.f32 s9, s9, s1",
                    "vmul.f32 s10, s10, s2",
                    "vmul.f32 s11, s11, s3",
                    "vmul.f32 s12, s12, s0",
                    "vmul.f32 s13, s13, s1",
                    "vmul.f32 s14, s14, s2",
                    "vmul.f32 s15, s15, s3",
                    "vadd.f32 s8, s8, s10",
                    "vadd.f32 s9, s9, s11",
                    "vadd.f32 s8, s8, s9",
                    "vadd.f32 s12, s12, s14",
                    "vadd.f32 s13, s13, s15",
                    "vadd.f32 s12, s12, s13",
                    "vadd.f32 s24, s24, s8",
                    "vadd.f32 s25, s25, s12",
                    "vstmia r2!, {{s24-s25}}",
                    "subs r12, r12, #1",
                    "bne 2b",
                    "3:",
                    "tst r3, #1",
                    "beq 4f",
                    load!($precision, 4),
                    "vldmia r2, {{s24}}",
                    "vmul.f32 s8, s8, s0",
                    "vmul.f32 s9, s9, s1",
                    "vmul.f32 s10, s10, s2",
                    "vmul.f32 s11, s11, s3",
                    "vadd.f32 s8, s8, s10",
                    "vadd.f32 s9, s9, s11",
                    "vadd.f32 s8, s8, s9",
                    "vadd.f32 s24, s24, s8",
                    "vstmia r2!, {{s24}}",
                    "4:",
                    "vpop {{s16-s25}}",
                    "bx lr",
                )
            }

            #[inline]
            pub fn transposed_4(rows: &[[$weight; 4]], y_bar: &[f32; 4], x_bar: &mut [f32]) {
                aligned(rows, |first, rows| {
                    let x_bar = x_bar.get_mut(first..).unwrap_or_default();
                    let inputs = rows.len().min(x_bar.len());
                    // SAFETY: it reads `inputs` rows, and reads and writes `inputs` numbers; both slices have at least as many.
                    unsafe {
                        transposed_4_asm(rows.as_ptr().cast(), y_bar.as_ptr(), x_bar.as_mut_ptr(), inputs)
                    };
                });
            }
        }
    };
}
loops!(single, f32);
loops!(half, crate::f16);
