//! States that an importer keeps; both standards handle them alike.

use super::attempt;
use super::memory::{present, read, write};
use crate::{FmuError, State};
use std::ffi::{c_int, c_void};
use std::ptr;

/// Stores the instance's state in `*at`: in a new one if that is null, else in place of the one there.
///
/// # Safety
/// `*at` is null or a state from here; see [`attempt`].
pub(super) unsafe fn get(instance: *mut c_void, at: *mut *mut c_void) -> c_int {
    let work = |instance: &mut crate::Instance| {
        present("the place of the state", at)?;
        // SAFETY: not null, and the caller promises null or a state of ours in it.
        unsafe { store(at, instance.state().clone()) };
        Ok(())
    };
    // SAFETY: the caller promises a pointer to an instance.
    unsafe { attempt(instance, work) }
}

/// Stores a state in `*at`.
///
/// # Safety
/// `at` can be written; `*at` is null or a state from here.
unsafe fn store(at: *mut *mut c_void, state: State) {
    // SAFETY: promised by the caller.
    match unsafe { (*at).cast::<State>().as_mut() } {
        Some(old) => *old = state,
        None => unsafe { *at = Box::into_raw(Box::new(state)).cast() },
    }
}

/// Restores a state.
///
/// # Safety
/// `state` is null or a state from here; see [`attempt`].
pub(super) unsafe fn set(instance: *mut c_void, state: *mut c_void) -> c_int {
    // SAFETY: promised by the caller.
    unsafe { attempt(instance, |instance| instance.restore(of(state)?)) }
}

/// The state of the importer.
///
/// # Safety
/// `state` is null or a state from here, which lives as long as the result.
unsafe fn of<'a>(state: *mut c_void) -> Result<&'a State, FmuError> {
    // SAFETY: promised by the caller.
    unsafe { state.cast::<State>().as_ref() }.ok_or(FmuError::Null("the state"))
}

/// Frees the state in `*at`, and makes it null.
///
/// # Safety
/// `*at` is null or a state from here; see [`attempt`].
pub(super) unsafe fn free(instance: *mut c_void, at: *mut *mut c_void) -> c_int {
    let work = |_: &mut crate::Instance| {
        if at.is_null() {
            return Ok(());
        }
        // SAFETY: not null, and the caller promises null or a state of ours in it.
        let state = unsafe { ptr::replace(at, ptr::null_mut()) };
        if !state.is_null() {
            // SAFETY: made by `store`.
            drop(unsafe { Box::from_raw(state.cast::<State>()) });
        }
        Ok(())
    };
    // SAFETY: promised by the caller.
    unsafe { attempt(instance, work) }
}

/// Writes the number of bytes of a state.
///
/// # Safety
/// See [`set`]; `size` is null or can be written.
pub(super) unsafe fn size(instance: *mut c_void, state: *mut c_void, size: *mut usize) -> c_int {
    // SAFETY: promised by the caller.
    unsafe { attempt(instance, |_| write("the size", size, &[of(state)?.to_bytes()?.len()])) }
}

/// Writes a state as bytes.
///
/// # Safety
/// See [`set`]; `bytes` is null or has memory for `size` bytes.
pub(super) unsafe fn serialize(
    instance: *mut c_void,
    state: *mut c_void,
    bytes: *mut u8,
    size: usize,
) -> c_int {
    let work = |_: &mut crate::Instance| {
        // SAFETY: promised by the caller.
        let own = unsafe { of(state) }?.to_bytes()?;
        FmuError::check_length("the serialised state", own.len(), size)?;
        // SAFETY: promised by the caller.
        unsafe { write("the serialised state", bytes, &own) }
    };
    // SAFETY: promised by the caller.
    unsafe { attempt(instance, work) }
}

/// Reads a state from bytes into `*at`, as [`get`] does.
///
/// # Safety
/// `bytes` is null or points to `size` bytes; see [`get`].
pub(super) unsafe fn deserialize(
    instance: *mut c_void,
    bytes: *const u8,
    size: usize,
    at: *mut *mut c_void,
) -> c_int {
    let work = |_: &mut crate::Instance| {
        present("the place of the state", at)?;
        // SAFETY: promised by the caller.
        let state = State::from_bytes(unsafe { read("the serialised state", bytes, size) }?)?;
        // SAFETY: not null, and the caller promises null or a state of ours in it.
        unsafe { store(at, state) };
        Ok(())
    };
    // SAFETY: promised by the caller.
    unsafe { attempt(instance, work) }
}
