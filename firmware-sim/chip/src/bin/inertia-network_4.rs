//! A learned cart-pole, stepped at order 4.
#![no_std]
#![no_main]

use leastaction_chip::{Aligned, image, models};
use leastaction_core::discrete::Galerkin;

static MODEL: &Aligned<{ include_bytes!("../../models/cartpole.postcard").len() }> =
    &Aligned(*include_bytes!("../../models/cartpole.postcard"));

fn run() -> Result<(), &'static [u8]> {
    models::cartpole::<Galerkin>(&MODEL.0)
}

image!(run);
