//! Contents of the caller's storage, and tags that show whether there are any.

use crate::family::{Lists, Mechanism};
use crate::motion::CoreState;
use crate::storage::{Model, State};

/// Contents of a [`Model`].
#[repr(C)]
pub(crate) struct Loaded {
    pub tag: usize,
    /// Lists that the mechanism refers to, in addition to the file.
    pub lists: Lists,
    pub mechanism: Mechanism,
}

/// Contents of a [`State`].
#[derive(Clone, Copy)]
#[repr(C)]
pub(crate) struct Started {
    pub tag: u32,
    pub state: CoreState,
}

/// Tag of a storage that holds a state.
pub(crate) const STARTED: u32 = 0x5354_4154;

/// Tag of a storage at this address that holds a model; a copy at another address has the wrong tag.
pub(crate) fn loaded_tag(storage: *const Loaded) -> usize {
    storage.addr() ^ 0x4d4f_4445
}

const _: () = assert!(size_of::<Loaded>() <= size_of::<Model>(), "LEASTACTION_MODEL_WORDS is too small");
const _: () = assert!(align_of::<Loaded>() <= align_of::<Model>());
const _: () = assert!(size_of::<Started>() == size_of::<State>());
const _: () = assert!(align_of::<Started>() <= align_of::<State>());
