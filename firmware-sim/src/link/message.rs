use super::frame::{Broken, Frame};
use super::refusal::Refusal;
use crate::control::Target;
use crate::firmware::Outcome;
use crate::program::Program;
use crate::wire::array;
use serde::{Deserialize, Serialize};

/// Version of the messages: the first byte of every document.
pub const VERSION: u8 = 9;

/// Request from the world to a processor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Request<const N: usize> {
    /// Loads the model in the processor's flash and runs a program from the beginning.
    Begin(Program<N>),
    /// Runs a tick.
    Tick(Samples<N>),
    /// Ends the program.
    End,
    /// Runs a tick of a log.
    Log(LoggedSamples<N>),
    /// Begins like [`Request::Begin`], and lets numbers of the model follow the machine, by the settings in the processor's flash.
    Adapt(Program<N>),
    /// Gives a part of the [patch](leastaction_core::adapt::Patch) with the numbers in use.
    Save {
        /// The part, from 0.
        part: u8,
    },
}

/// Input of the firmware at the beginning of a tick of a log.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoggedSamples<const N: usize> {
    /// Number of the request, repeated in its answer.
    pub sequence: u32,
    /// Number of ticks since the previous tick of the log.
    pub elapsed: u32,
    /// Encoder readings, rad or m; `None` for a missing one.
    #[serde(with = "array")]
    pub measured: [Option<f32>; N],
    /// Command that was given.
    #[serde(with = "array")]
    pub command: [f32; N],
}

/// Input of the firmware at the beginning of a tick.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Samples<const N: usize> {
    /// Number of the request, repeated in its answer.
    pub sequence: u32,
    /// Number of ticks since the last one that was run.
    pub elapsed: u32,
    /// Encoder readings, rad or m; `None` for a dropped one.
    #[serde(with = "array")]
    pub measured: [Option<f32>; N],
    /// Target of the command of this tick.
    pub target: Target<N>,
}

/// Answer of a processor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Answer<'a, const N: usize> {
    /// The program can run.
    Ready {
        /// Name of the processor.
        processor: &'a str,
    },
    /// A tick was run.
    Done(Done<N>),
    /// The request was refused.
    Refused(Refusal),
    /// A part of a patch.
    Saved {
        /// Number of parts.
        parts: u8,
        /// Bytes of this one.
        bytes: &'a [u8],
    },
}

/// Largest number of bytes of a part of a patch.
pub const PART: usize = 128;

/// Result of a tick that was run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Done<const N: usize> {
    /// Number of the request.
    pub sequence: u32,
    /// Outcome of the firmware.
    pub outcome: Outcome<N>,
    /// Number of instructions that the tick took; 0 if they are not counted.
    pub instructions: u32,
}

/// Creates the frame of a request.
pub fn request<const N: usize>(request: &Request<N>) -> Result<Frame, Broken> {
    Frame::of(&(VERSION, N as u8, request))
}

/// Reads the request in a frame.
///
/// # Errors
/// The reason why the frame holds no request of this version in N coordinates.
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

/// Creates the frame of an answer.
pub fn answer<const N: usize>(answer: &Answer<'_, N>) -> Result<Frame, Broken> {
    Frame::of(&(VERSION, answer))
}

/// Reads the answer in a frame.
///
/// # Errors
/// [`Broken`] if the frame holds no answer of this version in N coordinates.
pub fn parse_answer<const N: usize>(frame: &Frame) -> Result<Answer<'_, N>, Broken> {
    match frame.message()? {
        (VERSION, answer) => Ok(answer),
        _ => Err(Broken),
    }
}
