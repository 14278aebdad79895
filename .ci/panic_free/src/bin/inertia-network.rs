//! A learned cart-pole, without and with dry friction, and one by formulas.
#![no_std]
#![no_main]

use core::hint::black_box;
use leastaction_core::discrete::Midpoint;
use leastaction_core::energy::trigonometric::CARTPOLE;
use leastaction_core::forces::{Forces, System, Viscous};
use leastaction_core::model::InertiaNetworkModel;
use panic_free::{Flash, Friction, everything, guards, halt, regulated, said, steppers};

static FLASH: Flash = Flash::new();

#[unsafe(no_mangle)]
extern "C" fn _start() -> ! {
    if let Ok(model) = InertiaNetworkModel::<2, 32, 2>::load(FLASH.bytes()) {
        everything(&model.system);
        said::<_, 2>(&model);
        steppers(&model);
    }
    if let Ok(model) = InertiaNetworkModel::<2, 32, 2, f32, Friction<2>>::load(FLASH.bytes()) {
        everything(&model.system);
        black_box(regulated::<_, _, Midpoint, 2, 4>(&model.system));
        let (mass, tau) = black_box(([[1.0; 2]; 2], [0.1; 2]));
        let _ = black_box(model.system.forces.1.stiffness(0.01, mass, &tau));
        let _ = black_box(model.system.forces.load_derivative(&tau, &tau, &tau));
    }
    guards(FLASH.bytes());
    everything::<_, Viscous<f32, 2>, 2>(&System::conservative(CARTPOLE));
    halt()
}
