//! Prints the fingerprints of the elementary functions, and of the reference models' f32 trajectories, one line per family and order:
//! `.ci/trajectory_hash` compares them between optimisation levels, and `firmware-sim/chip/run.sh` with those of the chips.

use leastaction_firmware_sim::trajectory::Fingerprint;
use leastaction_tests::Reference;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let steps: Option<u32> = std::env::args().nth(1).map(|steps| steps.parse()).transpose()?;
    println!("elementary 0 {:016x}", Fingerprint::of_elementary_functions().value());
    for reference in Reference::all() {
        println!(
            "{} {} {:016x}",
            reference.family,
            reference.order,
            reference.hash(steps.unwrap_or(reference.steps()))?
        );
    }
    Ok(())
}
