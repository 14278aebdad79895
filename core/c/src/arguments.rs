//! Checks of a caller's arguments, made before anything is done with them.

use crate::config::LEASTACTION_COORDINATES;
use crate::contents::{CorePlan, Loaded, Planned, STARTED, Started, loaded_tag, planned_tag};
#[cfg(feature = "adapt")]
use crate::contents::{Following, following_tag};
use crate::error::Error;
use crate::family::Mechanism;
use crate::status::Status;
#[cfg(feature = "adapt")]
use crate::storage::Adapter;
use crate::storage::{Model, Plan, State};
use core::ptr::NonNull;

/// A vector of all coordinates.
pub(crate) type Vector = [f32; LEASTACTION_COORDINATES];

/// A pointer to a T, not NULL and aligned.
pub(crate) struct Given<T>(NonNull<T>);

impl<T> Given<T> {
    /// Checks the pointer at position `argument` among the arguments, from 1.
    pub fn new(pointer: *const T, argument: usize) -> Result<Self, Error> {
        let pointer = NonNull::new(pointer.cast_mut());
        let pointer = pointer.ok_or(Error::new(Status::NullPointer, [argument]))?;
        if pointer.is_aligned() { Ok(Self(pointer)) } else { Err(Error::new(Status::Misaligned, [argument])) }
    }

    /// Checks a pointer that may be NULL.
    pub fn optional(pointer: *const T, argument: usize) -> Result<Option<Self>, Error> {
        if pointer.is_null() { Ok(None) } else { Self::new(pointer, argument).map(Some) }
    }

    pub fn pointer(&self) -> *mut T {
        self.0.as_ptr()
    }

    /// Copies the value.
    ///
    /// # Safety
    /// The pointer can be read as a T.
    pub unsafe fn read(&self) -> T
    where
        T: Copy,
    {
        // SAFETY: not NULL and aligned; the rest is this function's promise.
        unsafe { self.0.read() }
    }

    /// Writes a value.
    ///
    /// # Safety
    /// The pointer can be written to.
    pub unsafe fn write(&self, value: T) {
        // SAFETY: not NULL and aligned; the rest is this function's promise.
        unsafe { self.0.write(value) }
    }
}

/// Checks that an array has the right length.
pub(crate) fn check_length(right: usize, given: usize) -> Result<(), Error> {
    if given == right { Ok(()) } else { Err(Error::new(Status::WrongLength, [right, given])) }
}

/// Copies arrays of `n` numbers, which must be finite; `first` is the position of the first array among the arguments.
///
/// # Safety
/// Each has `n` numbers.
pub(crate) unsafe fn vectors<const K: usize>(
    pointers: [*const f32; K],
    first: usize,
    n: usize,
) -> Result<[Vector; K], Error> {
    // SAFETY: this function's promise.
    let copies = unsafe { numbers(pointers, first, n) }?;
    copies.iter().try_for_each(|copy| finite(*copy).map(drop))?;
    Ok(copies)
}

/// Copies arrays like [`vectors`], but allows numbers that are not finite.
///
/// # Safety
/// Each has `n` numbers.
pub(crate) unsafe fn numbers<const K: usize>(
    pointers: [*const f32; K],
    first: usize,
    n: usize,
) -> Result<[Vector; K], Error> {
    check_length(LEASTACTION_COORDINATES, n)?;
    let mut copies = [[0.0; LEASTACTION_COORDINATES]; K];
    for (i, (copy, pointer)) in copies.iter_mut().zip(pointers).enumerate() {
        // SAFETY: it has n numbers, which is what a vector has.
        *copy = unsafe { Given::new(pointer.cast::<Vector>(), first + i)?.read() };
    }
    Ok(copies)
}

/// An array to which a vector is written.
pub(crate) fn output(pointer: *mut f32, argument: usize) -> Result<Given<Vector>, Error> {
    Given::new(pointer.cast(), argument)
}

/// The mechanism that is loaded in a model's storage.
///
/// # Safety
/// `model` is storage as the header requires, and nothing else uses it meanwhile.
pub(crate) unsafe fn loaded<'a>(model: *const Model) -> Result<&'a Mechanism, Error> {
    // SAFETY: this function's promise.
    unsafe { contents(model, 1) }.map(|loaded| &loaded.mechanism)
}

/// Everything that is loaded in a model's storage.
///
/// # Safety
/// See [`loaded`].
pub(crate) unsafe fn contents<'a>(model: *const Model, argument: usize) -> Result<&'a Loaded, Error> {
    let pointer = Given::new(model, argument)?.pointer().cast::<Loaded>();
    // SAFETY: a word of the caller's storage, which is larger and as aligned.
    let tag = unsafe { (&raw const (*pointer).tag).read() };
    if tag != loaded_tag(pointer) {
        return Err(Status::NotLoaded.into());
    }
    // SAFETY: the tag is written last, when a mechanism is there.
    Ok(unsafe { &*pointer })
}

/// The plan that is loaded in a plan's storage.
///
/// # Safety
/// `plan` is storage as the header requires, and nothing else uses it meanwhile.
pub(crate) unsafe fn planned<'a>(plan: *const Plan) -> Result<&'a CorePlan, Error> {
    let pointer = Given::new(plan, 1)?.pointer().cast::<Planned>();
    // SAFETY: a word of the caller's storage, which is larger and as aligned.
    let tag = unsafe { (&raw const (*pointer).tag).read() };
    if tag != planned_tag(pointer) {
        return Err(Status::NoPlan.into());
    }
    // SAFETY: the tag is written last, when a plan is there.
    Ok(unsafe { &(*pointer).plan })
}

/// The adapter that has begun in a storage.
///
/// # Safety
/// `adapter` is storage as the header requires, and nothing else uses it meanwhile.
#[cfg(feature = "adapt")]
pub(crate) unsafe fn following<'a>(adapter: *const Adapter) -> Result<&'a Following, Error> {
    // SAFETY: this function's promise.
    unsafe { begun(adapter).map(|place| &*place) }
}

/// The adapter that has begun in a storage, to be changed.
///
/// # Safety
/// See [`following`].
#[cfg(feature = "adapt")]
pub(crate) unsafe fn following_mut<'a>(adapter: *mut Adapter) -> Result<&'a mut Following, Error> {
    // SAFETY: this function's promise.
    unsafe { begun(adapter).map(|place| &mut *place) }
}

/// Place of the adapter that has begun in a storage.
///
/// # Safety
/// See [`following`].
#[cfg(feature = "adapt")]
unsafe fn begun(adapter: *const Adapter) -> Result<*mut Following, Error> {
    let place = Given::new(adapter, 1)?.pointer();
    // SAFETY: part of the caller's storage.
    let pointer = unsafe { &raw mut (*place).opaque }.cast::<Following>();
    // SAFETY: a word of the caller's storage, which is larger and as aligned.
    let tag = unsafe { (&raw const (*pointer).tag).read() };
    if tag != following_tag(pointer) {
        return Err(Status::NoAdapter.into());
    }
    Ok(pointer)
}

/// Address of the started state in a storage.
pub(crate) fn place(state: *const State, argument: usize) -> Result<Given<Started>, Error> {
    Given::new(state, argument)?;
    Given::new(state.cast(), argument)
}

/// The state that was started in a storage.
///
/// # Safety
/// `state` is storage as the header requires.
pub(crate) unsafe fn started(state: *const State, argument: usize) -> Result<Started, Error> {
    let place = place(state, argument)?;
    // SAFETY: every bit pattern of the caller's storage is a `Started`: numbers only.
    let started = unsafe { place.read() };
    if started.tag == STARTED { Ok(started) } else { Err(Status::NotStarted.into()) }
}

/// Checks a step size.
pub(crate) fn check_step(h: f32) -> Result<(), Error> {
    if h > 0.0 && h.is_finite() { Ok(()) } else { Err(Status::BadStep.into()) }
}

/// Fails unless all numbers are finite.
pub(crate) fn finite<const K: usize>(x: [f32; K]) -> Result<[f32; K], Error> {
    if x.iter().all(|x| x.is_finite()) { Ok(x) } else { Err(Status::NotFinite.into()) }
}

/// Runs a call and reports the outcome to the caller.
///
/// # Safety
/// `error` is NULL or can be written to.
pub(crate) unsafe fn call(error: *mut Error, run: impl FnOnce() -> Result<(), Error>) -> Status {
    let Ok(error) = Given::optional(error, 0) else { return Status::Misaligned };
    let found = run().err().unwrap_or(Error::NONE);
    if let Some(error) = error {
        // SAFETY: this function's promise.
        unsafe { error.write(found) };
    }
    found.status
}
