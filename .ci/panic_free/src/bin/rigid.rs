//! A learned cart-pole, and one by formulas.
#![no_std]
#![no_main]

use leastaction_core::energy::trigonometric::CARTPOLE;
use leastaction_core::forces::System;
use leastaction_core::model::RigidModel;
use panic_free::{Flash, everything, halt, said};

static FLASH: Flash = Flash::new();

#[unsafe(no_mangle)]
extern "C" fn _start() -> ! {
    if let Ok(model) = RigidModel::<2, 32, 2>::load(FLASH.bytes()) {
        everything(&model.system);
        said::<_, 2>(&model);
    }
    everything(&System::conservative(CARTPOLE));
    halt()
}
