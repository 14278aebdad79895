//! Loads of weights into registers, in assembly.

/// Widens both halves of a register; the upper first, for the lower may take the register's place.
macro_rules! widen {
    ($from:ident, $lower:ident, $upper:ident) => {
        concat!(
            concat!("vcvtt.f32.f16 ", stringify!($upper), ", ", stringify!($from), "\n"),
            concat!("vcvtb.f32.f16 ", stringify!($lower), ", ", stringify!($from), "\n"),
        )
    };
}

/// Loads the next weights, as single precision, to s8 and up.
macro_rules! load {
    (single, 4) => {
        "vldmia r0!, {{s8-s11}}"
    };
    (single, 8) => {
        "vldmia r0!, {{s8-s15}}"
    };
    (single, 16) => {
        "vldmia r0!, {{s8-s23}}"
    };
    (half, 4) => {
        concat!("vldmia r0!, {{s8-s9}}\n", widen!(s9, s10, s11), widen!(s8, s8, s9))
    };
    (half, 8) => {
        concat!(
            "vldmia r0!, {{s8-s11}}\n",
            widen!(s11, s14, s15),
            widen!(s10, s12, s13),
            widen!(s9, s10, s11),
            widen!(s8, s8, s9),
        )
    };
    (half, 16) => {
        concat!(
            load!(half, 8),
            "vldmia r0!, {{s16-s19}}\n",
            widen!(s19, s22, s23),
            widen!(s18, s20, s21),
            widen!(s17, s18, s19),
            widen!(s16, s16, s17),
        )
    };
}
