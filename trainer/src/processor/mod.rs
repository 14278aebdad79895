//! Processors at the other end of a byte link, which run the firmware's part of every tick: [`Remote`] over a [`Line`],
//! such as an emulated board ([`Emulator`]).
//!
//! What goes over the line is told by [`leastaction_firmware_sim::link`].

mod board;
mod emulator;
mod remote;

pub use board::{Board, BoardError};
pub use emulator::{Emulator, StartError};
pub use remote::Remote;

use leastaction_firmware_sim::link::Refusal;
use std::io;
use std::time::{Duration, Instant};
use thiserror::Error;

/// The world's end of a byte link.
pub trait Line {
    /// Sends bytes.
    ///
    /// # Errors
    /// Where the link is closed.
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError>;
    /// A byte that arrived, or arrives before the deadline; `None` where none does.
    ///
    /// # Errors
    /// Where the link is closed, or the run is to stop.
    fn receive(&mut self, deadline: Instant) -> Result<Option<u8>, LinkError>;
}

/// Why a processor did not run a tick.
#[derive(Debug, Error)]
pub enum LinkError {
    /// No answer.
    #[error("the processor does not answer: no whole frame within {} s", .0.as_secs_f32())]
    Timeout(Duration),
    /// The other end is gone.
    #[error("the link is closed: {0}")]
    Closed(String),
    /// An answer was damaged.
    #[error("a frame of the processor was damaged, or is of another version of the link")]
    Broken,
    /// An answer to something else.
    #[error("the processor answers something else than it was asked")]
    OutOfStep,
    /// The processor refuses.
    #[error("the processor refuses: {0}")]
    Refused(Refusal),
    /// The run is to stop.
    #[error("interrupted")]
    Interrupted,
    /// The operating system refuses.
    #[error("the link cannot be used: {0}")]
    Io(#[from] io::Error),
}
