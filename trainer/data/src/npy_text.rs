//! NumPy arrays that hold a single string.

use crate::npy::Header;
use crate::problem::Problem;

/// The string of an array of shape () or (1,), of type `U` or `S`; its header must have been checked before.
pub(crate) fn read(npy: &[u8]) -> Result<String, Problem> {
    let header = Header::read(npy).map_err(|reason| Problem::NotNpy(reason.to_owned()))?;
    let (kind, rest) = (header.descriptor.as_str(), npy.get(header.bytes..).unwrap_or_default());
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
    let mut npy = Header::written(&format!("<U{}", text.chars().count()), &[]);
    npy.extend(text.chars().flat_map(|letter| u32::from(letter).to_le_bytes()));
    npy
}
