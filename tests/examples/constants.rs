//! Prints a model file as constants of a Rust program: `constants FILE`.

use leastaction_models::file::rust_constants;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("usage: constants FILE")?;
    print!("{}", rust_constants(&std::fs::read(path)?)?);
    Ok(())
}
