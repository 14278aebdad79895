//! Contents of the caller's storage, and tags that show whether there are any.

use crate::config::LEASTACTION_COORDINATES as N;
use crate::family::{Lists, Mechanism};
use crate::motion::CoreState;
use crate::storage::{self, Model, State};
#[cfg(feature = "adapt")]
pub(crate) use following::{Following, following_tag};
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

/// Contents of an adapter's storage.
#[cfg(feature = "adapt")]
mod following {
    use crate::config::{LEASTACTION_ADAPTER_WORDS, LEASTACTION_COORDINATES as N, LEASTACTION_NUMBERS as P};
    use crate::family::Tuned;
    use leastaction_core::adapt::{Adapter, Announcement, Blocks, Tuning};
    use leastaction_core::forces::Actuator;

    /// Entries above the diagonal of the covariance's factor.
    const T: usize = P * (P - 1) / 2;

    /// Contents of an [`Adapter`](crate::storage::Adapter) beside its model.
    #[repr(C)]
    pub(crate) struct Following {
        pub tag: usize,
        /// Number of numbers that follow.
        pub count: u8,
        /// Whether the numbers in use stay what they are.
        pub frozen: bool,
        pub tuned: Tuned,
        pub tuning: Tuning<f32, N, P>,
        pub announcement: Option<Announcement<f32>>,
        /// Gains and offsets of the drives.
        pub drive: Actuator<f32, N>,
        pub blocks: Blocks<f32, N>,
        pub adapter: Adapter<f32, N, P, T>,
    }

    /// Tag of a storage at this address in which an adapter has begun.
    pub(crate) fn following_tag(storage: *const Following) -> usize {
        storage.addr() ^ 0x4144_5054
    }

    type Words = [usize; LEASTACTION_ADAPTER_WORDS];
    const _: () =
        assert!(size_of::<Following>() <= size_of::<Words>(), "LEASTACTION_ADAPTER_WORDS is too small");
    const _: () = assert!(align_of::<Following>() <= align_of::<Words>());
}
