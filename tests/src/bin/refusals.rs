//! What the loader makes of damaged model files on this machine, as `firmware-sim/chip/src/bin/refusals.rs` prints it: of
//! every damage to the two small ones, or of the cart-poles in the files named.

use leastaction_tests::{refusals, refused_cartpole};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let files: Vec<_> = std::env::args_os().skip(1).collect();
    for file in &files {
        println!(
            "flash {}",
            refused_cartpole(&std::fs::read(file)?).map_or("accepted", |reason| reason.name)
        );
    }
    if files.is_empty() {
        print!("{}", refusals());
    }
    Ok(())
}
