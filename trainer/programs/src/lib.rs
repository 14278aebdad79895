//! Energies as straight-line programs over samples side by side, and their derivatives as programs of the same kind.
//!
//! A family of models writes down its Lagrangian L(q, v) once, with a [`Builder`], as a list of operations on vectors.
//! Derivatives are further operations in the same list: [`Builder::tangents`] differentiates forwards, along
//! directions, and [`Builder::pull_back`] differentiates backwards, with respect to inputs and weights. Each can be
//! applied to the results of the other, so that Hessians, equations of motion and their gradients with respect to the
//! weights need no additional code for a family. A [`Program`] is the list without the operations that no result needs,
//! and runs on [`WIDTH`] samples at a time.
//!
//! The numbers of coordinates, layers, units and directions are run-time values. Nothing is compiled for a particular
//! size.
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
pub use row::{Part, Row, WIDTH};
pub use sparsity::Pattern;
pub use system::{Separable, System};
