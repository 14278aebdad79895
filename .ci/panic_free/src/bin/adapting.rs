//! An arm of three joints and a chain of two bodies in a plane whose numbers follow the machine, and are saved.
#![no_std]
#![no_main]

use core::hint::black_box;
use leastaction_core::adapt::Number;
use leastaction_core::energy::arm::{ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS};
use leastaction_core::energy::bodies::{BODY_PARAMETERS, GRAVITY_PARAMETERS};
use leastaction_core::model::{ArmHeader, BodiesHeader, Tuned, parse_as};
use panic_free::adapted::follow;
use panic_free::{Flash, Friction, halt};

static ARM: Flash = Flash::new();
static CHAIN: Flash = Flash::new();
static SAVED: Flash = Flash::new();

type Arm<'f> = Tuned<'f, Friction<3>, ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS, 3, 96>;
type Chain<'f> = Tuned<'f, Friction<2>, GRAVITY_PARAMETERS, BODY_PARAMETERS, 2, 30>;

#[unsafe(no_mangle)]
extern "C" fn _start() -> ! {
    if let Ok(parsed) = parse_as::<ArmHeader, f32>(ARM.bytes())
        && let Ok(tree) = parsed.shape.tree()
        && let Ok(mut model) = Arm::new(&parsed, tree)
    {
        black_box(model.value(black_box(Number::Rotor(1))));
        let _ = follow::<_, 3, 16, 120>(&mut model, [&ARM, &SAVED]);
    }
    if let Ok(parsed) = parse_as::<BodiesHeader, f32>(CHAIN.bytes())
        && let Ok(tree) = parsed.shape.tree()
        && let Ok(mut model) = Chain::new(&parsed, tree)
    {
        let _ = follow::<_, 2, 8, 28>(&mut model, [&CHAIN, &SAVED]);
    }
    halt()
}
