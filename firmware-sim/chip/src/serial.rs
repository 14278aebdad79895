//! The serial line as the port of a link.

use crate::board::Uart;
use crate::board::{INSTRUCTIONS_PER_TICK, ticks};
use leastaction_firmware_sim::link::Port;

/// Number of polls for a byte before giving up: some minutes under emulation. The other end may have died, and an
/// image that waits forever would keep a processor of the host busy forever.
const PATIENCE: u32 = u32::MAX;

/// Error that nothing was heard for minutes.
pub struct Silence;

/// The serial line.
pub struct Serial(Uart);

impl Serial {
    /// The line of the board, ready.
    #[allow(clippy::new_without_default, reason = "it is the board's only one")]
    pub fn new() -> Self {
        Self(Uart::start())
    }
}

impl Port for Serial {
    type Error = Silence;

    fn receive(&mut self) -> Result<u8, Silence> {
        for _ in 0..PATIENCE {
            if let Some(byte) = self.0.receive() {
                return Ok(byte);
            }
        }
        Err(Silence)
    }

    fn send(&mut self, byte: u8) -> Result<(), Silence> {
        while !self.0.send(byte) {}
        Ok(())
    }

    fn count<T>(&mut self, work: impl FnOnce() -> T) -> (u32, T) {
        let start = ticks(0);
        let outcome = work();
        (ticks(start) * INSTRUCTIONS_PER_TICK, outcome)
    }
}
