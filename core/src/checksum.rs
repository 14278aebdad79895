//! CRC-32/ISO-HDLC, the checksum of all files, which may be continued piece by piece.
//!
//! Source: D. V. Sarwate, "Computation of cyclic redundancy checks via table look-up", Communications of the ACM 31(8), 1988.

/// Generator polynomial, reflected.
const POLYNOMIAL: u32 = 0xedb8_8320;
/// Remainders of all half bytes: 64 bytes of flash.
const REMAINDERS: [u32; 16] = remainders();

const fn remainders() -> [u32; 16] {
    let (mut table, mut nibble) = ([0; 16], 0);
    while nibble < 16 {
        let (mut remainder, mut bit) = (nibble as u32, 0);
        while bit < 4 {
            remainder = (remainder >> 1) ^ (POLYNOMIAL * (remainder & 1));
            bit += 1;
        }
        table[nibble] = remainder;
        nibble += 1;
    }
    table
}

/// A checksum under way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Checksum(u32);

impl Checksum {
    /// Creates the checksum of nothing.
    pub(crate) const fn new() -> Self {
        Self(u32::MAX)
    }

    /// Continues over further bytes, word by word as far as they go.
    pub(crate) fn over(self, bytes: &[u8]) -> Self {
        let (words, rest) = bytes.as_chunks::<4>();
        let sum = words.iter().fold(self.0, |sum, word| divide::<8>(sum ^ u32::from_le_bytes(*word)));
        Self(rest.iter().fold(sum, |sum, byte| divide::<2>(sum ^ u32::from(*byte))))
    }

    /// The checksum of all bytes so far.
    pub(crate) const fn value(self) -> u32 {
        !self.0
    }
}

/// Divides the lowest half bytes out.
fn divide<const NIBBLES: usize>(mut sum: u32) -> u32 {
    for _ in 0..NIBBLES {
        sum = (sum >> 4) ^ REMAINDERS[(sum & 15) as usize];
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Check value of the catalogue of parametrised CRC algorithms.
    #[test]
    fn check_value() {
        assert_eq!(Checksum::new().over(b"123456789").value(), 0xcbf4_3926);
        assert_eq!(Checksum::new().value(), 0);
    }

    #[test]
    fn pieces_make_the_whole() {
        let bytes: [u8; 61] = core::array::from_fn(|i| (i * i + 7 * i) as u8);
        let whole = Checksum::new().over(&bytes);
        for middle in 0..=bytes.len() {
            let (first, second) = bytes.split_at(middle);
            assert_eq!(Checksum::new().over(first).over(second), whole, "cut at {middle}");
        }
    }
}
