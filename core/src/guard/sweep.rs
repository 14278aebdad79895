use crate::checksum::Checksum;
use crate::model::{CRC_BYTES, ModelError, checksum};

/// Length of a word, bytes.
const WORD: usize = 4;

/// Comparison of a file with the checksum at its end, a slice at a time, round after round. The file is a model's or a plan's.
///
/// A flipped bit is found when the second round that it lies in ends, at the latest, because the first may have passed it already: with
/// rounds of n calls, after at most 2n calls. CRC-32 finds every flip of up to 32 neighbouring bits.
///
/// ```
/// use leastaction_core::guard::Sweep;
/// # use leastaction_core::model::{ModelError, checksum};
/// # fn run(file: &[u8]) -> Result<(), ModelError> {
/// // Rounds of six ticks.
/// let (mut sweep, bytes) = (Sweep::new(), Sweep::slice(file.len(), 6));
/// for tick in 1..=12 {
///     let round_ends = sweep.advance(file, bytes)?;
///     assert_eq!(round_ends, tick % 6 == 0);
/// }
/// # Ok(())
/// # }
/// # let body = [7_u8; 96];
/// # run(&[&body[..], &checksum(&body).to_le_bytes()].concat())?;
/// # Ok::<(), ModelError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Sweep {
    sum: Checksum,
    /// Number of bytes that the round has passed.
    at: usize,
}

impl Sweep {
    /// Creates a sweep before its first round.
    pub const fn new() -> Self {
        Self { sum: Checksum::new(), at: 0 }
    }

    /// Bytes of a call with which a round over a file of `length` bytes takes at most `calls` calls; a multiple of 4.
    pub const fn slice(length: usize, calls: usize) -> usize {
        let calls = if calls == 0 { 1 } else { calls };
        length.saturating_sub(CRC_BYTES).div_ceil(calls).next_multiple_of(WORD)
    }

    /// Sweeps over the next `bytes` bytes; `true` at the end of a round. 4 bytes at least are swept, so that every round ends.
    ///
    /// If a round ends with another checksum, that of the whole file is computed at once: the sweep's own numbers may have been damaged, and
    /// start anew in any case.
    ///
    /// # Errors
    /// [`ModelError::Checksum`] for a damaged file, and [`ModelError::TooShort`] for one that has no checksum.
    pub fn advance(&mut self, file: &[u8], bytes: usize) -> Result<bool, ModelError> {
        let short = ModelError::TooShort { bytes: file.len() };
        let (body, stored) = file.split_last_chunk::<CRC_BYTES>().ok_or(short)?;
        let rest = body.get(self.at..).unwrap_or_default();
        let slice = rest.get(..bytes.max(WORD)).unwrap_or(rest);
        self.sum = self.sum.over(slice);
        self.at = self.at.saturating_add(slice.len());
        if slice.len() < rest.len() {
            return Ok(false);
        }
        let swept = core::mem::take(self).sum.value();
        let stored = u32::from_le_bytes(*stored);
        if swept == stored {
            return Ok(true);
        }
        let computed = checksum(body);
        if computed == stored { Ok(true) } else { Err(ModelError::Checksum { stored, computed }) }
    }
}

impl Default for Sweep {
    fn default() -> Self {
        Self::new()
    }
}
