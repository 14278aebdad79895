//! A deterministic fixed-step control loop around a learned Lagrangian, in f32, as it runs on a microcontroller.
//!
//! The loop has two halves that meet only in encoder readings and force commands:
//!
//! - the **world**: a [`plant::Plant`] stepped finely, and the [`devices`]: quantised, noisy, dropping encoders; a saturating actuator at
//!   the end of a delay line; a clock whose ticks come late or not at all. Each draws from a random stream of its own, so changing one does
//!   not affect the others.
//! - the **firmware**: an [`observer`] that steps the model by the discrete Euler–Lagrange equation and corrects it by
//!   the encoders, and a [`control`]ler that knows nothing but the model.
//!
//! A [`scenario`] joins the halves, runs them for a number of ticks, hands every [`Tick`] to a sink and returns a [`Summary`] whose hash is
//! a fingerprint of the whole trace. There is no allocation and no panic; if the model cannot be stepped, the firmware holds its last good
//! state, commands no force, and counts the error.
//!
//! Positions are in m or rad, velocities in m/s or rad/s, forces in N or N m, times in s. A coordinate whose actuator
//! limit is 0 is not actuated.
//!
//! ```
//! use leastaction_core::energy::trigonometric::CARTPOLE;
//! use leastaction_core::forces::System;
//! use leastaction_firmware_sim::scenario::{SwingUpConfig, swing_up_cartpole};
//!
//! let plant = System::conservative(CARTPOLE);
//! let mut config = SwingUpConfig::cartpole();
//! config.setup.seed = 7;
//! // The exact system stands in for a learned model here.
//! let summary = swing_up_cartpole(&plant, &plant, &config, |tick| assert!(tick.q[0].abs() < 2.4))?;
//! assert!(summary.success);
//! # Ok::<(), leastaction_firmware_sim::SetupError>(())
//! ```
#![no_std]

mod adapting;
mod angle;
pub mod control;
pub mod damage;
pub mod devices;
mod error;
mod firmware;
mod guarded;
pub mod link;
mod mechanism;
pub mod observer;
pub mod plant;
mod processor;
mod program;
pub mod scenario;
mod summary;
mod tick;
mod timeline;
pub mod trajectory;
mod wire;

pub use adapting::Adapting;
pub use angle::{wrap, wrap_where};
pub use error::{Range, SetupError};
pub use firmware::{Firmware, Outcome};
pub use guarded::{Input, Swept, Voting};
pub use mechanism::{InUse, Mechanism, Trained, require_quadratic};
pub use processor::{InPlace, Processor};
pub use program::{Program, Task};
pub use summary::{Goal, Incidents, Summary};
pub use tick::{Mode, Tick, TraceHash};
pub use timeline::Timeline;
