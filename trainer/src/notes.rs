//! Notes on decisions made while a log was read.

use leastaction_learning::data::{Note, Resampled};
use std::path::PathBuf;

/// All notes as sentences, with their file if there are several files; notes on resampled files are merged into one.
pub fn sentences(notes: &[(PathBuf, Note)]) -> Vec<String> {
    let mut said = Vec::new();
    let several = notes.iter().any(|(file, _)| *file != notes[0].0);
    let resampled: Vec<Resampled> = notes.iter().filter_map(|(_, note)| of_resampling(note)).collect();
    let together = Resampled::together(&resampled).filter(|_| resampled.len() > 1);
    if let Some(together) = &together {
        said.push(format!("{} files were {together}", resampled.len()));
    }
    for (file, note) in notes {
        if together.is_some() && of_resampling(note).is_some() {
            continue;
        }
        let of = if several || of_one_file(note) { format!("{}: ", file.display()) } else { String::new() };
        said.push(format!("{of}{note}"));
    }
    said
}

/// Whether a note is meaningless without its file.
fn of_one_file(note: &Note) -> bool {
    matches!(note, Note::LeftOut { .. } | Note::Uncovered { .. } | Note::Unstamped { .. })
}

fn of_resampling(note: &Note) -> Option<Resampled> {
    match note {
        Note::Resampled(resampled) => Some(*resampled),
        _ => None,
    }
}
