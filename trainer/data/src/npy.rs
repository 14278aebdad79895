//! The `.npy` format: the header of an array, and its numbers.
//!
//! Source: NumPy Enhancement Proposal 1 (numpy.lib.format), versions 1 to 3.

use std::io::{self, Read};

/// First bytes of every array.
const MAGIC: [u8; 6] = *b"\x93NUMPY";
/// Alignment of the header size.
const ALIGNMENT: usize = 64;
/// Longest header, bytes. NumPy refuses longer ones, too: no honest file needs them.
pub(crate) const LONGEST_HEADER: usize = 10_000;
/// Largest number of bytes in an array before the text of its header.
pub(crate) const BEFORE_HEADER: usize = 12;

/// Reason why bytes are not an array.
pub(crate) type Damage = &'static str;

/// Element type, order and shape of an array.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Header {
    /// Element type as NumPy names it, `<f8` for instance.
    pub descriptor: String,
    /// Column-major order.
    pub fortran_order: bool,
    pub shape: Vec<usize>,
    /// Offset of the first element, bytes.
    pub bytes: usize,
}

impl Header {
    /// Reads the header at the beginning of an array.
    pub fn read(npy: &[u8]) -> Result<Self, Damage> {
        const CUT: Damage = "its header is cut off, or too long";
        let rest = npy.strip_prefix(&MAGIC).ok_or("it does not begin as an array")?;
        let (start, length) = match *rest {
            [1, _, a, b, ..] => (10, usize::from(u16::from_le_bytes([a, b]))),
            [2 | 3, _, a, b, 0, 0, ..] => (12, usize::from(u16::from_le_bytes([a, b]))),
            _ => return Err(CUT),
        };
        if length > LONGEST_HEADER {
            return Err("its header is too long");
        }
        let bytes = start + length;
        let text = npy.get(start..bytes).ok_or(CUT)?;
        let text = str::from_utf8(text).map_err(|_| "its header is not a text")?;
        Dictionary(text).header(bytes).ok_or("its header is no array's")
    }

    /// The header of an array with this element type and shape, as NumPy writes it.
    pub fn written(descriptor: &str, shape: &[usize]) -> Vec<u8> {
        let axes: Vec<String> = shape.iter().map(usize::to_string).collect();
        let comma = if axes.len() == 1 { "," } else { "" };
        let axes = axes.join(", ");
        let dictionary =
            format!("{{'descr': '{descriptor}', 'fortran_order': False, 'shape': ({axes}{comma}), }}");
        // The prefix of version 1 has ten bytes, the newline one.
        let length = (10 + dictionary.len() + 1).next_multiple_of(ALIGNMENT) - 10;
        let mut npy = [&MAGIC[..], &[1, 0], &(length as u16).to_le_bytes()].concat();
        npy.extend(format!("{dictionary:<width$}\n", width = length - 1).bytes());
        npy
    }
}

/// Rest of the text of a header, a Python dictionary with three keys.
struct Dictionary<'a>(&'a str);

impl<'a> Dictionary<'a> {
    fn header(mut self, bytes: usize) -> Option<Header> {
        let (mut descriptor, mut fortran_order, mut shape) = (None, None, None);
        self.token("{")?;
        while self.token("}").is_none() {
            let key = self.string()?;
            self.token(":")?;
            match key {
                "descr" => descriptor = Some(self.descriptor()?),
                "fortran_order" => fortran_order = Some(self.truth()?),
                "shape" => shape = Some(self.shape()?),
                _ => return None,
            }
            if self.token(",").is_none() && !self.0.trim_start().starts_with('}') {
                return None;
            }
        }
        let is_all = self.0.trim().is_empty();
        is_all.then_some(Header {
            descriptor: descriptor?,
            fortran_order: fortran_order?,
            shape: shape?,
            bytes,
        })
    }

    fn token(&mut self, token: &str) -> Option<()> {
        self.0 = self.0.trim_start().strip_prefix(token)?;
        Some(())
    }

    fn string(&mut self) -> Option<&'a str> {
        let text = self.0.trim_start();
        let quote = text.chars().next().filter(|quote| ['\'', '"'].contains(quote))?;
        let (string, rest) = text[1..].split_once(quote)?;
        self.0 = rest;
        Some(string)
    }

    /// Reads a string; a list, which describes the fields of a record, is kept verbatim.
    fn descriptor(&mut self) -> Option<String> {
        let text = self.0.trim_start();
        if !text.starts_with('[') {
            return self.string().map(str::to_owned);
        }
        let mut depth = 0_usize;
        let end = text.find(|letter: char| {
            depth = match letter {
                '[' => depth + 1,
                ']' => depth.saturating_sub(1),
                _ => depth,
            };
            depth == 0
        })?;
        let (fields, rest) = text.split_at(end + 1);
        self.0 = rest;
        Some(fields.to_owned())
    }

    fn truth(&mut self) -> Option<bool> {
        self.token("True").map(|()| true).or_else(|| self.token("False").map(|()| false))
    }

    fn shape(&mut self) -> Option<Vec<usize>> {
        self.token("(")?;
        let (axes, rest) = self.0.split_once(')')?;
        self.0 = rest;
        let axes = axes.trim().strip_suffix(',').unwrap_or(axes).trim();
        if axes.is_empty() {
            return Some(Vec::new());
        }
        // Python 2 wrote long numbers with an L.
        axes.split(',').map(|axis| axis.trim().trim_end_matches('L').parse().ok()).collect()
    }
}

/// Element type of an array.
pub(crate) trait Element: Copy {
    /// NumPy's name of the little-endian type.
    const DESCRIPTOR: &'static str;
    /// Size of an element, bytes.
    const BYTES: usize;
    /// The element in these bytes.
    fn from_bytes(bytes: &[u8], big_endian: bool) -> Option<Self>;
    /// Appends the element in little-endian order.
    fn append_to(self, bytes: &mut Vec<u8>);
}

macro_rules! elements {
    ($($name:literal: $type:ty),*) => {
        $(impl Element for $type {
            const DESCRIPTOR: &'static str = $name;
            const BYTES: usize = size_of::<$type>();

            fn from_bytes(bytes: &[u8], big_endian: bool) -> Option<Self> {
                let bytes = bytes.try_into().ok()?;
                Some(if big_endian { Self::from_be_bytes(bytes) } else { Self::from_le_bytes(bytes) })
            }

            fn append_to(self, bytes: &mut Vec<u8>) {
                bytes.extend(self.to_le_bytes());
            }
        })*
    };
}

elements!("<f8": f64, "<f4": f32, "<i8": i64, "<i4": i32, "<i2": i16, "|i1": i8, "<u8": u64, "<u4": u32, "<u2": u16, "|u1": u8);

/// Elements per read.
const BLOCK: usize = 8192;

/// Reads exactly `count` elements in the order of the file.
pub(crate) fn elements<T: Element, U>(
    mut from: impl Read,
    (count, big_endian): (usize, bool),
    into: impl Fn(T) -> U,
) -> io::Result<Vec<U>> {
    let (mut all, mut bytes) = (Vec::new(), vec![0; T::BYTES * BLOCK.min(count)]);
    while all.len() < count {
        let block = &mut bytes[..T::BYTES * BLOCK.min(count - all.len())];
        from.read_exact(block)?;
        all.extend(block.chunks_exact(T::BYTES).filter_map(|x| T::from_bytes(x, big_endian)).map(&into));
    }
    Ok(all)
}

/// Row-major copy of an array in column-major order.
pub(crate) fn row_major<U: Clone>(shape: &[usize], of: &[U]) -> Vec<U> {
    let place = |row_major: usize| {
        let (mut rest, mut place) = (row_major, 0);
        for (axis, size) in shape.iter().enumerate().rev() {
            place += rest % size * shape[..axis].iter().product::<usize>();
            rest /= size;
        }
        place
    };
    (0..of.len()).map(|k| of[place(k)].clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(text: &str) -> Result<Header, Damage> {
        let length = (text.len() as u16).to_le_bytes();
        Header::read(&[&MAGIC[..], &[1, 0], &length, text.as_bytes()].concat())
    }

    #[test]
    fn headers_are_those_of_numpy() {
        for (shape, text) in [(&[][..], "()"), (&[3][..], "(3,)"), (&[3, 4][..], "(3, 4)")] {
            let npy = Header::written("<f8", shape);
            assert_eq!((npy.len() % ALIGNMENT, npy.last()), (0, Some(&b'\n')));
            assert!(String::from_utf8_lossy(&npy).contains(&format!("'shape': {text}, }}")));
            let found = Header::read(&npy).unwrap();
            assert_eq!((found.descriptor.as_str(), found.shape.as_slice()), ("<f8", shape));
            assert_eq!((found.fortran_order, found.bytes), (false, npy.len()));
        }
        let found = header("{\"shape\": (2L, 3L), 'fortran_order': True, 'descr': [('a', '<f8')]}").unwrap();
        assert_eq!((found.descriptor.as_str(), found.fortran_order), ("[('a', '<f8')]", true));
        assert_eq!(found.shape, [2, 3]);
    }

    #[test]
    fn what_is_no_header_is_refused() {
        let good = "{'descr': '<f8', 'fortran_order': False, 'shape': (3,)}";
        assert!(header(good).is_ok());
        for (from, to) in
            [("'<f8'", "8"), ("False", "0"), ("(3,)", "3"), ("(3,)", "(-3,)"), ("}", ""), ("}", "} 1")]
        {
            assert!(header(&good.replace(from, to)).is_err(), "{to}");
        }
        assert!(header("{'descr': '<f8', 'shape': (3,)}").is_err());
        assert!(header("{'descr': [[[").is_err());
        assert!((0..good.len()).all(|end| header(&good[..end]).is_err()));
        assert!(Header::read(b"\x93NUMPY\x01\x00\xFF\xFF{").is_err() && Header::read(b"").is_err());
    }

    #[test]
    fn elements_come_in_rows_from_either_order() {
        let bytes: Vec<u8> = [1_i16, -2, 3, 4, 5, 6].iter().flat_map(|x| x.to_be_bytes()).collect();
        let found = elements(&bytes[..], (6, true), |x: i16| f64::from(x)).unwrap();
        assert_eq!(found, [1.0, -2.0, 3.0, 4.0, 5.0, 6.0]);
        assert_eq!(row_major(&[2, 3], &found), [1.0, 3.0, 5.0, -2.0, 4.0, 6.0]);
        assert_eq!(row_major(&[3, 2], &found), [1.0, 4.0, -2.0, 5.0, 3.0, 6.0]);
        assert!(elements(&bytes[..11], (6, true), |x: i16| x).is_err());
    }
}
