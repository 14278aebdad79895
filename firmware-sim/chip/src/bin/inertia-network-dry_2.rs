//! A learned cart-pole with damping and dry friction, stepped by the midpoint rule.
#![no_std]
#![no_main]

use leastaction_chip::{Aligned, image, models};
use leastaction_core::discrete::Midpoint;

static MODEL: &Aligned<{ include_bytes!("../../models/cartpole.postcard").len() }> =
    &Aligned(*include_bytes!("../../models/cartpole.postcard"));

fn run() -> Result<(), &'static [u8]> {
    models::dry_cartpole::<Midpoint>(&MODEL.0)
}

image!(run);
