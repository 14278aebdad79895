//! Two links of learned mass, as rigid bodies, stepped at order 4.
#![no_std]
#![no_main]

use leastaction_chip::{Aligned, image, models};
use leastaction_core::discrete::Galerkin;

static MODEL: &Aligned<{ include_bytes!("../../models/acrobot.postcard").len() }> =
    &Aligned(*include_bytes!("../../models/acrobot.postcard"));

fn run() -> Result<(), &'static [u8]> {
    models::links::<Galerkin>(&MODEL.0)
}

image!(run);
