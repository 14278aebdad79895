//! The caller's storage as C sees it.

#[cfg(feature = "adapt")]
use crate::config::LEASTACTION_ADAPTER_WORDS;
use crate::config::{LEASTACTION_MODEL_WORDS, LEASTACTION_PLAN_WORDS, LEASTACTION_STATE_WORDS};

/// Storage of a loaded model, whose contents only this library knows. It must start as zeros, as static storage does, and must not be moved
/// or copied once a model is loaded. It refers to the file, which must stay in place, unchanged.
#[repr(C)]
pub struct Model {
    opaque: [usize; LEASTACTION_MODEL_WORDS],
}

/// Storage of a state: position and momentum, both summed with compensation, and the starting data of the next step. It must start as
/// zeros, as static storage does. A started state may be copied by assignment, to come back to it.
#[repr(C)]
pub struct State {
    opaque: [u32; LEASTACTION_STATE_WORDS],
}

/// Storage of a loaded plan, whose contents only this library knows. It must start as zeros, as static storage does, and must not be moved or
/// copied once a plan is loaded. It refers to the file of the plan, which must stay in place, unchanged.
#[repr(C)]
pub struct Plan {
    opaque: [usize; LEASTACTION_PLAN_WORDS],
}

/// Storage of an adapter, whose contents only this library knows, with the model whose numbers follow the machine. It must start as zeros, as
/// static storage does, and must not be moved or copied once an adapter has begun. It refers to the model's file, which must stay in place,
/// unchanged.
#[cfg(feature = "adapt")]
#[repr(C)]
pub struct Adapter {
    /// The model with the numbers in use, for every function that takes a model. leastaction_adapter_begin loads it, and nothing else may; ticks
    /// of the adapter change its numbers.
    pub model: Model,
    pub(crate) opaque: [usize; LEASTACTION_ADAPTER_WORDS],
}
