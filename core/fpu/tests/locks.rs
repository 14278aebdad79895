//! Every lock file of the repository names equal versions of the crates on which the bits of a result depend: host, firmware, C library and
//! examples compute with the same functions.

use std::collections::{BTreeMap, BTreeSet};
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

/// A package of a lock file: name, version, and dependencies, each with a version where the file has several.
struct Package<'a> {
    name: &'a str,
    version: &'a str,
    dependencies: Vec<&'a str>,
}

fn packages(lock: &str) -> Vec<Package<'_>> {
    let package = |text| {
        let value = |key| str::lines(text).find_map(|line| line.strip_prefix(key)?.strip_prefix(" = "));
        let quoted = |key| value(key).unwrap().trim_matches('"');
        let dependencies = text.lines().filter_map(|line| line.strip_prefix(" \"")?.strip_suffix("\","));
        Package { name: quoted("name"), version: quoted("version"), dependencies: dependencies.collect() }
    };
    lock.split("[[package]]").skip(1).map(package).collect()
}

/// Versions by name of the crates on which ours and those that read files depend. Other crates may need other versions: a board's
/// drivers do.
fn versions(lock: &str) -> BTreeMap<&str, BTreeSet<&str>> {
    let packages = packages(lock);
    let ours = |package: &&Package| package.name.starts_with("leastaction") || FILES.contains(&package.name);
    let mut versions = BTreeMap::<_, BTreeSet<_>>::new();
    for dependency in packages.iter().filter(ours).flat_map(|package| &package.dependencies) {
        let (name, version) =
            dependency.split_once(' ').map_or((*dependency, None), |(name, version)| (name, Some(version)));
        let found = packages.iter().filter(|package| {
            package.name == name && version.is_none_or(|version| version == package.version)
        });
        versions.entry(name).or_default().extend(found.map(|package| package.version));
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
    // A rival's program has a lock file, too, and nothing of ours.
    let ours = |text: &str| text.contains("name = \"leastaction-core\"");
    for (file, text) in files.iter().zip(&texts).filter(|(_, text)| ours(text)) {
        let versions = versions(text);
        // Tools of the host may need another version of a crate, too; firmware has none of them.
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
