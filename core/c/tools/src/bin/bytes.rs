//! Turns a file of hexadecimal bytes, with comments from `#` to the end of a line, into the bytes: the golden model files of
//! core's tests are written like that.
//!
//! `cargo run --bin bytes < cartpole.hex > cartpole.bin`

use std::error::Error;
use std::io::{Read, Write};

fn main() -> Result<(), Box<dyn Error>> {
    let mut text = String::new();
    std::io::stdin().read_to_string(&mut text)?;
    let lines = text.lines().map(|line| line.split('#').next().unwrap_or(""));
    let bytes: Result<Vec<u8>, _> =
        lines.flat_map(str::split_whitespace).map(|byte| u8::from_str_radix(byte, 16)).collect();
    Ok(std::io::stdout().write_all(&bytes?)?)
}
