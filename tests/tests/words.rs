//! Comments start with what they name: none begins with a word that hides the noun, and no doc comment writes "so" and "many" for a number.

use std::fs;
use std::path::{Path, PathBuf};

/// Words that no comment begins with.
const BEGINNINGS: [&str; 11] =
    ["What", "Of", "Where", "As", "Its", "The same", "Those", "That of", "So", "By", "In"];

/// Folders without handwritten comments: builds, git's own data, the compiled book, inputs of the fuzzer, generated files, runs.
const SKIPPED: [&str; 6] =
    ["target", ".git", "docs/book/html", "tests/fuzz/corpus", "trainer/tests/cli_golden", "runs"];

/// Mark and text of a line that is a comment.
fn comment(line: &str) -> Option<(&str, &str)> {
    let line = line.trim_start();
    ["///", "//!", "//"].into_iter().find_map(|mark| Some((mark, line.strip_prefix(mark)?)))
}

fn begins_with(text: &str, word: &str) -> bool {
    let rest = text.trim_start().strip_prefix(word);
    rest.is_some_and(|rest| !rest.starts_with(|next: char| next.is_alphanumeric() || "_-".contains(next)))
}

/// Line numbers, from 1, and the text of all comments of a file that hide the noun.
fn offences(source: &str) -> Vec<(usize, &str)> {
    let (mut found, mut previous, mut code) = (Vec::new(), None, false);
    for (index, line) in source.lines().enumerate() {
        let Some((mark, text)) = comment(line) else {
            (previous, code) = (None, false);
            continue;
        };
        let doc = mark != "//";
        let fence = doc && text.trim_start().starts_with("```");
        let begins = previous != Some(mark) && BEGINNINGS.iter().any(|word| begins_with(text, word));
        let counts = doc && text.to_lowercase().contains("so many");
        if !code && !fence && (begins || counts) {
            found.push((index + 1, line.trim()));
        }
        (previous, code) = (Some(mark), code != fence);
    }
    found
}

/// All Rust files of a folder of the repository.
fn sources(repository: &Path, folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(repository.join(folder)).unwrap() {
        let entry = entry.unwrap();
        let path = folder.join(entry.file_name());
        let skipped = SKIPPED.iter().any(|skipped| path == Path::new(skipped));
        if entry.file_type().unwrap().is_dir() {
            if !skipped && !path.ends_with("target") {
                sources(repository, &path, found);
            }
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

#[test]
fn comments_start_with_what_they_name() {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut files = Vec::new();
    sources(&repository, Path::new(""), &mut files);
    assert!(files.len() > 300, "{} files", files.len());
    let mut report = Vec::new();
    for file in &files {
        let source = fs::read_to_string(repository.join(file)).unwrap();
        let found = offences(&source);
        report.extend(found.iter().map(|(line, text)| format!("{}:{line}: {text}", file.display())));
    }
    report.sort();
    assert!(report.is_empty(), "comments that hide what they name:\n{}", report.join("\n"));
}

#[test]
fn hidden_nouns_are_found() {
    let lines = |source: &str| offences(source).iter().map(|(line, _)| *line).collect::<Vec<_>>();
    for word in BEGINNINGS {
        assert_eq!(lines(&format!("fn f() {{\n    // {word} a filter, Hz.")), [2], "{word}");
        assert_eq!(lines(&format!("//! {word}: a filter.\n//! {word}\n/// {word}")), [1, 3], "{word}");
    }
    assert_eq!(lines("// Steps.\n/// Its rows.\nfn f() {}\n/// The sum\n/// So many rows."), [2, 5]);
}

#[test]
fn other_words_are_allowed() {
    for source in [
        "/// Offset of a joint, rad.\n/// Of all joints.",
        "/// In-place sum.\n/// Summands are many.",
        "/// A sum:\n///\n/// ```\n/// // So many rows.\n/// ```\n/// Rows.",
        "let a = 1; // in a line of code\n// Rows so many.",
    ] {
        assert_eq!(offences(source), [], "{source}");
    }
}
