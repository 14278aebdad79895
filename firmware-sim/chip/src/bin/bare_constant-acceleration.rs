//! The cart-pole's acceleration and nothing else, with a model of constants in the program: no reader of model files.
#![no_std]
#![no_main]

use core::hint::black_box;
use leastaction_chip::bare;
use leastaction_core::continuous::acceleration;

#[path = "../../models/cartpole_constants.rs"]
#[allow(dead_code, reason = "it also has a stepper")]
mod cartpole;

fn run() -> Option<()> {
    let model = cartpole::load().ok()?;
    let [q, v, u] = black_box(&[[0.1, 0.1], [0.2, 0.2], [0.0, 0.0]]);
    black_box(acceleration(&model.system, q, v, u)).ok().map(drop)
}

bare!(run);
