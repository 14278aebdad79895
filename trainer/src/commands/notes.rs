//! What was decided about a log while it was read.

use leastaction::cli::Output;
use leastaction_learning::data::Note;
use std::path::PathBuf;

/// Tells every note, with its file where there are several.
pub fn tell(notes: &[(PathBuf, Note)], output: Output) {
    let several = notes.iter().any(|(file, _)| *file != notes[0].0);
    for (file, note) in notes {
        let of = if several { format!("{}: ", file.display()) } else { String::new() };
        output.note(&format!("note: {of}{note}"));
    }
}
