//! Contents of the caller's storage, and tags that show whether there are any.

use crate::config::LEASTACTION_COORDINATES as N;
use crate::family::{Lists, Mechanism};
use crate::motion::CoreState;
use crate::storage::{self, Model, State};
use leastaction_core::plan::Plan;

/// Contents of a [`Model`].
#[repr(C)]
pub(crate) struct Loaded {
    pub tag: usize,
    /// Fingerprint of the file, by which a plan knows the model.
    pub fingerprint: u32,
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

/// Plan in the form of core, in which any coordinate may be driven.
pub(crate) type CorePlan = Plan<'static, N, N>;

/// Contents of a [`storage::Plan`].
#[repr(C)]
pub(crate) struct Planned {
    pub tag: usize,
    pub plan: CorePlan,
}

/// Tag of a storage that holds a state.
pub(crate) const STARTED: u32 = 0x5354_4154;

/// Tag of a storage at this address that holds a model; a copy at another address has the wrong tag.
pub(crate) fn loaded_tag(storage: *const Loaded) -> usize {
    storage.addr() ^ 0x4d4f_4445
}

/// Tag of a storage at this address that holds a plan, as [`loaded_tag`] is that of a model.
pub(crate) fn planned_tag(storage: *const Planned) -> usize {
    storage.addr() ^ 0x504c_414e
}

const _: () = assert!(size_of::<Loaded>() <= size_of::<Model>(), "LEASTACTION_MODEL_WORDS is too small");
const _: () = assert!(align_of::<Loaded>() <= align_of::<Model>());
const _: () =
    assert!(size_of::<Planned>() <= size_of::<storage::Plan>(), "LEASTACTION_PLAN_WORDS is too small");
const _: () = assert!(align_of::<Planned>() <= align_of::<storage::Plan>());
const _: () = assert!(size_of::<Started>() == size_of::<State>());
const _: () = assert!(align_of::<Started>() <= align_of::<State>());
