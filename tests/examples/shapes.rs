//! Writes the models of `firmware-sim/chip/shapes.toml` as Rust source into a folder: `firmware-sim/chip/shapes.sh`.

#[path = "../shapes/mod.rs"]
mod shapes;

use leastaction_models::file::rust_source;
use std::error::Error;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args_os().nth(1).ok_or("usage: shapes FOLDER")?);
    for shape in shapes::all()? {
        std::fs::write(folder.join(&shape.name).with_extension("rs"), rust_source(&shape.file)?)?;
        println!("{}", shape.name);
    }
    Ok(())
}
