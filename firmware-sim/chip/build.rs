//! Gives the linker the memory of the target's board.
use std::path::Path;
use std::{env, fs};

fn main() {
    let target = env::var("CARGO_CFG_TARGET_ARCH").expect("cargo names the target");
    let memory = if target == "arm" { "memory/mps2.x" } else { "memory/virt.x" };
    let out = env::var("OUT_DIR").expect("cargo gives a folder");
    fs::copy(memory, Path::new(&out).join("memory.x")).expect("the folder can be written to");
    println!("cargo:rustc-link-search={out}");
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    println!("cargo:rerun-if-changed={memory}");
}
