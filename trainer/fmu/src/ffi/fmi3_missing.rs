//! FMI 3.0: the functions for what a unit does not have. They say so.

use super::{missing, no_variables};
use std::ffi::{c_char, c_int, c_void};

/// Getter and setter of each type without variables.
macro_rules! types {
    ($($get:ident, $set:ident, $value:ty, $name:literal;)*) => {$(
        #[unsafe(no_mangle)]
        unsafe extern "C" fn $get(
            instance: *mut c_void,
            _references: *const u32,
            count: usize,
            _values: *mut $value,
            _values_count: usize,
        ) -> c_int {
            unsafe { no_variables(instance, count, $name) }
        }

        #[unsafe(no_mangle)]
        unsafe extern "C" fn $set(
            instance: *mut c_void,
            _references: *const u32,
            count: usize,
            _values: *const $value,
            _values_count: usize,
        ) -> c_int {
            unsafe { no_variables(instance, count, $name) }
        }
    )*};
}

types! {
    fmi3GetFloat32, fmi3SetFloat32, f32, "Float32";
    fmi3GetInt8, fmi3SetInt8, i8, "Int8";
    fmi3GetUInt8, fmi3SetUInt8, u8, "UInt8";
    fmi3GetInt16, fmi3SetInt16, i16, "Int16";
    fmi3GetUInt16, fmi3SetUInt16, u16, "UInt16";
    fmi3GetInt32, fmi3SetInt32, i32, "Int32";
    fmi3GetUInt32, fmi3SetUInt32, u32, "UInt32";
    fmi3GetInt64, fmi3SetInt64, i64, "Int64";
    fmi3GetUInt64, fmi3SetUInt64, u64, "UInt64";
    fmi3GetBoolean, fmi3SetBoolean, bool, "Boolean";
    fmi3GetString, fmi3SetString, *const c_char, "String";
}

missing! {
    "binary variables":
        fmi3GetBinary(*const u32, usize, *mut usize, *mut *const u8, usize)
        fmi3SetBinary(*const u32, usize, *const usize, *const *const u8, usize);
    "clocks":
        fmi3GetClock(*const u32, usize, *mut bool)
        fmi3SetClock(*const u32, usize, *const bool)
        fmi3GetIntervalDecimal(*const u32, usize, *mut f64, *mut c_int)
        fmi3GetIntervalFraction(*const u32, usize, *mut u64, *mut u64, *mut c_int)
        fmi3GetShiftDecimal(*const u32, usize, *mut f64)
        fmi3GetShiftFraction(*const u32, usize, *mut u64, *mut u64)
        fmi3SetIntervalDecimal(*const u32, usize, *const f64)
        fmi3SetIntervalFraction(*const u32, usize, *const u64, *const u64)
        fmi3SetShiftDecimal(*const u32, usize, *const f64)
        fmi3SetShiftFraction(*const u32, usize, *const u64, *const u64)
        fmi3ActivateModelPartition(u32, f64);
    "dependencies of single elements":
        fmi3GetNumberOfVariableDependencies(u32, *mut usize)
        fmi3GetVariableDependencies(u32, *mut usize, *mut u32, *mut usize, *mut c_int, usize);
    "directional derivatives":
        fmi3GetDirectionalDerivative(*const u32, usize, *const u32, usize, *const f64, usize, *mut f64, usize)
        fmi3GetAdjointDerivative(*const u32, usize, *const u32, usize, *const f64, usize, *mut f64, usize);
    "derivatives of outputs with respect to time":
        fmi3GetOutputDerivatives(*const u32, usize, *const i32, *mut f64, usize);
    "structural parameters":
        fmi3EnterConfigurationMode()
        fmi3ExitConfigurationMode();
    "discrete states":
        fmi3EvaluateDiscreteStates();
    "event mode in co-simulation":
        fmi3EnterStepMode();
}
