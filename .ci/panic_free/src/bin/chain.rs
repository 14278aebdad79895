//! Six coordinates of three element types, with friction: loops that the compiler does not unroll.
#![no_std]
#![no_main]

use core::hint::black_box;
use leastaction_core::model::ModularModel;
use panic_free::{Flash, Friction, everything, halt, said, steppers};

static FLASH: Flash = Flash::new();

#[unsafe(no_mangle)]
extern "C" fn _start() -> ! {
    if let Ok(model) = ModularModel::<6, 3, 16, 3, f32, Friction<6>>::load(FLASH.bytes(), black_box("chain"))
    {
        everything(&model.system);
        said::<_, 6>(&model);
        steppers(&model);
    }
    halt()
}
