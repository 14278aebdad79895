use crate::arguments::{Given, call, check_length};
use crate::config::LEASTACTION_ABI;
use crate::contents::{Loaded, loaded_tag};
use crate::error::Error;
use crate::family::{self, FAMILY, Lists, Mechanism};
use crate::status::Status;
use crate::storage::Model;
use core::ffi::{CStr, c_char};
use leastaction_core::model::stored_fingerprint;

/// Reads and validates a model file, and prepares it in `model`. Weights stay where they are, in flash.
///
/// - `model_bytes`: `sizeof(leastaction_model)`, which shows that the structs of this header are the library's.
/// - `abi`: LEASTACTION_ABI, which shows that the functions of this header are the library's.
/// - `file`, `file_bytes`: the whole file, at a multiple of 4. It must stay there unchanged while the model is used.
/// - `name`: name of the tree or graph to take, ended by a zero; not read, and may be NULL, for inertia networks, bodies and arms.
/// - `error`: filled in; may be NULL.
///
/// Fails with statuses 1 to 3, 7, 9, 11 and 20 to 69; `model` then holds no model, even if it did before.
///
/// # Safety
/// Pointers are NULL or point to the stated number of bytes.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "load"))]
pub unsafe extern "C" fn leastaction_load(
    model: *mut Model,
    model_bytes: usize,
    abi: u32,
    file: *const u8,
    file_bytes: usize,
    name: *const c_char,
    error: *mut Error,
) -> Status {
    let load = || {
        let place = Given::new(model, 1)?.pointer().cast::<Loaded>();
        check_length(size_of::<Model>(), model_bytes)?;
        check_abi(abi)?;
        // SAFETY: the caller's storage, which is large enough for its contents and as aligned.
        let lists = unsafe { cleared(place) };
        // SAFETY: the caller's promise.
        let bytes = unsafe { whole(file, file_bytes, 4) }?;
        // SAFETY: the caller's promise.
        let mechanism = unsafe { family::load(bytes, name, lists) }?;
        // SAFETY: as above; the lists that the mechanism refers to are another part of the storage.
        unsafe { keep(place, mechanism, stored_fingerprint(bytes).unwrap_or(0)) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { call(error, load) }
}

pub(crate) fn check_abi(given: u32) -> Result<(), Error> {
    let right = LEASTACTION_ABI;
    if given == right { Ok(()) } else { Err(Error::of(Status::OtherAbi, [right, given, 0])) }
}

/// Marks the storage as not loaded, and hands out its memory for lists.
///
/// # Safety
/// `place` can be written to, and the memory handed out is used before it is cleared again.
pub(crate) unsafe fn cleared(place: *mut Loaded) -> &'static mut Lists {
    // SAFETY: this function's promise; lists are written before they are referred to.
    unsafe {
        (&raw mut (*place).tag).write(0);
        let lists = &raw mut (*place).lists;
        lists.write(Lists::empty());
        &mut *lists
    }
}

/// Writes a loaded mechanism beside its lists, and marks the storage as loaded.
///
/// # Safety
/// `place` can be written to.
pub(crate) unsafe fn keep(place: *mut Loaded, mechanism: Mechanism, fingerprint: u32) {
    // SAFETY: this function's promise.
    unsafe {
        (&raw mut (*place).mechanism).write(mechanism);
        (&raw mut (*place).fingerprint).write(fingerprint);
        (&raw mut (*place).tag).write(loaded_tag(place));
    }
}

/// The bytes of a file, whose pointer is at position `argument` among the arguments.
///
/// # Safety
/// `file` points to `file_bytes` bytes for as long as they are used.
pub(crate) unsafe fn whole(
    file: *const u8,
    file_bytes: usize,
    argument: usize,
) -> Result<&'static [u8], Error> {
    let file = Given::new(file, argument)?;
    let most = isize::MAX as usize;
    if file_bytes > most {
        return Err(Error::new(Status::WrongLength, [most, file_bytes]));
    }
    // SAFETY: not NULL, and not longer than an allocation can be; the rest is this function's promise.
    Ok(unsafe { core::slice::from_raw_parts(file.pointer(), file_bytes) })
}

/// The family that the library was built for: "inertia-network", "modular", "graph", "bodies" or "arm".
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "family"))]
pub extern "C" fn leastaction_family() -> *const c_char {
    FAMILY.as_ptr()
}

/// Version of the library, such as "0.1.0".
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "version"))]
pub extern "C" fn leastaction_version() -> *const c_char {
    const VERSION: &CStr =
        match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
            Ok(version) => version,
            Err(_) => panic!("a version without zeros"),
        };
    VERSION.as_ptr()
}

/// Number of the library's binary interface: LEASTACTION_ABI of its header. It changes with any struct or function that a program was
/// compiled with.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "abi"))]
pub extern "C" fn leastaction_abi() -> u32 {
    LEASTACTION_ABI
}
