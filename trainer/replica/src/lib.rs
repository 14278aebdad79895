//! The chip's arithmetic on the host: a model file of any size, evaluated and stepped with equal bits.
//!
//! On the chip sizes are types; here a file determines them. `leastaction-core` itself is compiled for each number of coordinates that a
//! program can meet ([`COORDINATES`]), and for graphs of any size, behind an interface of slices: the bits have a single source, and
//! nothing has to be kept in step with it.
//!
//! ```text
//! bytes ─► ModelFile ─► Replica ─► Evaluator: T, V, v̇, inverse dynamics
//!                            ├► Motion: steps of the discrete Euler–Lagrange equation, RATTLE for graphs
//!                            ├► Watch: the state from encoders' readings
//!                            ├► Adaptation: numbers that follow the machine
//!                            ├► Actuators: commands to forces
//!                            └► Visitor: the system itself, its size being a type again
//! ```
//!
//! The solvers are compiled once per size, not once per size and family: they see a Lagrangian through [`AnyLagrangian`], whose methods are
//! called at run time. That changes no bit: neither the order of operations nor their rounding depends on how a function is called.

mod actuators;
mod adaptation;
mod any;
mod control;
mod coordinates;
mod error;
mod evaluator;
mod file;
mod forces;
mod motion;
mod particles;
mod replica;
mod sizes;
mod tuned;
mod watch;

pub use actuators::Actuators;
pub use adaptation::{Adaptation, AdapterOf, AdapterSettings, Findings, Instant, PAIRS, PLACES, TuningOf};
pub use any::{AnyLagrangian, INERTIA_NETWORK_UNITS, LAYERS, SystemOf, UNITS};
pub use control::{Control, Step};
pub use error::ReplicaError;
pub use evaluator::Evaluator;
pub use file::ModelFile;
pub use forces::{AllForces, ForcesOf, Friction, Networks, WithNetworks};
pub use motion::Motion;
pub use particles::ParticleSystem;
pub use replica::Replica;
pub use sizes::{COORDINATES, OfSize, StateVisitor, Visitor};
pub use tuned::TunedOf;
pub use watch::Watch;
