//! Takes model files apart into their sections, and puts them together again.

use super::file::{self, Aligned};
use leastaction_core::model::{InertiaNetworkModel, ModelError, Section, parse};

/// The model of the golden file.
pub type Cartpole<'a> = InertiaNetworkModel<'a, 2, 8, 2>;

/// Reason why a file is refused.
pub fn refusal(file: &[u8]) -> ModelError {
    parse(Aligned::new(file).bytes()).map(|_| ()).expect_err("the file must be refused")
}

/// The sections of a file, numbers and contents.
pub fn split(file: &[u8]) -> Vec<(u8, Vec<u8>)> {
    let (mut sections, mut start) = (Vec::new(), 5);
    while start < file.len() - 4 {
        let length = u32::from_le_bytes(file[start + 1..start + 5].try_into().unwrap()) as usize;
        sections.push((file[start], file[start + 5..start + 5 + length].to_vec()));
        start += 5 + length;
    }
    sections
}

/// Joins sections to a file and aligns its weights anew.
pub fn join(sections: &[(u8, Vec<u8>)]) -> Vec<u8> {
    let mut file = file::golden()[..5].to_vec();
    for (number, content) in sections {
        let mut content = content.clone();
        if *number == Section::Weights as u8 && !content.is_empty() {
            let (padding, numbers) = (usize::from(content[0]), content.split_off(1));
            let zeros = (4 - (file.len() + 6) % 4) % 4;
            content = [&[zeros as u8], &vec![0; zeros][..], &numbers[padding..]].concat();
        }
        file.push(*number);
        file.extend((content.len() as u32).to_le_bytes());
        file.extend(content);
    }
    file::with_checksum(&file)
}

/// The file with the content of a section replaced, and its weights aligned anew.
pub fn with_content(file: &[u8], section: Section, content: &[u8]) -> Vec<u8> {
    let mut sections = split(file);
    sections.iter_mut().filter(|(n, _)| *n == section as u8).for_each(|(_, c)| *c = content.to_vec());
    join(&sections)
}

/// The error of a value that the format does not allow.
pub fn out_of_range(what: &'static str) -> ModelError {
    ModelError::OutOfRange { what }
}
