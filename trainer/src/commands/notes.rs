//! What was decided about a log while it was read.

use leastaction::cli::Output;
use leastaction_learning::data::{Note, Resampled};
use std::path::PathBuf;

/// Tells every note, with its file where there are several; that many files were resampled is one note.
pub fn tell(notes: &[(PathBuf, Note)], output: Output) {
    let several = notes.iter().any(|(file, _)| *file != notes[0].0);
    let resampled: Vec<Resampled> = notes.iter().filter_map(|(_, note)| of_resampling(note)).collect();
    let together = Resampled::together(&resampled).filter(|_| resampled.len() > 1);
    if let Some(together) = &together {
        output.note(&format!("note: {} files were {together}", resampled.len()));
    }
    for (file, note) in notes {
        if together.is_some() && of_resampling(note).is_some() {
            continue;
        }
        let of = if several || of_one_file(note) { format!("{}: ", file.display()) } else { String::new() };
        output.note(&format!("note: {of}{note}"));
    }
}

/// Whether it says nothing without its file.
fn of_one_file(note: &Note) -> bool {
    matches!(note, Note::LeftOut { .. } | Note::Uncovered { .. } | Note::Unstamped { .. })
}

fn of_resampling(note: &Note) -> Option<Resampled> {
    match note {
        Note::Resampled(resampled) => Some(*resampled),
        _ => None,
    }
}
