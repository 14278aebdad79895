//! The data files of a data set, by the template of their paths.

use super::info::Info;
use crate::lerobot_problem::LerobotProblem;
use std::path::Path;

/// Paths of all data files, relative to the data set, in the order of their episodes.
pub(super) fn all(folder: &Path, info: &Info) -> Result<Vec<String>, LerobotProblem> {
    let files = if info.has_file_per_episode() { of_episodes(info)? } else { numbered(folder, info)? };
    match files.iter().find(|file| !folder.join(file).is_file()) {
        Some(missing) => Err(LerobotProblem::NoFile(missing.clone())),
        None => Ok(files),
    }
}

/// A file of each episode; a count that no data set has is cut off, and its files are missing.
fn of_episodes(info: &Info) -> Result<Vec<String>, LerobotProblem> {
    const MOST: u64 = 10_000_000;
    let chunk = |episode: u64| episode / info.chunks_size.max(1);
    let path = |episode: u64| {
        filled(
            &info.data_path,
            [("episode_chunk", chunk(episode)), ("episode_index", episode)],
            "episode_index",
        )
    };
    (0..info.total_episodes.min(MOST)).map(path).collect()
}

/// The files that are there, of which each has several episodes: counted within a chunk, and chunk by chunk.
fn numbered(folder: &Path, info: &Info) -> Result<Vec<String>, LerobotProblem> {
    let path = |chunk: u64, file: u64| {
        filled(&info.data_path, [("chunk_index", chunk), ("file_index", file)], "file_index")
    };
    let (mut files, mut chunk, mut file) = (Vec::new(), 0, 0);
    loop {
        let next = path(chunk, file)?;
        if folder.join(&next).is_file() && !files.contains(&next) {
            files.push(next);
            file += 1;
        } else if file > 0 {
            (chunk, file) = (chunk + 1, 0);
        } else if chunk == 0 {
            return Err(LerobotProblem::NoFile(next));
        } else {
            return Ok(files);
        }
    }
}

/// The template with its numbers: `{name:06d}` is six digits at least. The number called `needed` must be there.
fn filled(template: &str, numbers: [(&str, u64); 2], needed: &'static str) -> Result<String, LerobotProblem> {
    let no = || LerobotProblem::Path { path: template.to_owned(), missing: needed };
    let mut parts = template.split('{');
    let mut path = parts.next().unwrap_or_default().to_owned();
    let mut has_needed = false;
    for part in parts {
        let (field, rest) = part.split_once('}').ok_or_else(no)?;
        let (name, digits) = field.split_once(':').unwrap_or((field, ""));
        let (known, number) = numbers.iter().find(|(known, _)| *known == name).ok_or_else(no)?;
        let digits = digits.trim_end_matches('d').parse().unwrap_or(0).min(20);
        path.push_str(&format!("{number:0digits$}{rest}"));
        has_needed |= *known == needed;
    }
    if has_needed { Ok(path) } else { Err(no()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn templates_have_their_numbers_filled_in() {
        let fill =
            |template| filled(template, [("episode_chunk", 2), ("episode_index", 34)], "episode_index");
        assert_eq!(
            fill("data/chunk-{episode_chunk:03d}/{episode_index:06d}.parquet").unwrap(),
            "data/chunk-002/000034.parquet"
        );
        assert_eq!(fill("{episode_index}").unwrap(), "34");
        for bad in ["data/all.parquet", "{episode_chunk}", "{file_index}", "{episode_index"] {
            assert!(fill(bad).unwrap_err().to_string().contains("{episode_index} is missing"), "{bad}");
        }
    }
}
