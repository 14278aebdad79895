//! Reading and writing of an importer's memory.

use crate::FmuError;
use std::ffi::{CStr, c_char};
use std::slice;

/// Numbers of the importer.
///
/// # Safety
/// `at` is null or points to `count` numbers, which live as long as the slice.
pub(super) unsafe fn read<'a, T>(
    what: &'static str,
    at: *const T,
    count: usize,
) -> Result<&'a [T], FmuError> {
    if count == 0 {
        return Ok(&[]);
    }
    present(what, at)?;
    // SAFETY: not null, and the caller promises the rest.
    Ok(unsafe { slice::from_raw_parts(at, count) })
}

/// Writes numbers for the importer.
///
/// # Safety
/// `at` is null or points to memory for all these numbers.
pub(super) unsafe fn write<T: Copy>(what: &'static str, at: *mut T, values: &[T]) -> Result<(), FmuError> {
    if values.is_empty() {
        return Ok(());
    }
    present(what, at)?;
    // SAFETY: not null, and the caller promises memory of that length; it is not ours, so it does not overlap.
    unsafe { at.copy_from_nonoverlapping(values.as_ptr(), values.len()) };
    Ok(())
}

/// Text of the importer.
///
/// # Safety
/// `at` is null or points to a string that ends with 0 and lives as long as the result.
pub(super) unsafe fn text<'a>(what: &'static str, at: *const c_char) -> Result<&'a str, FmuError> {
    present(what, at)?;
    // SAFETY: not null, and the caller promises a string.
    unsafe { CStr::from_ptr(at) }.to_str().map_err(|_| FmuError::Text(what))
}

/// Returns an error for a null pointer.
pub(super) fn present<T>(what: &'static str, at: *const T) -> Result<(), FmuError> {
    if at.is_null() { Err(FmuError::Null(what)) } else { Ok(()) }
}
