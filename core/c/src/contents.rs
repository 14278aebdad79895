//! What lies in the caller's storage, and how it is known whether anything does.

use crate::config::LEASTACTION_COORDINATES;
use crate::family::{EDGES, Mechanism};
use crate::storage::{Model, State};
use leastaction_core::discrete;
use leastaction_core::energy::graph::Edge;

/// What a [`Model`] holds.
#[repr(C)]
pub(crate) struct Loaded {
    pub tag: usize,
    /// What the mechanism's list of edges refers to.
    pub edges: [Edge; EDGES],
    pub mechanism: Mechanism,
}

/// What a [`State`] holds.
#[derive(Clone, Copy)]
#[repr(C)]
pub(crate) struct Started {
    pub tag: u32,
    pub state: CoreState,
}

/// A state as core knows it.
pub(crate) type CoreState = discrete::State<f32, LEASTACTION_COORDINATES>;

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
