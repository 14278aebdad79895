//! Writes the arm of `firmware-sim/chip/models`: `arm_model FILE`.

use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("usage: arm_model FILE")?;
    Ok(std::fs::write(path, leastaction_tests::arm::model_file()?)?)
}
