//! A firmware whose model's numbers follow, here and perhaps on a board as well.

use leastaction::processor::{Emulator, LinkError, Remote};
use leastaction_adaptation::{Choice, Course};
use leastaction_core::adapt::Patch;
use leastaction_firmware_sim::control::{Controller, Target};
use leastaction_firmware_sim::scenario::Logged;
use leastaction_firmware_sim::{Adapting, Outcome, Processor};
use leastaction_replica::{PAIRS, PLACES, TunedOf};

/// A firmware with the record of what it finds. Beside a board it takes the same ticks, and must have the same outcome.
pub struct Recorded<'a, C, const N: usize> {
    firmware: Adapting<'a, TunedOf<'a, N>, C, N, PLACES, PAIRS>,
    board: Option<&'a mut Remote<Emulator, N>>,
    choice: &'a Choice,
    /// Findings so far.
    pub course: Course,
    /// Time of the last tick, s.
    time: f64,
    tick: f64,
}

impl<'a, C, const N: usize> Recorded<'a, C, N> {
    /// Creates the record of a firmware with ticks of `tick` seconds before its first one.
    pub fn new(
        firmware: Adapting<'a, TunedOf<'a, N>, C, N, PLACES, PAIRS>,
        board: Option<&'a mut Remote<Emulator, N>>,
        choice: &'a Choice,
        tick: f32,
    ) -> Self {
        let tick = f64::from(tick);
        Self { firmware, board, choice, course: Course::default(), time: -tick, tick }
    }

    /// The numbers in use, as a patch of the model with this fingerprint.
    pub fn patch(&self, model: u32) -> Patch<PLACES> {
        self.firmware.patch(model)
    }

    /// Compares the outcome with that of the board, and records what a window found.
    fn record(
        &mut self,
        elapsed: u32,
        outcome: Outcome<N>,
        on_board: impl FnOnce(&mut &mut Remote<Emulator, N>) -> Result<Outcome<N>, LinkError>,
    ) -> Result<Outcome<N>, LinkError> {
        if let Some(board) = &mut self.board
            && on_board(board)? != outcome
        {
            return Err(LinkError::Differs);
        }
        let ticks = if elapsed == Logged::<N>::FIRST { 1 } else { elapsed };
        self.time += f64::from(ticks) * self.tick;
        if let Some(agreement) = self.firmware.agreement() {
            self.course.record(self.choice, [self.time; 2], (self.firmware.adapter(), &agreement));
        }
        Ok(outcome)
    }
}

impl<C: Controller<N>, const N: usize> Processor<N> for &mut Recorded<'_, C, N> {
    type Error = LinkError;

    fn run(
        &mut self,
        elapsed: u32,
        measured: &[Option<f32>; N],
        target: &Target<N>,
    ) -> Result<Outcome<N>, LinkError> {
        let Ok(outcome) = self.firmware.run(elapsed, measured, target);
        self.record(elapsed, outcome, |board| board.run(elapsed, measured, target))
    }

    fn replay(
        &mut self,
        elapsed: u32,
        measured: &[Option<f32>; N],
        u: [f32; N],
    ) -> Result<Outcome<N>, LinkError> {
        let Ok(outcome) = self.firmware.replay(elapsed, measured, u);
        self.record(elapsed, outcome, |board| board.replay(elapsed, measured, u))
    }

    fn last(&self) -> &Outcome<N> {
        self.firmware.last()
    }
}
