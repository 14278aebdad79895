//! Functional mock-up units of models: FMI 3.0 and 2.0, co-simulation and model exchange.
//!
//! ```text
//! Description ─► archive: modelDescription.xml, binaries/…/leastaction_fmu.so, resources/m.postcard
//!                                                    │                              │
//! importer ◄─ fmi3DoStep, fmi2DoStep, … ─► ffi ─► Instance ─► leastaction-replica ◄─┘
//! ```
//!
//! One library serves every model: it reads the model file from the unit's resources and computes with core itself, in single precision and
//! with the chip's bits. A unit has no global state, so any number of instances may live in a process, each used by one thread at a time.
//!
//! - Co-simulation: steps of the discrete Euler–Lagrange equation of the model's own h, under a force that is held over a communication
//!   step, which must be a whole multiple of h.
//! - Model exchange: states (q, v), derivatives (v, v̇) with v̇ of core, with friction and all other laws of the model.
//!
//! There are no events. Forces are those at the actuator's output; gain, offset, delay and lag of the drives are not part of a unit.

mod archive;
mod description;
mod error;
#[allow(unsafe_code)]
mod ffi;
mod instance;
mod state;
mod unit;
mod variables;
mod xml;

pub use archive::{ArchiveError, archive};
pub use description::{Description, Version};
pub use error::FmuError;
pub use instance::Instance;
pub use state::{Interface, Phase, State};
pub use unit::Unit;
pub use variables::{Kind, Variable};

/// Identifier of the model in C, and name of the library in an archive.
pub const IDENTIFIER: &str = "leastaction_fmu";

/// Name of the model file in an archive's resources.
pub const RESOURCE: &str = "m.postcard";
