//! Build script that gives the linker the memory of the target's board.
use std::path::Path;
use std::{env, fs};

fn main() {
    let architecture = env::var("CARGO_CFG_TARGET_ARCH").expect("cargo names the architecture");
    let target = env::var("TARGET").expect("cargo names the target");
    let memory = match architecture.as_str() {
        "arm" if target.starts_with("thumbv6m") => "memory/microbit.x",
        "arm" => "memory/mps2.x",
        _ => "memory/virt.x",
    };
    let out = env::var("OUT_DIR").expect("cargo gives a folder");
    fs::copy(memory, Path::new(&out).join("memory.x")).expect("the folder can be written to");
    println!("cargo:rustc-link-search={out}");
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    println!("cargo:rerun-if-changed={memory}");
    shape(Path::new(&out));
}

/// Writes the source of the model for the image `shape`, and sets the image's configuration.
fn shape(out: &Path) {
    println!("cargo:rerun-if-env-changed=LEASTACTION_SHAPE");
    println!("cargo:rerun-if-env-changed=LEASTACTION_SHAPE_ORDER");
    println!("cargo:rustc-check-cfg=cfg(graph, order_2, order_4)");
    let Ok(file) = env::var("LEASTACTION_SHAPE") else { return };
    println!("cargo:rerun-if-changed={file}");
    let source = fs::read_to_string(&file).expect("LEASTACTION_SHAPE names a file that export --rust wrote");
    // A source that is included may not begin with module documentation.
    let lines: Vec<_> = source.lines().filter(|line| !line.starts_with("//!")).collect();
    fs::write(out.join("shape.rs"), lines.join("\n")).expect("the folder can be written to");
    if source.contains("GraphModel") {
        println!("cargo:rustc-cfg=graph");
    }
    let order = env::var("LEASTACTION_SHAPE_ORDER").unwrap_or("2".into());
    println!("cargo:rustc-cfg=order_{order}");
}
