//! Decisions over a receding horizon for the cart-pole of a small network, whose cart is driven: back to the middle with the pole at 0.
#![no_std]
#![no_main]

use core::hint::black_box;
use leastaction_chip::receding::{Swing, measure};
use leastaction_chip::{Aligned, image, models};
use leastaction_firmware_sim::trajectory::reference::SmallCartpole;

static MODEL: &Aligned<{ include_bytes!("../../models/cartpole-16.postcard").len() }> =
    &Aligned(*include_bytes!("../../models/cartpole-16.postcard"));

fn run() -> Result<(), &'static [u8]> {
    let model = models::load(|| SmallCartpole::load(black_box(&MODEL.0)))?;
    let (goal, turns) = ([0.0; 4], [false, true, false, false]);
    measure(&model.system, &Swing { input: 0, most: 6.0, first: 0.5, goal, turns })
}

image!(run);
