//! A cart-pole as rigid bodies, learned with its dry friction from its own logs, stepped by the midpoint rule.
#![no_std]
#![no_main]

use leastaction_chip::{Aligned, image, models};
use leastaction_core::discrete::Midpoint;

static MODEL: &Aligned<{ include_bytes!("../../models/cartpole-dry.postcard").len() }> =
    &Aligned(*include_bytes!("../../models/cartpole-dry.postcard"));

fn run() -> Result<(), &'static [u8]> {
    models::dry_bodies::<Midpoint>(&MODEL.0)
}

image!(run);
