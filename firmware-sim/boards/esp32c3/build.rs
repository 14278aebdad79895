//! Build script that names the linker's script, which esp-hal has.

fn main() {
    println!("cargo:rustc-link-arg-bins=-Tlinkall.x");
}
