//! FMI 2.0: the functions for what a unit does not have. They say so.

use super::{missing, no_variables};
use std::ffi::{c_char, c_int, c_uint, c_void};

/// Getter and setter of each type without variables.
macro_rules! types {
    ($($get:ident, $set:ident, $value:ty, $name:literal;)*) => {$(
        #[unsafe(no_mangle)]
        unsafe extern "C" fn $get(
            instance: *mut c_void,
            _references: *const c_uint,
            count: usize,
            _values: *mut $value,
        ) -> c_int {
            unsafe { no_variables(instance, count, $name) }
        }

        #[unsafe(no_mangle)]
        unsafe extern "C" fn $set(
            instance: *mut c_void,
            _references: *const c_uint,
            count: usize,
            _values: *const $value,
        ) -> c_int {
            unsafe { no_variables(instance, count, $name) }
        }
    )*};
}

types! {
    fmi2GetInteger, fmi2SetInteger, c_int, "Integer";
    fmi2GetBoolean, fmi2SetBoolean, c_int, "Boolean";
    fmi2GetString, fmi2SetString, *const c_char, "String";
}

missing! {
    "directional derivatives":
        fmi2GetDirectionalDerivative(*const c_uint, usize, *const c_uint, usize, *const f64, *mut f64);
    "derivatives of inputs and outputs with respect to time":
        fmi2SetRealInputDerivatives(*const c_uint, usize, *const c_int, *const f64)
        fmi2GetRealOutputDerivatives(*const c_uint, usize, *const c_int, *mut f64);
    "steps in the background":
        fmi2CancelStep();
}
