//! A cart-pole as rigid bodies whose cart sticks to its rail and runs against stops, stepped at order 4.
#![no_std]
#![no_main]

use leastaction_chip::{Aligned, image, models};
use leastaction_core::discrete::Galerkin;

static MODEL: &Aligned<{ include_bytes!("../../models/cartpole-sticking.postcard").len() }> =
    &Aligned(*include_bytes!("../../models/cartpole-sticking.postcard"));

fn run() -> Result<(), &'static [u8]> {
    models::sticking_bodies::<Galerkin>(&MODEL.0)
}

image!(run);
