//! Elements of MATLAB's files: a kind, a length, and numbers or bytes, at multiples of eight bytes.

/// Reason why bytes are not elements.
pub(crate) type Damage = &'static str;

/// Kinds of element whose content ends where the next element begins, whatever its length.
const UNALIGNED: u32 = 15;

const CUT: Damage = "it ends in the middle of an array";

/// Byte order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Order {
    Little,
    Big,
}

/// Elements one after the other.
pub(crate) struct Elements<'a> {
    pub rest: &'a [u8],
    pub order: Order,
}

impl<'a> Elements<'a> {
    /// The next element, its kind and content; `None` at the end.
    pub fn next(&mut self) -> Result<Option<(u32, &'a [u8])>, Damage> {
        if self.rest.is_empty() {
            return Ok(None);
        }
        let (tag, rest) = self.rest.split_first_chunk::<8>().ok_or(CUT)?;
        let [kind, length] = [0, 4].map(|at| self.word([tag[at], tag[at + 1], tag[at + 2], tag[at + 3]]));
        if kind >> 16 != 0 {
            // A small element has kind and length in one word, and up to four bytes behind it.
            let content = self.rest.get(4..8).and_then(|content| content.get(..(kind >> 16) as usize));
            self.rest = rest;
            return Ok(Some((kind & 0xFFFF, content.ok_or("a small element is longer than its place")?)));
        }
        let length = length as usize;
        let content = rest.get(..length).ok_or(CUT)?;
        let end = if kind == UNALIGNED { length } else { length.next_multiple_of(8) };
        self.rest = rest.get(end..).unwrap_or_default();
        Ok(Some((kind, content)))
    }

    fn word(&self, bytes: [u8; 4]) -> u32 {
        if self.order == Order::Big { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) }
    }

    fn needed(&mut self) -> Result<(u32, &'a [u8]), Damage> {
        self.next()?.ok_or(CUT)
    }

    /// The bytes of the next element.
    pub fn bytes(&mut self) -> Result<&'a [u8], Damage> {
        self.needed().map(|(_, content)| content)
    }

    /// The next element as a text.
    pub fn text(&mut self) -> Result<String, Damage> {
        self.bytes().map(|bytes| String::from_utf8_lossy(bytes).into_owned())
    }

    /// The next element as integers of 32 bits.
    pub fn integers(&mut self) -> Result<Vec<i64>, Damage> {
        let (words, _) = self.bytes()?.as_chunks::<4>();
        Ok(words.iter().map(|bytes| i64::from(self.word(*bytes) as i32)).collect())
    }

    /// The next element as numbers of whatever type it has; integers beyond 2⁵³ are rounded.
    pub fn numbers(&mut self) -> Result<Vec<f64>, Damage> {
        let (kind, bytes) = self.needed()?;
        let order = self.order;
        Ok(match kind {
            1 => all(bytes, order, |x| f64::from(i8::from_le_bytes(x))),
            2 => all(bytes, order, |x| f64::from(u8::from_le_bytes(x))),
            3 => all(bytes, order, |x| f64::from(i16::from_le_bytes(x))),
            4 => all(bytes, order, |x| f64::from(u16::from_le_bytes(x))),
            5 => all(bytes, order, |x| f64::from(i32::from_le_bytes(x))),
            6 => all(bytes, order, |x| f64::from(u32::from_le_bytes(x))),
            7 => all(bytes, order, |x| f64::from(f32::from_le_bytes(x))),
            9 => all(bytes, order, f64::from_le_bytes),
            12 => all(bytes, order, |x| i64::from_le_bytes(x) as f64),
            13 => all(bytes, order, |x| u64::from_le_bytes(x) as f64),
            _ => return Err("an array has values of a type that is no number's"),
        })
    }
}

/// Numbers of N bytes each; `number` reads them lowest byte first.
fn all<const N: usize>(bytes: &[u8], order: Order, number: impl Fn([u8; N]) -> f64) -> Vec<f64> {
    let (chunks, _) = bytes.as_chunks::<N>();
    let sorted = |mut chunk: [u8; N]| {
        if order == Order::Big {
            chunk.reverse();
        }
        chunk
    };
    chunks.iter().map(|chunk| number(sorted(*chunk))).collect()
}
