//! Two pendulums of a learned type, stepped at order 4.
#![no_std]
#![no_main]

use leastaction_chip::{Aligned, image, models};
use leastaction_core::discrete::Galerkin;

static MODEL: &Aligned<{ include_bytes!("../../models/double.postcard").len() }> =
    &Aligned(*include_bytes!("../../models/double.postcard"));

fn run() -> Result<(), &'static [u8]> {
    models::double_pendulum::<Galerkin>(&MODEL.0)
}

image!(run);
