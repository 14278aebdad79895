//! Two pendulums of one learned type.
#![no_std]
#![no_main]

use core::hint::black_box;
use leastaction_core::model::ModularModel;
use panic_free::{Flash, everything, halt, said};

static FLASH: Flash = Flash::new();

#[unsafe(no_mangle)]
extern "C" fn _start() -> ! {
    if let Ok(model) = ModularModel::<2, 1, 16, 2>::load(FLASH.bytes(), black_box("double")) {
        everything(&model.system);
        said::<_, 2>(&model);
    }
    halt()
}
