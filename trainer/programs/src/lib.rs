//! Energies as straight-line programs over samples side by side, and their derivatives as programs of the same kind.
//!
//! A family of models writes down its Lagrangian L(q, v) once, with a [`Builder`]: a list of operations on vectors. Derivatives are further
//! operations on the same list: [`Builder::tangents`] differentiates forwards, along directions, and [`Builder::pull_back`] backwards, to
//! inputs and weights. Each can be applied to the results of the other, so that Hessians, equations of motion and their gradients in the
//! weights need no code of the family. A [`Program`] is the list without the operations that no result needs, and runs on [`WIDTH`] samples
//! at a time.
//!
//! Sizes are run-time values: of coordinates, layers, units, directions. Nothing is compiled for any of them.
//!
//! Data flows one way: [`Builder`] (list, and its derivatives) → [`Program`] (schedule) → [`Workspace`] (numbers).

mod builder;
mod derivative_outputs;
pub mod dynamics;
pub mod energies;
mod forward;
mod function;
mod kernels;
mod layout;
pub mod losses;
mod numbers;
mod operation;
mod picks;
mod program;
mod reverse;
mod row;
mod schedule;
mod single;
mod sources;
mod sparsity;
mod step;
pub mod steps;
mod system;

pub use builder::Builder;
pub use derivative_outputs::DerivativeOutputs;
pub use function::Function;
pub use operation::{Layer, Node};
pub use program::{Program, Workspace};
pub use reverse::{Adjoints, WeightTerm};
pub use row::{Row, WIDTH};
pub use sparsity::Pattern;
pub use system::{Separable, System};
