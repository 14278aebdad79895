//! What was decided about a log while it was read.

use leastaction::cli::Output;
use leastaction_learning::data::Note;
use std::path::PathBuf;

/// Tells every note, with its file where there are several; that many files were resampled is one note.
pub fn tell(notes: &[(PathBuf, Note)], output: Output) {
    let several = notes.iter().any(|(file, _)| *file != notes[0].0);
    let together = resampled(notes);
    if let Some(together) = &together {
        output.note(&format!("note: {together}"));
    }
    for (file, note) in notes {
        if together.is_some() && matches!(note, Note::Resampled { .. }) {
            continue;
        }
        let of = if several { format!("{}: ", file.display()) } else { String::new() };
        output.note(&format!("note: {of}{note}"));
    }
}

/// What is common to the notes of files that were resampled, where there are several: the step, and of the intervals the median of medians,
/// the shortest and the longest.
fn resampled(notes: &[(PathBuf, Note)]) -> Option<String> {
    let mut medians = Vec::new();
    let mut all: Option<Note> = None;
    for (_, note) in notes {
        let Note::Resampled { median, shortest, longest, repeated, .. } = note else { continue };
        medians.push(*median);
        let Note::Resampled { shortest: least, longest: most, repeated: sum, .. } =
            all.get_or_insert(note.clone())
        else {
            continue;
        };
        if medians.len() > 1 {
            (*least, *most, *sum) = (least.min(*shortest), most.max(*longest), *sum + repeated);
        }
    }
    medians.sort_unstable_by(f64::total_cmp);
    let middle = *medians.get(medians.len() / 2)?;
    if let Some(Note::Resampled { median, .. }) = &mut all {
        *median = middle;
    }
    all.filter(|_| medians.len() > 1).map(|note| format!("{} files were {note}", medians.len()))
}
