//! The cart-pole's step and nothing else: its share of a firmware's flash.
#![no_std]
#![no_main]

use core::hint::black_box;
use leastaction_chip::{Aligned, bare};
use leastaction_core::discrete::{Control, Del, Midpoint, State};
use leastaction_firmware_sim::trajectory::reference::{Cartpole, STEP, newton};

static MODEL: &Aligned<{ include_bytes!("../../models/cartpole.postcard").len() }> =
    &Aligned(*include_bytes!("../../models/cartpole.postcard"));

fn run() -> Option<()> {
    let model = Cartpole::load(black_box(&MODEL.0)).ok()?;
    let del = Del::<f32, Midpoint>::with_newton(STEP, newton());
    let [q, v, u] = *black_box(&[[0.1, 0.1], [0.2, 0.2], [0.0, 0.0]]);
    let mut state = State::new(&model.system.lagrangian, q, v).ok()?;
    black_box(del.step(&model.system, &mut state, &Control::held(u))).ok().map(drop)
}

bare!(run);
