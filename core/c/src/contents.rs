//! What lies in the caller's storage, and how it is known whether anything does.

use crate::family::{Lists, Mechanism};
use crate::motion::CoreState;
use crate::storage::{Model, State};

/// What a [`Model`] holds.
#[repr(C)]
pub(crate) struct Loaded {
    pub tag: usize,
    /// What the mechanism refers to beside the file.
    pub lists: Lists,
    pub mechanism: Mechanism,
}

/// What a [`State`] holds.
#[derive(Clone, Copy)]
#[repr(C)]
pub(crate) struct Started {
    pub tag: u32,
    pub state: CoreState,
}

/// Says that storage holds a state.
pub(crate) const STARTED: u32 = 0x5354_4154;

/// Says that storage at this address holds a model: a copy elsewhere does not.
pub(crate) fn loaded_tag(storage: *const Loaded) -> usize {
    storage.addr() ^ 0x4d4f_4445
}

const _: () = assert!(size_of::<Loaded>() <= size_of::<Model>(), "LEASTACTION_MODEL_WORDS is too small");
const _: () = assert!(align_of::<Loaded>() <= align_of::<Model>());
const _: () = assert!(size_of::<Started>() == size_of::<State>());
const _: () = assert!(align_of::<Started>() <= align_of::<State>());
