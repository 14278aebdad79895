//! The cart-pole's step of `bare_step`, taken by a stepper: the flash that its convenience costs.
#![no_std]
#![no_main]

use core::hint::black_box;
use leastaction_chip::{Aligned, bare};
use leastaction_core::discrete::Midpoint;
use leastaction_core::stepper::{Direct, Drive, Held, Stepper};
use leastaction_firmware_sim::trajectory::reference::{Cartpole, STEP, newton};

static MODEL: &Aligned<{ include_bytes!("../../models/cartpole.postcard").len() }> =
    &Aligned(*include_bytes!("../../models/cartpole.postcard"));

fn run() -> Option<()> {
    let model = Cartpole::load(black_box(&MODEL.0)).ok()?;
    let stepper = Stepper::<_, Midpoint, Drive<Held, Direct, 2, 0>, 2>::with_step(model, STEP);
    let mut stepper = stepper.ok()?.with_newton(newton());
    let [q, v, u] = *black_box(&[[0.1, 0.1], [0.2, 0.2], [0.0, 0.0]]);
    stepper.start(q, v).ok()?;
    black_box(stepper.step(u)).ok().map(drop)
}

bare!(run);
