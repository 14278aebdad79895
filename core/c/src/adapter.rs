//! Numbers of the model that follow the machine.

use crate::arguments::{Given, call, check_length, check_step, following_mut, vectors};
use crate::config::{LEASTACTION_COORDINATES as N, LEASTACTION_NUMBERS as P};
use crate::contents::{Following, Loaded, following_tag};
use crate::error::Error;
use crate::family::{self, Lists, Mechanism, Shape, Tuned};
use crate::load::{check_abi, cleared, keep, whole};
use crate::said::actuator;
use crate::status::Status;
use crate::storage::Adapter;
use leastaction_core::adapt::{self, Blocks, Reading, StoredSettings, Tunable};
use leastaction_core::forces::Actuator;
use leastaction_core::model::{parse_as, stored_fingerprint};

/// Begins an adapter that has seen nothing, and loads its model: from then on the model has the numbers in use, those of the file at first. Takes
/// less stack than twice the adapter's size.
///
/// - `adapter_bytes`: `sizeof(leastaction_adapter)`, which shows that the structs of this header are the library's.
/// - `abi`: LEASTACTION_ABI, which shows that the functions of this header are the library's.
/// - `file`, `file_bytes`: the whole model file, at a multiple of 4. It must stay there unchanged while the adapter is used.
/// - `settings`, `settings_bytes`: the whole file of settings that `leastaction adapt --settings` wrote for the model. It is copied.
/// - `h`: tick of the loop that calls leastaction_adapter_tick, s.
/// - `error`: filled in; may be NULL.
///
/// Fails with statuses 1 to 3, 6, 11, 20 to 69 and 100 to 113; `adapter` then holds neither adapter nor model, even if it did before.
///
/// # Safety
/// Pointers are NULL or point to the stated number of bytes.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "adapter_begin"))]
pub unsafe extern "C" fn leastaction_adapter_begin(
    adapter: *mut Adapter,
    adapter_bytes: usize,
    abi: u32,
    file: *const u8,
    file_bytes: usize,
    settings: *const u8,
    settings_bytes: usize,
    h: f32,
    error: *mut Error,
) -> Status {
    let begin = || {
        let place = Given::new(adapter, 1)?.pointer();
        check_length(size_of::<Adapter>(), adapter_bytes)?;
        check_abi(abi)?;
        let (model, own) = parts(place);
        // SAFETY: the caller's storage, which is large enough for its contents and as aligned.
        let lists = unsafe {
            (&raw mut (*own).tag).write(0);
            cleared(model)
        };
        // SAFETY: the caller's promise.
        let (file, settings) = unsafe { (whole(file, file_bytes, 4)?, whole(settings, settings_bytes, 6)?) };
        let fingerprint = stored_fingerprint(file).unwrap_or(0);
        // SAFETY: as above.
        unsafe {
            let mechanism = mechanism(&raw mut (*own).drive, file, h, lists)?;
            tune(&raw mut (*own).tuned, file)?;
            tell(own, settings, fingerprint, h)?;
            forget(own)?;
            (&raw mut (*own).frozen).write(false);
            (&raw mut (*own).tag).write(following_tag(own));
            keep(model, mechanism, fingerprint);
            refresh(place);
        }
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { call(error, begin) }
}

/// Places of the model and of everything else in an adapter's storage.
fn parts(place: *mut Adapter) -> (*mut Loaded, *mut Following) {
    // SAFETY: addresses within one storage; nothing is read.
    unsafe { ((&raw mut (*place).model).cast(), (&raw mut (*place).opaque).cast()) }
}

// The parts of an adapter are written one after the other, each by a function of its own, so that the stack never holds all of them.

/// Returns the mechanism of a model file, and writes its drives.
///
/// # Safety
/// `drive` can be written to.
#[inline(never)]
unsafe fn mechanism(
    drive: *mut Actuator<f32, N>,
    file: &'static [u8],
    h: f32,
    lists: &'static mut Lists,
) -> Result<Mechanism, Error> {
    check_step(h)?;
    // SAFETY: mechanisms of this family have no name.
    let mechanism = unsafe { family::load(file, core::ptr::null(), lists) }?;
    let (_, own) = actuator(&mechanism, h)?;
    // SAFETY: this function's promise.
    unsafe { drive.write(own) };
    Ok(mechanism)
}

/// Writes the model with a block of its own numbers.
///
/// # Safety
/// `tuned` can be written to.
#[inline(never)]
unsafe fn tune(tuned: *mut Tuned, file: &'static [u8]) -> Result<(), Error> {
    let parsed = parse_as::<Shape, f32>(file)?;
    // SAFETY: this function's promise.
    unsafe { tuned.write(Tuned::new(&parsed, parsed.shape.tree()?)?) };
    Ok(())
}

/// Writes what the settings say.
///
/// # Safety
/// `own` can be written to.
#[inline(never)]
unsafe fn tell(own: *mut Following, settings: &[u8], fingerprint: u32, h: f32) -> Result<(), Error> {
    let stored = StoredSettings::<N, P>::read(settings, fingerprint)?;
    stored.check_tick(h)?;
    // SAFETY: this function's promise.
    unsafe {
        (&raw mut (*own).tuning).write(stored.settings.tuning()?);
        (&raw mut (*own).count).write(stored.settings.numbers.len() as u8);
        (&raw mut (*own).announcement).write(stored.announcement);
        (&raw mut (*own).blocks).write(Blocks::new(stored.block, h));
    }
    Ok(())
}

/// Writes an adapter that has seen nothing.
///
/// # Safety
/// `own` can be written to, and knows its settings.
#[inline(never)]
pub(crate) unsafe fn forget(own: *mut Following) -> Result<(), Error> {
    // SAFETY: this function's promise.
    unsafe { (&raw mut (*own).adapter).write(adapt::Adapter::new(&(*own).tuning)?) };
    Ok(())
}

/// Lets the model have the numbers in use. Its references into the block are made anew, since the block has been written to.
///
/// # Safety
/// An adapter has begun there, and nothing else uses it meanwhile.
pub(crate) unsafe fn refresh(place: *mut Adapter) {
    let (model, own) = parts(place);
    // SAFETY: this function's promise; the block stays where it is as long as the model is used, as the header requires.
    unsafe {
        let tuned: &'static Tuned = &(*own).tuned;
        (&raw mut (*model).mechanism.system).write(tuned.in_use());
    }
}

impl Following {
    /// Takes a tick, `None` for one of which nothing can be learned.
    fn tick(&mut self, reading: Option<&Reading<f32, N>>) {
        let Self { frozen, tuned, tuning, drive, blocks, adapter, .. } = self;
        let command = |force: &_| drive.command(force);
        _ = adapter.follow(tuning, tuned, blocks, reading, *frozen, command);
    }
}

/// Learns from a tick of the loop, and sets the model's numbers in use. Call it, or leastaction_adapter_skip, once in every tick; a tick that was
/// missed altogether is skipped, too. At the end of every block of ticks, as many as the settings say, the numbers move towards what was found,
/// and never in a jump; a tick in which a window of the balance ends takes longest.
///
/// - `q`: position by the encoders alone (m or rad), without jumps by whole turns, `n` numbers.
/// - `force`: force at the outputs of the drives (N or N m), the mean of those just before and just after the time of `q`: half the sum of the
///   last step's `u1` and the next one's `u0`; or what was measured. `n` numbers.
/// - `n`: LEASTACTION_COORDINATES.
/// - `error`: filled in; may be NULL.
///
/// Fails with statuses 1 to 3, 15 and 71; nothing is then changed, and the tick can still be skipped.
///
/// # Safety
/// Pointers are NULL or point to the stated number of numbers.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "adapter_tick"))]
pub unsafe extern "C" fn leastaction_adapter_tick(
    adapter: *mut Adapter,
    q: *const f32,
    force: *const f32,
    n: usize,
    error: *mut Error,
) -> Status {
    let tick = || {
        // SAFETY: the caller's promise.
        let (own, [q, force]) = unsafe { (following_mut(adapter)?, vectors([q, force], 2, n)?) };
        own.tick(Some(&Reading { q, force }));
        // SAFETY: an adapter was found there.
        unsafe { refresh(adapter) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { call(error, tick) }
}

/// Passes a tick of which nothing can be learned, and drops what was seen of the open windows: a reading was missing, a tick came late, or a
/// drive did not do what it was told. The numbers in use go on towards what was found. Fails with statuses 1, 2 and 15.
///
/// # Safety
/// Pointers are NULL or point to values of their type.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "adapter_skip"))]
pub unsafe extern "C" fn leastaction_adapter_skip(adapter: *mut Adapter, error: *mut Error) -> Status {
    let skip = || {
        // SAFETY: the caller's promise.
        unsafe { following_mut(adapter) }?.tick(None);
        // SAFETY: an adapter was found there.
        unsafe { refresh(adapter) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { call(error, skip) }
}

/// Freezes the numbers in use, which then stay what they are and learn nothing, or lets them follow again, if `frozen` is 0. A loop goes on
/// calling leastaction_adapter_tick. Fails with statuses 1, 2 and 15.
///
/// # Safety
/// Pointers are NULL or point to values of their type.
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "adapter_freeze"))]
pub unsafe extern "C" fn leastaction_adapter_freeze(
    adapter: *mut Adapter,
    frozen: u8,
    error: *mut Error,
) -> Status {
    let freeze = || {
        // SAFETY: the caller's promise.
        unsafe { following_mut(adapter) }?.frozen = frozen != 0;
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { call(error, freeze) }
}
