//! Decisions over a receding horizon for two links of which the second joint is driven, upright from hanging.
#![no_std]
#![no_main]

use core::f32::consts::PI;
use core::hint::black_box;
use leastaction_chip::receding::{Swing, measure};
use leastaction_chip::{Aligned, image, models};
use leastaction_firmware_sim::trajectory::reference::Links;

static MODEL: &Aligned<{ include_bytes!("../../models/acrobot.postcard").len() }> =
    &Aligned(*include_bytes!("../../models/acrobot.postcard"));

fn run() -> Result<(), &'static [u8]> {
    let model = models::load(|| Links::load(black_box(&MODEL.0)))?;
    let (goal, turns) = ([PI, 0.0, 0.0, 0.0], [true, true, false, false]);
    measure(&model.system, &Swing { input: 1, most: 6.0, first: 0.5, goal, turns })
}

image!(run);
