//! The entry points of both standards: pointers of the importer become slices, errors become messages and a status.
//!
//! Neither a wrong argument nor a panic leaves the library as anything but a status.

mod fmi2;
mod fmi2_missing;
mod fmi3;
mod fmi3_missing;
mod log;
mod memory;
mod resources;
mod states;

use crate::{FmuError, Instance};
use log::Log;
use memory::{read, write};
use std::any::Any;
use std::ffi::{c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr;

/// Functions for a missing part of the standard.
macro_rules! missing {
    ($($what:literal: $($name:ident($($argument:ty),*))*;)*) => {$($(
        #[unsafe(no_mangle)]
        unsafe extern "C" fn $name(instance: *mut c_void $(, _: $argument)*) -> c_int {
            unsafe { $crate::ffi::attempt(instance, |_| Err($crate::FmuError::Missing($what))) }
        }
    )*)*};
}
use missing;

/// Status of a call that succeeded, in both standards.
const OK: c_int = 0;
/// Status of a call that had no answer, in both standards.
const DISCARD: c_int = 2;
/// Status of a call that was refused, in both standards.
const ERROR: c_int = 3;

/// An instance, as the importer holds it.
struct Handle {
    instance: Instance,
    log: Log,
}

/// Creates an instance; null, and a message, if it cannot be.
fn instantiate(log: Log, make: impl FnOnce() -> Result<Instance, FmuError>) -> *mut c_void {
    match caught(make) {
        Ok(instance) => Box::into_raw(Box::new(Handle { instance, log })).cast(),
        Err(error) => {
            log.error(&error);
            ptr::null_mut()
        }
    }
}

/// Frees an instance; null is ignored.
///
/// # Safety
/// The pointer is null or that of an instance, which is not used again.
unsafe fn free(instance: *mut c_void) {
    if !instance.is_null() {
        // SAFETY: made by `instantiate`, and not freed before, as the caller promises.
        drop(unsafe { Box::from_raw(instance.cast::<Handle>()) });
    }
}

/// Does something with an instance, and returns a status; an error is logged. A null pointer cannot even be logged.
///
/// # Safety
/// The pointer is null or that of an instance, which no other thread uses.
unsafe fn attempt(instance: *mut c_void, work: impl FnOnce(&mut Instance) -> Result<(), FmuError>) -> c_int {
    // SAFETY: null, or made by `instantiate`, as the caller promises.
    let Some(Handle { instance, log }) = (unsafe { instance.cast::<Handle>().as_mut() }) else {
        return ERROR;
    };
    match caught(|| work(instance)) {
        Ok(()) => OK,
        Err(error) => {
            log.error(&error);
            ERROR
        }
    }
}

/// Writes one number per continuous state.
///
/// # Safety
/// `values` is null or has memory for `count` numbers; see [`attempt`].
unsafe fn per_state(
    instance: *mut c_void,
    values: *mut f64,
    count: usize,
    of: impl FnOnce(&Instance) -> Result<Vec<f64>, FmuError>,
) -> c_int {
    let work = |own: &mut Instance| {
        own.check_states(count)?;
        let found = of(own)?;
        unsafe { write("the list of continuous states", values, &found) }
    };
    unsafe { attempt(instance, work) }
}

/// Sets the continuous states.
///
/// # Safety
/// `values` is null or points to `count` numbers; see [`attempt`].
unsafe fn set_states(instance: *mut c_void, values: *const f64, count: usize) -> c_int {
    let work = |own: &mut Instance| {
        own.check_states(count)?;
        own.set_continuous_states(unsafe { read("the list of continuous states", values, count) }?)
    };
    unsafe { attempt(instance, work) }
}

/// Refuses to read or write variables of a type that no variable has; no variables at all are fine.
///
/// # Safety
/// See [`attempt`].
unsafe fn no_variables(instance: *mut c_void, count: usize, name: &'static str) -> c_int {
    unsafe { attempt(instance, |_| if count == 0 { Ok(()) } else { Err(FmuError::Type(name)) }) }
}

/// Runs something that must not panic; if it does, the panic is an error.
fn caught<T>(work: impl FnOnce() -> Result<T, FmuError>) -> Result<T, FmuError> {
    // Instances change only by assignments after everything that may fail, so they are whole after a panic.
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| Err(FmuError::Mistake(text(&*panic))))
}

fn text(panic: &(dyn Any + Send)) -> String {
    let known = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    known.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ffi::{CStr, c_char};

    unsafe extern "C" fn count(
        environment: *mut c_void,
        status: c_int,
        _: *const c_char,
        message: *const c_char,
    ) {
        assert_eq!(status, ERROR);
        // SAFETY: the tests pass a list, and the log a string.
        let (said, message) = unsafe { (&mut *environment.cast::<Vec<String>>(), CStr::from_ptr(message)) };
        said.push(message.to_string_lossy().into_owned());
    }

    #[test]
    fn null_pointers_are_refused() {
        let null = ptr::null_mut();
        // SAFETY: null is allowed.
        unsafe {
            assert_eq!(attempt(null, |_| Ok(())), ERROR);
            assert_eq!(states::get(null, ptr::null_mut()), ERROR);
            assert!(read::<f64>("the list", ptr::null(), 0).is_ok());
            assert!(matches!(read::<f64>("the list", ptr::null(), 1), Err(FmuError::Null("the list"))));
            assert!(matches!(write("the list", ptr::null_mut(), &[1.0]), Err(FmuError::Null("the list"))));
            free(null);
        }
    }

    #[test]
    fn a_panic_is_a_message_and_a_status() {
        let mut said: Vec<String> = Vec::new();
        let environment = ptr::from_mut(&mut said).cast();
        let made = instantiate(Log::Three { logger: Some(count), environment }, || panic!("100% wrong"));
        assert!(made.is_null());
        assert_eq!(said, ["a mistake in the library: 100% wrong; please report it"]);
    }
}
