//! A double pendulum and a branching tree of rigid bodies.
#![no_std]
#![no_main]

use core::hint::black_box;
use leastaction_core::discrete::Galerkin;
use leastaction_core::model::BodiesModel;
use panic_free::{AllForces, Axes, Flash, Friction, everything, halt, regulated, said, steppers};

static FLASH: Flash = Flash::new();

#[unsafe(no_mangle)]
extern "C" fn _start() -> ! {
    if let Ok(model) = BodiesModel::<2>::load(FLASH.bytes()) {
        everything(&model.system);
        said::<_, 2>(&model);
        steppers(&model);
    }
    if let Ok(model) = BodiesModel::<5, f32, Friction<5>>::load(FLASH.bytes()) {
        everything(&model.system);
    }
    if let Ok(model) = BodiesModel::<2, f32, Axes<2>>::load(FLASH.bytes()) {
        everything(&model.system);
        said::<_, 2>(&model);
        steppers(&model);
    }
    if let Ok(model) = BodiesModel::<3, f32, AllForces<3>>::load(FLASH.bytes()) {
        everything(&model.system);
        black_box(regulated::<_, _, Galerkin, 3, 6>(&model.system));
    }
    halt()
}
