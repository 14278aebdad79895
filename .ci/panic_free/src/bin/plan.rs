//! A plan of four coordinates of which two are driven, for a model that it names by the fingerprint of its file.
#![no_std]
#![no_main]

use leastaction_core::model::fingerprint;
use leastaction_core::plan::Plan;
use panic_free::{Flash, followed, halt};

static MODEL: Flash = Flash::new();
static PLAN: Flash = Flash::new();

#[unsafe(no_mangle)]
extern "C" fn _start() -> ! {
    if let Ok(model) = fingerprint(MODEL.bytes())
        && let Ok(plan) = Plan::<4, 2>::load(PLAN.bytes(), model)
    {
        followed(&plan);
    }
    halt()
}
