//! NumPy arrays that hold a single string.

use ndarray_npy::npy::header::Header;

use crate::error::Problem;

/// Bytes before the header text, in format version 1.
const PREFIX: usize = 10;

/// Alignment of the header size.
const ALIGNMENT: usize = 64;

/// The string of an array of shape () or (1,), of type `U` or `S`; its header must have been checked before.
pub(crate) fn read(npy: &[u8]) -> Result<String, Problem> {
    let mut rest = npy;
    let header = Header::from_reader(&mut rest).map_err(|error| Problem::NotNpy(error.to_string()))?;
    let descriptor = header.type_descriptor.to_string();
    let kind = descriptor.trim_matches(['\'', '"']);
    let text = match kind.trim_start_matches(['<', '>', '|', '=']).as_bytes() {
        _ if header.shape.iter().any(|axis| *axis != 1) => None,
        [b'U', ..] => utf_32(rest, kind.starts_with('>')),
        [b'S', ..] => String::from_utf8(rest.to_vec()).ok(),
        _ => None,
    };
    let text = text.ok_or(Problem::NotString { kind: kind.to_owned(), shape: header.shape })?;
    Ok(text.trim_end_matches('\0').to_owned())
}

fn utf_32(bytes: &[u8], big_endian: bool) -> Option<String> {
    let (letters, rest) = bytes.as_chunks::<4>();
    let number = |letter: &[u8; 4]| {
        if big_endian { u32::from_be_bytes(*letter) } else { u32::from_le_bytes(*letter) }
    };
    let text = letters.iter().map(|letter| char::from_u32(number(letter))).collect::<Option<String>>();
    text.filter(|_| rest.is_empty())
}

/// An array of shape () that holds this string, as `numpy.savez(path, key="…")` writes it.
pub(crate) fn write(text: &str) -> Vec<u8> {
    let dictionary =
        format!("{{'descr': '<U{}', 'fortran_order': False, 'shape': (), }}", text.chars().count());
    // One byte more for the newline.
    let length = (PREFIX + dictionary.len() + 1).next_multiple_of(ALIGNMENT) - PREFIX;
    let mut npy = b"\x93NUMPY\x01\x00".to_vec();
    npy.extend((length as u16).to_le_bytes());
    npy.extend(format!("{dictionary:<width$}\n", width = length - 1).bytes());
    npy.extend(text.chars().flat_map(|letter| u32::from(letter).to_le_bytes()));
    npy
}
