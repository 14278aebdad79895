use super::frame::{Broken, Frame};
use super::refusal::Refusal;
use crate::control::Target;
use crate::firmware::Outcome;
use crate::program::Program;
use crate::wire::array;
use serde::{Deserialize, Serialize};

/// Version of the messages: the first byte of every document.
pub const VERSION: u8 = 6;

/// What the world asks of a processor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Request<const N: usize> {
    /// To load the model in its flash and run a program from the beginning.
    Begin(Program<N>),
    /// To run a tick.
    Tick(Samples<N>),
    /// To end.
    End,
    /// To run a tick of a log.
    Log(LoggedSamples<N>),
}

/// What the firmware is told at the beginning of a tick of a log.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoggedSamples<const N: usize> {
    /// The number of the request; its answer has the same.
    pub sequence: u32,
    /// Ticks since the one before.
    pub elapsed: u32,
    /// Encoder readings, rad or m; `None` where missing.
    #[serde(with = "array")]
    pub measured: [Option<f32>; N],
    /// The command that was given.
    #[serde(with = "array")]
    pub command: [f32; N],
}

/// What the firmware is told at the beginning of a tick.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Samples<const N: usize> {
    /// The number of the request; its answer has the same.
    pub sequence: u32,
    /// Ticks since the last one that was run.
    pub elapsed: u32,
    /// Encoder readings, rad or m; `None` where dropped.
    #[serde(with = "array")]
    pub measured: [Option<f32>; N],
    /// What the command of this tick is for.
    pub target: Target<N>,
}

/// What a processor answers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Answer<'a, const N: usize> {
    /// The program can run.
    Ready {
        /// The processor's own name.
        processor: &'a str,
    },
    /// A tick was run.
    Done(Done<N>),
    /// The request is refused.
    Refused(Refusal),
}

/// A tick that was run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Done<const N: usize> {
    /// The number of the request.
    pub sequence: u32,
    /// What the firmware made of it.
    pub outcome: Outcome<N>,
    /// Instructions that it took; 0 where nobody counts.
    pub instructions: u32,
}

/// The frame of a request.
pub fn request<const N: usize>(request: &Request<N>) -> Result<Frame, Broken> {
    Frame::of(&(VERSION, N as u8, request))
}

/// The request in a frame.
///
/// # Errors
/// Where the frame holds no request of this version in N coordinates: why.
pub fn parse_request<const N: usize>(frame: &Frame) -> Result<Request<N>, Refusal> {
    let (version, coordinates): (u8, u8) = frame.beginning().map_err(|_| Refusal::Frame)?;
    if version != VERSION {
        return Err(Refusal::Version { supported: VERSION });
    }
    if usize::from(coordinates) != N {
        return Err(Refusal::Coordinates { supported: N as u8 });
    }
    frame.message::<(u8, u8, _)>().map(|(_, _, request)| request).map_err(|_| Refusal::Frame)
}

/// The frame of an answer.
pub fn answer<const N: usize>(answer: &Answer<'_, N>) -> Result<Frame, Broken> {
    Frame::of(&(VERSION, answer))
}

/// The answer in a frame.
///
/// # Errors
/// Where the frame holds no answer of this version in N coordinates.
pub fn parse_answer<const N: usize>(frame: &Frame) -> Result<Answer<'_, N>, Broken> {
    match frame.message()? {
        (VERSION, answer) => Ok(answer),
        _ => Err(Broken),
    }
}
