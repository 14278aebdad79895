//! Every lock file of the repository names equal versions of the crates on which the bits of a result depend: host, firmware, C library and
//! examples compute with the same functions.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Elementary functions and square roots, half precision, and square roots side by side.
const NUMBERS: [&str; 3] = ["libm", "half", "wide"];
/// Other crates that decide how a model file is read.
const FILES: [&str; 5] = ["postcard", "serde", "crc", "bytemuck", "heapless"];

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// All lock files, except those that a build left.
fn locks(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() && !path.is_symlink() && !path.ends_with("target") && !path.ends_with(".git") {
            locks(&path, found);
        } else if path.ends_with("Cargo.lock") {
            found.push(path);
        }
    }
}

/// Versions by name, from a lock file.
fn versions(lock: &str) -> BTreeMap<&str, Vec<&str>> {
    let mut versions = BTreeMap::<_, Vec<_>>::new();
    for package in lock.split("[[package]]").skip(1) {
        let value = |key: &str| package.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(" = "));
        let (name, version) = (value("name").unwrap(), value("version").unwrap());
        versions.entry(name.trim_matches('"')).or_default().push(version.trim_matches('"'));
    }
    versions
}

#[test]
fn host_and_firmware_have_one_version_of_what_bits_depend_on() {
    let mut files = Vec::new();
    locks(&repository(), &mut files);
    assert!(
        files.len() >= 8,
        "host, chip, two examples, C library and tools, panic-freedom, fuzzing: {files:?}"
    );
    let texts: Vec<String> = files.iter().map(|file| fs::read_to_string(file).unwrap()).collect();
    let host = fs::read_to_string(repository().join("Cargo.lock")).unwrap();
    let host = versions(&host);
    for (file, text) in files.iter().zip(&texts) {
        let versions = versions(text);
        // If the host has two versions of a crate, the version that all lock files have is ours.
        for name in NUMBERS.iter().chain(&FILES) {
            for version in versions.get(name).into_iter().flatten() {
                assert!(
                    host[name].contains(version),
                    "{}: {name} {version}, host {:?}",
                    file.display(),
                    host[name]
                );
            }
        }
        assert!(versions.contains_key("libm"), "{} has no elementary functions", file.display());
    }
}

/// Exact versions keep any program that uses core from computing with others.
#[test]
fn manifests_name_exact_versions() {
    let manifest = fs::read_to_string(repository().join("Cargo.toml")).unwrap();
    for name in NUMBERS {
        let line = manifest.lines().find(|line| line.starts_with(&format!("{name} = "))).unwrap();
        assert!(line.contains("version = \"="), "{line}");
    }
}
