//! Arms on the host: trees of rigid bodies on revolute and prismatic joints, of any size, in f64.
//!
//! [`urdf`] reads a [`Tree`]; [`Tree::inverse_dynamics`] and its relatives evaluate it; [`Samples`] are a log, resampled, filtered and
//! differentiated; [`linear`] fits the numbers that a log determines, [`fit`] finds bodies that are physically consistent, rotors and
//! friction near a prior, and says what samples show alone; [`excitation`] finds motions that show much.
//!
//! Conventions. Body i has one joint to its parent, a body before it, or to the base. The joint's frame stands on the parent's frame
//! at a constant pose, parent_x = R x + p at q = 0; the axis is a unit vector in the joint's frame, and the body's frame is the joint's
//! frame moved by q. SI units; gravity is a vector in the base frame, normally (0, 0, −9.81) m/s².

mod dynamics;
pub mod excitation;
pub mod fit;
mod inertia;
pub mod linear;
mod samples;
mod signal;
mod tree;
pub mod urdf;

pub use inertia::{INERTIAL, Inertia, LogCholesky};
pub use samples::{Preparation, SampleError, Samples};
pub use signal::Butterworth;
pub use tree::{Body, Joint, Limits, Pose, Tree, TreeError};
