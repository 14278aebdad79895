//! Bytes of a frame: a postcard document, its CRC-32, and COBS around both, so a 0 ends a frame and occurs nowhere else.
//!
//! COBS is from Cheshire and Baker, "Consistent Overhead Byte Stuffing", SIGCOMM 1997. A frame is too short for a block of 254 bytes, so
//! every block ends where the original bytes have a 0.

use core::fmt;
use crc::{CRC_32_ISO_HDLC, Crc, NoTable};
use serde::Serialize;
use serde::de::Deserialize;

/// Maximum length of a document with its checksum, bytes; all messages of up to 7 coordinates are shorter.
pub const MAX_FRAME: usize = 256;

const CRC: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);
const CRC_BYTES: usize = 4;

/// The bytes received are not a whole frame with the expected message: a byte was lost, changed or added, or the frame is too long.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Broken;

impl fmt::Display for Broken {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a frame is damaged, too long, or holds another message")
    }
}

impl core::error::Error for Broken {}

/// A document and its checksum.
#[derive(Clone, Debug)]
pub struct Frame {
    bytes: [u8; MAX_FRAME],
    length: usize,
}

impl Frame {
    const fn empty() -> Self {
        Self { bytes: [0; MAX_FRAME], length: 0 }
    }

    /// Creates the frame of a message; [`Broken`] if it does not fit.
    pub fn of(message: &impl Serialize) -> Result<Self, Broken> {
        let mut frame = Self::empty();
        let length = postcard::to_slice(message, &mut frame.bytes).map_err(|_| Broken)?.len();
        let sum = CRC.checksum(frame.bytes.get(..length).ok_or(Broken)?);
        let workspace =
            frame.bytes.get_mut(length..).and_then(|rest| rest.first_chunk_mut()).ok_or(Broken)?;
        *workspace = sum.to_le_bytes();
        frame.length = length + CRC_BYTES;
        Ok(frame)
    }

    /// Hands over the bytes in their form on the link, up to the first error.
    pub fn send<E>(&self, mut to: impl FnMut(u8) -> Result<(), E>) -> Result<(), E> {
        debug_assert!(
            self.length <= MAX_FRAME,
            "frames are made by `of` and `push`, which keep to their bytes"
        );
        let bytes = self.bytes.get(..self.length).unwrap_or(&[]);
        for run in bytes.split(|byte| *byte == 0) {
            to(run.len() as u8 + 1)?;
            run.iter().try_for_each(|byte| to(*byte))?;
        }
        to(0)
    }

    /// The message of the frame; [`Broken`] if the checksum does not match, the message is of another kind, or bytes follow it.
    pub fn message<'a, T: Deserialize<'a>>(&'a self) -> Result<T, Broken> {
        match postcard::take_from_bytes(self.document()?) {
            Ok((message, [])) => Ok(message),
            _ => Err(Broken),
        }
    }

    /// The first part of a document, whatever follows it.
    pub(super) fn beginning<'a, T: Deserialize<'a>>(&'a self) -> Result<T, Broken> {
        postcard::take_from_bytes(self.document()?).map(|(message, _)| message).map_err(|_| Broken)
    }

    fn document(&self) -> Result<&[u8], Broken> {
        let bytes = self.bytes.get(..self.length).ok_or(Broken)?;
        let (document, sum) = bytes.split_last_chunk::<CRC_BYTES>().ok_or(Broken)?;
        if CRC.checksum(document) == u32::from_le_bytes(*sum) { Ok(document) } else { Err(Broken) }
    }

    fn push(&mut self, byte: u8) -> Result<(), Broken> {
        *self.bytes.get_mut(self.length).ok_or(Broken)? = byte;
        self.length += 1;
        Ok(())
    }
}

/// Assembles arriving bytes into frames.
#[derive(Clone, Debug)]
pub struct Receiver {
    frame: Frame,
    /// Bytes left to the end of a block; `None` before the first block.
    left: Option<u8>,
    broken: bool,
}

impl Default for Receiver {
    fn default() -> Self {
        Self { frame: Frame::empty(), left: None, broken: false }
    }
}

impl Receiver {
    /// Takes a byte, and returns the frame that it ends, if any. A broken frame does not affect the next.
    pub fn push(&mut self, byte: u8) -> Option<Result<Frame, Broken>> {
        if byte != 0 {
            self.broken |= self.take(byte).is_err();
            return None;
        }
        let Self { frame, left, broken } = core::mem::take(self);
        // Zeros between frames end nothing.
        (left.is_some() || broken).then(|| if broken || left != Some(0) { Err(Broken) } else { Ok(frame) })
    }

    fn take(&mut self, byte: u8) -> Result<(), Broken> {
        match self.left {
            Some(left @ 1..) => {
                self.left = Some(left - 1);
                return self.frame.push(byte);
            }
            Some(0) => self.frame.push(0)?,
            None => {}
        }
        self.left = Some(byte - 1);
        Ok(())
    }
}
