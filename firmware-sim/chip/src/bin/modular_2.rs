//! Two pendulums of a learned type, stepped by the midpoint rule.
#![no_std]
#![no_main]

use leastaction_chip::{Aligned, image, models};
use leastaction_core::discrete::Midpoint;

static MODEL: &Aligned<{ include_bytes!("../../models/double.postcard").len() }> =
    &Aligned(*include_bytes!("../../models/double.postcard"));

fn run() -> Result<(), &'static [u8]> {
    models::double_pendulum::<Midpoint>(&MODEL.0)
}

image!(run);
