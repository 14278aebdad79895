//! Three bobs on rods, with energies learned on two bobs, stepped by RATTLE.
#![no_std]
#![no_main]

use leastaction_chip::{Aligned, image, models};
use leastaction_core::discrete::Order;

static MODEL: &Aligned<{ include_bytes!("../../models/pendulums.postcard").len() }> =
    &Aligned(*include_bytes!("../../models/pendulums.postcard"));

fn run() -> Result<(), &'static [u8]> {
    models::bobs(&MODEL.0, Order::Two)
}

image!(run);
