//! Prints the loader's results for damaged model files on this machine, in the form of `firmware-sim/chip/src/bin/refusals.rs`: for every
//! damage to the two small models, or for the cart-poles in the files named.

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
