//! Processors at the other end of a byte link, which run the firmware's part of every tick: [`Remote`] over a [`Line`],
//! such as an emulated board ([`Emulator`]).
//!
//! [`leastaction_firmware_sim::link`] documents the protocol on the line.

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

/// The simulator's end of a byte link.
pub trait Line {
    /// Sends bytes.
    ///
    /// # Errors
    /// [`LinkError`] if the link is closed.
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError>;
    /// Returns a byte that has arrived, or arrives before the deadline; `None` if none does.
    ///
    /// # Errors
    /// [`LinkError`] if the link is closed, or if the run is to stop.
    fn receive(&mut self, deadline: Instant) -> Result<Option<u8>, LinkError>;
}

/// The reason why a processor did not run a tick.
#[derive(Debug, Error)]
pub enum LinkError {
    /// There was no answer in time.
    #[error("the processor does not answer: no whole frame within {} s", .0.as_secs_f32())]
    Timeout(Duration),
    /// The other end has closed the link.
    #[error("the link is closed: {0}")]
    Closed(String),
    /// An answer was damaged.
    #[error("a frame of the processor was damaged, or is of another version of the link")]
    Broken,
    /// An answer belongs to another request.
    #[error("the processor answers something else than it was asked")]
    OutOfStep,
    /// The processor refused the request.
    #[error("the processor refuses: {0}")]
    Refused(Refusal),
    /// An outcome does not have the bits of this machine.
    #[error(
        "its outcome does not have the bits of this machine: the image is of another version, or its memory is damaged"
    )]
    Differs,
    /// The run was interrupted.
    #[error("interrupted")]
    Interrupted,
    /// The operating system reported an error.
    #[error("the link cannot be used: {0}")]
    Io(#[from] io::Error),
}
