//! Patches: findings of an adapter, saved for when the power is on again.

use crate::adapter::{forget, refresh};
use crate::arguments::{Given, call, following, following_mut};
use crate::config::{LEASTACTION_NUMBERS as P, LEASTACTION_PATCH_BYTES};
use crate::contents::{Following, Loaded};
use crate::error::Error;
use crate::load::whole;
use crate::status::Status;
use crate::storage::Adapter;
use leastaction_core::adapt::{Patch, Tunable};

const _: () = assert!(LEASTACTION_PATCH_BYTES == Patch::<P>::MAX_BYTES);

/// Writes the distances in use with their standard errors, a patch of the model, which `leastaction inspect --patch` and `convert --patch` read.
///
/// - `patch`, `patch_bytes`: memory of at least LEASTACTION_PATCH_BYTES, any alignment.
/// - `written`: how many bytes the patch has, written on success only.
/// - `error`: filled in; may be NULL.
///
/// Fails with statuses 1 to 3 and 15; the memory is then unchanged.
///
/// # Safety
/// Pointers are NULL or point to values of their type, `patch` to the stated number of bytes.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "adapter_save"))]
pub unsafe extern "C" fn leastaction_adapter_save(
    adapter: *const Adapter,
    patch: *mut u8,
    patch_bytes: usize,
    written: *mut usize,
    error: *mut Error,
) -> Status {
    let save = || {
        // SAFETY: the caller's promise.
        let (own, model) = unsafe { (following(adapter)?, fingerprint(adapter)) };
        let (to, written) = (Given::new(patch, 2)?.pointer(), Given::new(written, 4)?);
        let short = Error::new(Status::WrongLength, [LEASTACTION_PATCH_BYTES, patch_bytes]);
        if patch_bytes < LEASTACTION_PATCH_BYTES {
            return Err(short);
        }
        let mut memory = [0; LEASTACTION_PATCH_BYTES];
        let bytes = own.adapter.patch(&own.tuning, model).write(&mut memory).map_err(|_| short)?;
        // SAFETY: the caller's promise; there are at most as many bytes as were checked.
        unsafe {
            to.copy_from_nonoverlapping(bytes.as_ptr(), bytes.len());
            written.write(bytes.len());
        }
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { call(error, save) }
}

/// Begins anew with the distances of a patch within the limits, which are in use at once; what is known of them is what the settings say of
/// numbers of which nothing was seen. Numbers that the patch does not have begin at those of the model.
///
/// - `patch`, `patch_bytes`: the whole patch, of leastaction_adapter_save or `leastaction adapt --patch`, any alignment. It is copied.
/// - `error`: filled in; may be NULL.
///
/// Fails with statuses 1 to 3, 15 and 120 to 126; nothing is then changed.
///
/// # Safety
/// Pointers are NULL or point to values of their type, `patch` to the stated number of bytes.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "adapter_restore"))]
pub unsafe extern "C" fn leastaction_adapter_restore(
    adapter: *mut Adapter,
    patch: *const u8,
    patch_bytes: usize,
    error: *mut Error,
) -> Status {
    let restore = || {
        // SAFETY: the caller's promise.
        let (own, bytes) = unsafe { (following_mut(adapter)?, whole(patch, patch_bytes, 2)?) };
        // SAFETY: an adapter was found there.
        begin_with(own, bytes, unsafe { fingerprint(adapter) })?;
        // SAFETY: as above.
        unsafe { refresh(adapter) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { call(error, restore) }
}

/// Reads a patch of the model with this fingerprint, and begins with it.
#[inline(never)]
fn begin_with(own: &mut Following, bytes: &[u8], model: u32) -> Result<(), Error> {
    let patch = Patch::read(bytes, model)?;
    // SAFETY: it has begun.
    unsafe { forget(own) }?;
    let Following { tuned, tuning, adapter, .. } = own;
    adapter.begin_with(tuning, &patch);
    tuned.set(&tuning.numbers, adapter.applied());
    Ok(())
}

/// Fingerprint of the model.
///
/// # Safety
/// An adapter has begun there.
unsafe fn fingerprint(adapter: *const Adapter) -> u32 {
    // SAFETY: this function's promise: the storage holds a model.
    unsafe { (&raw const (*(&raw const (*adapter).model).cast::<Loaded>()).fingerprint).read() }
}
