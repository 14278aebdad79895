//! Damaged model files: the loader's answers to every changed bit and every truncation of two small files in RAM, or
//! of a cart-pole that the emulator has put into flash.
#![no_std]
#![no_main]

use leastaction_chip::{Aligned, board, image, print};
use leastaction_core::model::{ModelError, entry_of};
use leastaction_firmware_sim::damage::Damage;
use leastaction_firmware_sim::trajectory::reference::{Bobs, Cartpole, Double, GRAPH, TREE, chain};

static DOUBLE: &Aligned<{ include_bytes!("../../models/double.postcard").len() }> =
    &Aligned(*include_bytes!("../../models/double.postcard"));
static PENDULUMS: &Aligned<{ include_bytes!("../../models/pendulums.postcard").len() }> =
    &Aligned(*include_bytes!("../../models/pendulums.postcard"));

/// Prints the counts for every kind of damage to a copy of a file in RAM; a damaged file may be accepted only if its
/// checksum was corrected.
fn damaged<const N: usize>(
    name: &[u8],
    mut copy: Aligned<N>,
    mut load: impl FnMut(&[u8]) -> Result<(), ModelError>,
) -> Result<(), &'static [u8]> {
    load(&copy.0).map_err(|_| b"the whole file is refused".as_slice())?;
    for damage in Damage::ALL {
        let refusals = damage.refusals(&mut copy.0, &mut load);
        print::line(name, damage.name().as_bytes());
        refusals.occurred().for_each(|(reason, count)| print::number(reason.name.as_bytes(), count));
        print::number(b"accepted", refusals.accepted);
        if refusals.accepted > 0 && damage != Damage::BitUnderChecksum {
            return Err(b"a damaged file is accepted");
        }
    }
    load(&copy.0).map_err(|_| b"the file is not what it was".as_slice())
}

fn run() -> Result<(), &'static [u8]> {
    if let Some(file) = board::flash().model() {
        let name = |error: ModelError| entry_of(error.coded().code).map_or("refused", |reason| reason.name);
        let outcome = Cartpole::load(file).map_or_else(name, |_| "accepted");
        print::line(b"flash", outcome.as_bytes());
        return Ok(());
    }
    damaged(b"double", Aligned(DOUBLE.0), |file| Double::load(file, TREE).map(drop))?;
    damaged(b"pendulums", Aligned(PENDULUMS.0), |file| {
        Bobs::load(file, GRAPH, &mut [], &mut chain()).map(drop)
    })
}

image!(run);
