//! Build script that names the linker's script; embassy-stm32 has the chip's memory.

fn main() {
    println!("cargo:rustc-link-arg-bins=--nmagic");
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
}
