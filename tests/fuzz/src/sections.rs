//! Sections of a model file, taken apart and joined again, for changes that keep lengths, padding and the number of weights right.

use crate::Random;
use crate::model::File;
use leastaction_core::model::{ModelError, Section, parse};

/// Number and content of every section.
type Parts = Vec<(u8, Vec<u8>)>;

/// Length of the head of a section: its number and the length of its content.
const HEAD: usize = 5;
/// Length of the magic letters and the version.
const PREFIX: usize = 5;

/// Splits off the sections, as far as their lengths go.
fn split(mut bytes: &[u8]) -> Parts {
    let mut parts = Vec::new();
    while let Some(([number, length @ ..], rest)) = bytes.split_first_chunk::<HEAD>() {
        let length = (u32::from_le_bytes(*length) as usize).min(rest.len());
        parts.push((*number, rest[..length].to_vec()));
        bytes = &rest[length..];
    }
    parts
}

/// Joins the sections with right lengths, and with the weights at a position where they can be borrowed.
fn join(parts: &Parts) -> Vec<u8> {
    let mut bytes = Vec::new();
    for (number, content) in parts {
        let content = if *number == Section::Weights as u8 {
            placed(content, PREFIX + bytes.len() + HEAD)
        } else {
            content.clone()
        };
        bytes.push(*number);
        bytes.extend((content.len() as u32).to_le_bytes());
        bytes.extend(content);
    }
    bytes
}

/// Returns the weights after as many zeros as necessary, for a section whose content begins at `start`.
fn placed(content: &[u8], start: usize) -> Vec<u8> {
    let zeros = (start + 1).next_multiple_of(4) - (start + 1);
    [&[zeros as u8][..], &vec![0; zeros], numbers(content)].concat()
}

/// Returns the weights without the zeros before them.
fn numbers(content: &[u8]) -> &[u8] {
    let zeros = content.first().map_or(0, |n| usize::from(*n));
    content.get(1 + zeros..).unwrap_or(&[])
}

/// Changes the content of one section by `change`, and then in most cases the number of weights to what the shape
/// needs. In one of eight cases, `change` is applied to all bytes instead. Returns the new length; if the result is
/// too long, leaves the data unchanged.
pub fn mutate(
    data: &mut [u8],
    size: usize,
    most: usize,
    seed: u32,
    change: impl Fn(&mut [u8], usize, usize) -> usize,
) -> usize {
    let mut random = Random(u64::from(seed).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    random.below(2);
    let mut parts = split(&data[..size]);
    if parts.is_empty() || random.below(8) == 0 {
        return change(data, size, most);
    }
    let chosen = random.below(parts.len());
    let content = &mut parts[chosen].1;
    let length = content.len();
    content.resize(length + 64, 0);
    let length = change(content, length, length + 64);
    content.truncate(length);
    if random.below(8) != 0 {
        fit(&mut parts);
    }
    let bytes = join(&parts);
    if bytes.len() > most {
        return size;
    }
    data[..bytes.len()].copy_from_slice(&bytes);
    bytes.len()
}

/// Gives the file as many weights as it needs, by repeating the first ones if there are too few.
fn fit(parts: &mut Parts) {
    let Err(ModelError::WeightCount { needed, .. }) = parse(File::of(&join(parts)).bytes()) else { return };
    let Some((_, content)) = parts.iter_mut().find(|(number, _)| *number == Section::Weights as u8) else {
        return;
    };
    let block = numbers(content).to_vec();
    if needed <= 4096 && block.len() >= 4 {
        let whole = block.len() / 4 * 4;
        *content = [0].into_iter().chain(block[..whole].iter().copied().cycle().take(4 * needed)).collect();
    }
}
