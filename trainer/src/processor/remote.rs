use super::{Line, LinkError};
use leastaction_firmware_sim::control::Target;
use leastaction_firmware_sim::link::{
    Answer, Done, Frame, LoggedSamples, Receiver, Request, Samples, parse_answer, request,
};
use leastaction_firmware_sim::{Outcome, Processor, Program};
use std::convert::Infallible;
use std::time::{Duration, Instant};

/// A processor at the other end of a line, running a program.
#[derive(Debug)]
pub struct Remote<L, const N: usize> {
    messenger: Messenger<L>,
    name: String,
    last: Outcome<N>,
    sequence: u32,
    instructions: Vec<u32>,
}

impl<L: Line, const N: usize> Remote<L, N> {
    /// Begins a program on the processor, which must answer every request within `patience`.
    ///
    /// # Errors
    /// [`LinkError`] if it does not answer, or refuses the program or its model.
    pub fn begin(line: L, program: &Program<N>, patience: Duration) -> Result<Self, LinkError> {
        Self::start(line, &Request::Begin(*program), patience)
    }

    /// Begins a program like [`Remote::begin`]; numbers of its model follow by the settings in the processor's flash.
    ///
    /// # Errors
    /// [`LinkError`] if it does not answer, or refuses the program, its model or its settings.
    pub fn adapt(line: L, program: &Program<N>, patience: Duration) -> Result<Self, LinkError> {
        Self::start(line, &Request::Adapt(*program), patience)
    }

    fn start(line: L, beginning: &Request<N>, patience: Duration) -> Result<Self, LinkError> {
        let mut messenger = Messenger { line, receiver: Receiver::default(), patience };
        let frame = messenger.ask(beginning)?;
        let name = match answer::<N>(&frame)? {
            Answer::Ready { processor } => processor.to_owned(),
            _ => return Err(LinkError::OutOfStep),
        };
        let (last, instructions) = (Outcome::waiting(), Vec::new());
        Ok(Self { messenger, name, last, sequence: 0, instructions })
    }

    /// The name that the processor reports.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Instructions of every tick that it ran; zeros if it does not count them.
    pub fn instructions(&self) -> &[u32] {
        &self.instructions
    }

    /// Requests a tick with the current sequence number.
    fn outcome(&mut self, request: &Request<N>) -> Result<Outcome<N>, LinkError> {
        let frame = self.messenger.ask(request)?;
        match answer::<N>(&frame)? {
            Answer::Done(Done { sequence, outcome, instructions }) if sequence == self.sequence => {
                self.instructions.push(instructions);
                self.last = outcome;
                Ok(outcome)
            }
            _ => Err(LinkError::OutOfStep),
        }
    }

    /// Asks for the [patch](leastaction_core::adapt::Patch) with the numbers in use, part by part.
    ///
    /// # Errors
    /// [`LinkError`] if the processor does not answer, or no numbers follow there.
    pub fn saved(&mut self) -> Result<Vec<u8>, LinkError> {
        let (mut patch, mut part) = (Vec::new(), 0);
        loop {
            let frame = self.messenger.ask::<N>(&Request::Save { part })?;
            let Answer::Saved { parts, bytes } = answer::<N>(&frame)? else {
                return Err(LinkError::OutOfStep);
            };
            patch.extend(bytes);
            part += 1;
            if part >= parts {
                return Ok(patch);
            }
        }
    }

    /// Tells the processor that the program has ended, and returns the line.
    ///
    /// # Errors
    /// [`LinkError`] if the processor cannot be told.
    pub fn end(mut self) -> Result<L, LinkError> {
        self.messenger.send::<N>(&Request::End)?;
        Ok(self.messenger.line)
    }
}

impl<L: Line, const N: usize> Processor<N> for &mut Remote<L, N> {
    type Error = LinkError;

    fn run(
        &mut self,
        elapsed: u32,
        measured: &[Option<f32>; N],
        target: &Target<N>,
    ) -> Result<Outcome<N>, LinkError> {
        self.sequence = self.sequence.wrapping_add(1);
        let samples = Samples { sequence: self.sequence, elapsed, measured: *measured, target: *target };
        self.outcome(&Request::Tick(samples))
    }

    fn replay(
        &mut self,
        elapsed: u32,
        measured: &[Option<f32>; N],
        u: [f32; N],
    ) -> Result<Outcome<N>, LinkError> {
        self.sequence = self.sequence.wrapping_add(1);
        let samples = LoggedSamples { sequence: self.sequence, elapsed, measured: *measured, command: u };
        self.outcome(&Request::Log(samples))
    }

    fn last(&self) -> &Outcome<N> {
        &self.last
    }
}

/// The answer in a frame; a refusal is an error.
fn answer<const N: usize>(frame: &Frame) -> Result<Answer<'_, N>, LinkError> {
    match parse_answer(frame).map_err(|_| LinkError::Broken)? {
        Answer::Refused(refusal) => Err(LinkError::Refused(refusal)),
        answer => Ok(answer),
    }
}

/// A line that carries frames.
#[derive(Debug)]
struct Messenger<L> {
    line: L,
    receiver: Receiver,
    patience: Duration,
}

impl<L: Line> Messenger<L> {
    fn ask<const N: usize>(&mut self, request: &Request<N>) -> Result<Frame, LinkError> {
        self.send(request)?;
        self.receive()
    }

    fn send<const N: usize>(&mut self, message: &Request<N>) -> Result<(), LinkError> {
        let frame = request(message).map_err(|_| LinkError::Broken)?;
        let mut bytes = Vec::new();
        let Ok(()) = frame.send(|byte| {
            bytes.push(byte);
            Ok::<(), Infallible>(())
        });
        self.line.send(&bytes)
    }

    fn receive(&mut self) -> Result<Frame, LinkError> {
        let deadline = Instant::now() + self.patience;
        while let Some(byte) = self.line.receive(deadline)? {
            if let Some(frame) = self.receiver.push(byte) {
                return frame.map_err(|_| LinkError::Broken);
            }
        }
        Err(LinkError::Timeout(self.patience))
    }
}
