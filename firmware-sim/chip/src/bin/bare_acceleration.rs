//! The cart-pole's acceleration and nothing else: its share of a firmware's flash.
#![no_std]
#![no_main]

use core::hint::black_box;
use leastaction_chip::{Aligned, bare};
use leastaction_core::continuous::acceleration;
use leastaction_firmware_sim::trajectory::reference::Cartpole;

static MODEL: &Aligned<{ include_bytes!("../../models/cartpole.postcard").len() }> =
    &Aligned(*include_bytes!("../../models/cartpole.postcard"));

fn run() -> Option<()> {
    let model = Cartpole::load(black_box(&MODEL.0)).ok()?;
    let [q, v, u] = black_box(&[[0.1, 0.1], [0.2, 0.2], [0.0, 0.0]]);
    black_box(acceleration(&model.system, q, v, u)).ok().map(drop)
}

bare!(run);
