//! A learned cart-pole with weights in half precision, stepped by the midpoint rule.
#![no_std]
#![no_main]

use leastaction_chip::{Aligned, image, models};
use leastaction_core::discrete::Midpoint;

static MODEL: &Aligned<{ include_bytes!("../../models/cartpole-f16.postcard").len() }> =
    &Aligned(*include_bytes!("../../models/cartpole-f16.postcard"));

fn run() -> Result<(), &'static [u8]> {
    models::half_cartpole::<Midpoint>(&MODEL.0)
}

image!(run);
