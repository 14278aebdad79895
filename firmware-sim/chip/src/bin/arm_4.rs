//! An arm of seven joints in space, stepped at order 4.
#![no_std]
#![no_main]

use leastaction_chip::{Aligned, image, models};
use leastaction_core::discrete::Galerkin;

static MODEL: &Aligned<{ include_bytes!("../../models/arm.postcard").len() }> =
    &Aligned(*include_bytes!("../../models/arm.postcard"));

fn run() -> Result<(), &'static [u8]> {
    models::arm::<Galerkin>(&MODEL.0)
}

image!(run);
