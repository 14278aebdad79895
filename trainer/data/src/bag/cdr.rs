//! Parser of `sensor_msgs/JointState` in CDR, as ROS 2 sends it: XCDR version 1, either byte order.

use crate::bag_problem::BagProblem;
use crate::problem::Problem;
use std::collections::BTreeSet;

/// Bytes before the first field, which hold the kind of encoding and options.
const HEADER: usize = 4;

/// First bytes of what zstd compressed; no message in CDR begins with them.
const ZSTD: [u8; 4] = 0xFD2F_B528_u32.to_le_bytes();

/// Number of bytes after the last field that is too large for padding.
const PADDING: usize = 8;

/// A message; empty lists carry no data.
pub(super) struct JointState<'a> {
    /// Stamp, ns; 0 if the sender did not set it.
    pub stamp: i64,
    pub names: Vec<&'a str>,
    /// Positions, velocities, efforts.
    pub fields: [Vec<f64>; 3],
}

impl<'a> JointState<'a> {
    /// Parses a message.
    pub fn parse(message: &'a [u8]) -> Result<Self, Problem> {
        if message.starts_with(&ZSTD) {
            return Err(BagProblem::PackedMessage.into());
        }
        let mut cdr = Cdr::new(message)?;
        let (seconds, nanoseconds) = (cdr.word()? as i32, cdr.word()?);
        cdr.text()?;
        let names = cdr.texts()?;
        let fields = [cdr.reals()?, cdr.reals()?, cdr.reals()?];
        if cdr.rest().len() >= PADDING {
            return Err(no("it goes on after its end"));
        }
        let stamp = i64::from(seconds) * 1_000_000_000 + i64::from(nanoseconds);
        Ok(Self { stamp, names, fields })
    }

    /// Checks that every non-empty list has an entry for every joint, and that no joint comes twice.
    pub fn check(&self) -> Result<(), Problem> {
        if self.fields.iter().any(|field| !field.is_empty() && field.len() != self.names.len()) {
            return Err(no("it has other numbers of names and of values"));
        }
        let mut seen = BTreeSet::new();
        match self.names.iter().find(|name| !seen.insert(**name)) {
            Some(twice) => Err(Problem::Duplicate(format!("joint {twice}"))),
            None => Ok(()),
        }
    }
}

fn no(reason: &'static str) -> Problem {
    BagProblem::NotJointState(reason).into()
}

/// The unread part of a message. Fields are aligned to their size, counted from the end of the header.
struct Cdr<'a> {
    body: &'a [u8],
    at: usize,
    big_endian: bool,
}

impl<'a> Cdr<'a> {
    fn new(message: &'a [u8]) -> Result<Self, Problem> {
        let big_endian = match *message {
            [0, 0, _, _, ..] => true,
            [0, 1, _, _, ..] => false,
            _ => return Err(no("it does not begin as one")),
        };
        Ok(Self { body: message.get(HEADER..).unwrap_or_default(), at: 0, big_endian })
    }

    fn rest(&self) -> &'a [u8] {
        self.body.get(self.at..).unwrap_or_default()
    }

    /// The next `count` bytes, aligned to `alignment`.
    fn take(&mut self, count: usize, alignment: usize) -> Result<&'a [u8], Problem> {
        self.at = self.at.next_multiple_of(alignment);
        let bytes = self.rest().get(..count).ok_or_else(|| no("it ends before its last field"))?;
        self.at += count;
        Ok(bytes)
    }

    fn word(&mut self) -> Result<u32, Problem> {
        let bytes = self.take(4, 4)?.first_chunk().copied().unwrap_or_default();
        Ok(if self.big_endian { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
    }

    /// A string; its stored length includes the terminating zero.
    fn text(&mut self) -> Result<&'a str, Problem> {
        let length = self.word()? as usize;
        let bytes = self.take(length, 1)?;
        let text = std::str::from_utf8(bytes.strip_suffix(&[0]).unwrap_or(bytes));
        text.map_err(|_| no("a name in it is not UTF-8"))
    }

    fn texts(&mut self) -> Result<Vec<&'a str>, Problem> {
        // Every string takes at least four bytes, so this allocates no more than the message can hold.
        let count = self.word()? as usize;
        if count > self.rest().len() / 4 {
            return Err(no("it names more joints than it has bytes for"));
        }
        (0..count).map(|_| self.text()).collect()
    }

    fn reals(&mut self) -> Result<Vec<f64>, Problem> {
        let count = self.word()? as usize;
        if count == 0 {
            return Ok(Vec::new());
        }
        let size = count.checked_mul(8).ok_or_else(|| no("it ends before its last field"))?;
        let (numbers, _) = self.take(size, 8)?.as_chunks();
        let real = |bytes: &[u8; 8]| {
            if self.big_endian { f64::from_be_bytes(*bytes) } else { f64::from_le_bytes(*bytes) }
        };
        Ok(numbers.iter().map(real).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A message of one joint, "abcd", at position 1.5, stamped 2 s and 3 ns.
    const BIG_ENDIAN: [u8; 60] = [
        0, 0, 0, 0, // CDR, big endian
        0, 0, 0, 2, 0, 0, 0, 3, // stamp
        0, 0, 0, 1, 0, 0, 0, 0, // an empty frame, and padding
        0, 0, 0, 1, 0, 0, 0, 5, b'a', b'b', b'c', b'd', 0, 0, 0, 0, // names, and padding
        0, 0, 0, 1, 0, 0, 0, 0, 0x3F, 0xF8, 0, 0, 0, 0, 0, 0, // positions, after padding
        0, 0, 0, 0, 0, 0, 0, 0, // no velocities, no efforts
    ];

    #[test]
    fn fields_lie_at_multiples_of_their_size() {
        let message = JointState::parse(&BIG_ENDIAN).unwrap();
        assert_eq!((message.stamp, &message.names[..]), (2_000_000_003, &["abcd"][..]));
        assert_eq!(message.fields, [vec![1.5], vec![], vec![]]);
    }

    #[test]
    fn what_is_cut_or_claims_gigabytes_is_no_message() {
        for length in 0..BIG_ENDIAN.len() {
            assert!(JointState::parse(&BIG_ENDIAN[..length]).is_err(), "{length}");
        }
        for at in (12..60).step_by(4) {
            let mut claim = BIG_ENDIAN;
            claim[at..at + 4].copy_from_slice(&[0xFF; 4]);
            // Padding and numbers can hold any bytes.
            assert!(JointState::parse(&claim).is_err() || [16, 28, 32, 40, 44, 48].contains(&at), "{at}");
        }
        let mut longer = BIG_ENDIAN.to_vec();
        longer.extend([0; PADDING]);
        assert!(JointState::parse(&longer).is_err());
    }
}
