//! The storage that the caller gives, as C sees it.

use crate::config::{LEASTACTION_MODEL_WORDS, LEASTACTION_STATE_WORDS};

/// Storage of a loaded model, about which only this library knows more. It must start as zeros, as static storage does, and
/// must not be moved or copied once a model is loaded. It refers to the file: that must stay where it is, unchanged.
#[repr(C)]
pub struct Model {
    opaque: [usize; LEASTACTION_MODEL_WORDS],
}

/// Storage of a state: position and momentum, both summed with compensation, and what the next step begins with. It must
/// start as zeros, as static storage does. A started one may be copied by assignment, to come back to it.
#[repr(C)]
pub struct State {
    opaque: [u32; LEASTACTION_STATE_WORDS],
}
