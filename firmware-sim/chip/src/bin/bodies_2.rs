//! Two links of learned mass, as rigid bodies, stepped by the midpoint rule.
#![no_std]
#![no_main]

use leastaction_chip::{Aligned, image, models};
use leastaction_core::discrete::Midpoint;

static MODEL: &Aligned<{ include_bytes!("../../models/acrobot.postcard").len() }> =
    &Aligned(*include_bytes!("../../models/acrobot.postcard"));

fn run() -> Result<(), &'static [u8]> {
    models::links::<Midpoint>(&MODEL.0)
}

image!(run);
