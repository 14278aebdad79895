//! Writes the cart between stops of `firmware-sim/chip/models`: `sticking_model FILE`.

use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("usage: sticking_model FILE")?;
    Ok(std::fs::write(path, leastaction_tests::sticking::model_file()?)?)
}
