//! The cart-pole's step and nothing else, with a model of constants in the program: no reader of model files.
#![no_std]
#![no_main]

use core::hint::black_box;
use leastaction_chip::bare;
use leastaction_core::discrete::{Control, Del, Midpoint, State};
use leastaction_firmware_sim::trajectory::reference::{STEP, newton};

#[path = "../../models/cartpole_constants.rs"]
#[allow(dead_code, reason = "it also has a stepper of the order that the model was trained with")]
mod cartpole;

fn run() -> Option<()> {
    let system = cartpole::load().ok()?.system;
    let del = Del::<f32, Midpoint>::with_newton(STEP, newton());
    let [q, v, u] = *black_box(&[[0.1, 0.1], [0.2, 0.2], [0.0, 0.0]]);
    let mut state = State::new(&system.lagrangian, q, v).ok()?;
    black_box(del.step(&system, &mut state, &Control::held(u))).ok().map(drop)
}

bare!(run);
