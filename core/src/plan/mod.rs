//! The file of a plan: a motion with its commands and feedback gains, computed on a desk and followed by a controller.
//!
//! A plan holds K + 1 records (q̄, v̄, ū, gain K), one at the start of each of its K *nodes* of m ticks, and one at the goal. Between records
//! lies a cubic motion, a held command and a linear gain: [`Plan::reference`]. The law that follows the plan is
//!
//! u = ū − K (x − x̄), x = (q, v),
//!
//! with differences of angles the short way, and limited: [`Plan::command`]. A plan is made for one model, whose
//! [fingerprint](crate::model::fingerprint) it holds.
//!
//! The byte table is in `core/FORMAT.md`. [`Plan::load`] validates everything once, borrows the numbers in place, and refuses other sizes than
//! the compiled ones; on the host, [`PlanFile::parse`] reads a plan of any size, and [`write`](fn@write) writes one.
//!
//! ```
//! use leastaction_core::plan::{self, Plan, PlanHeader};
//!
//! // A carriage that moves by 1 m in two nodes of half a second, held to its motion by 2 N/m and 1 N s/m.
//! let header = PlanHeader {
//!     model: 0x1234_5678,
//!     driven: &[0],
//!     angles: &[0],
//!     h: 0.1,
//!     ticks_per_node: 5,
//!     nodes: 2,
//!     limits: &[[-3.0, 3.0]],
//! };
//! // q, v, u and the two gains of every record.
//! let records = [[0.0, 1.0, 0.5, 2.0, 1.0], [0.5, 1.0, -0.5, 2.0, 1.0], [1.0, 1.0, 0.0, 2.0, 1.0]];
//! // Words, because the file must begin at a multiple of 4.
//! let mut memory = [0_u32; 32];
//! let file = plan::write(&header, records.as_flattened(), bytemuck::cast_slice_mut(&mut memory))?;
//!
//! let plan = Plan::<1, 1>::load(file, 0x1234_5678)?;
//! assert_eq!((plan.ticks(), plan.seconds()), (10, 1.0));
//! // On the motion the command is the planned one; 0.5 m behind it, the feedback adds 1 N.
//! assert_eq!(plan.command(5, &[0.5], &[1.0])?, [-0.5]);
//! assert_eq!(plan.command(5, &[0.0], &[1.0])?, [0.5]);
//! assert!(Plan::<1, 1>::load(file, 1).is_err(), "made for another model");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod catalogue;
mod error;
mod file;
mod follow;
mod header;
mod reference;
mod write;

pub use catalogue::CATALOGUE;
pub use error::{CommandError, PlanError};
pub use file::{PlanFile, Record};
pub use follow::Plan;
pub use header::{MAX_COORDINATES, PlanHeader};
pub use reference::{Gain, Reference};
pub use write::write;

/// The first four bytes of every plan.
pub const MAGIC: [u8; 4] = *b"LAPN";
/// Format version that this build reads and writes.
pub const FORMAT_VERSION: u8 = 1;
