//! Build script for the prefix of all exported names, from the environment variable LEASTACTION_PREFIX: libraries of two shapes link into
//! one program if their prefixes differ.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-env-changed=LEASTACTION_PREFIX");
    let prefix = std::env::var("LEASTACTION_PREFIX").unwrap_or_else(|_| "leastaction_".into());
    let letters = |c: char| c.is_ascii_lowercase() || c == '_';
    if !prefix.starts_with(letters) || !prefix.chars().all(|c| letters(c) || c.is_ascii_digit()) {
        panic!(
            "LEASTACTION_PREFIX must be lower-case letters, digits and _, and begin with no digit: {prefix}"
        );
    }
    println!("cargo:rustc-env=LEASTACTION_EXPORTS={prefix}");
}
