//! A learned cart-pole, stepped at the rate that it was trained for: one DEL step per tick of SysTick.
#![no_std]
#![no_main]

use core::sync::atomic::{AtomicU32, Ordering};
use cortex_m::asm::wfi;
use cortex_m::peripheral::{Peripherals, SYST, syst::SystClkSource};
use cortex_m_rt::{entry, exception};
use cortex_m_semihosting::{debug, hprintln};
use leastaction_core::model::ModelError;
use panic_halt as _;

#[path = "../../cartpole.rs"]
#[allow(dead_code, reason = "it also has sizes, and the step as a constant")]
mod model;

/// Clock frequency of the processor, Hz.
const CLOCK: f32 = 25e6;
/// Number of ticks after which the example ends.
const TICKS: u32 = 100;

/// Ticks of SysTick since the start.
static NOW: AtomicU32 = AtomicU32::new(0);

#[exception]
fn SysTick() {
    NOW.fetch_add(1, Ordering::Relaxed);
}

#[entry]
fn main() -> ! {
    match model::stepper() {
        Ok(stepper) => debug::exit(run(stepper)),
        // Replace this on a board by a light, a safe state.
        Err(error) => fail("the model was refused", &error),
    }
    loop {
        wfi();
    }
}

/// The control force of a tick: put yours here. This one pushes the cart alone to and fro, N.
fn control(tick: u32) -> [f32; 2] {
    [if tick / 10 % 2 == 0 { 0.25 } else { -0.25 }, 0.0]
}

fn run(mut stepper: model::Stepper) -> Result<(), ()> {
    let Some(mut peripherals) = Peripherals::take() else { return Err(()) };
    stepper.start([0.0, 0.1], [0.0, 0.0]).map_err(|_| ())?;
    let (mut late, mut refused) = (0, 0);
    start(&mut peripherals.SYST, stepper.h());
    for tick in 0..TICKS {
        late += u32::from(NOW.load(Ordering::Relaxed) > tick);
        wait_for(tick + 1);
        // An error leaves the state unchanged: hold it, count, and command no force.
        refused += u32::from(stepper.step(control(tick)).is_err());
        if (tick + 1) % 20 == 0 {
            let [x, angle] = stepper.q().map(thousandths);
            hprintln!("tick {}: x = {} mm, angle = {} mrad", tick + 1, x, angle);
        }
    }
    hprintln!("{} ticks, {} late, {} refused", TICKS, late, refused);
    if late + refused == 0 { Ok(()) } else { Err(()) }
}

/// Starts SysTick with a period of h seconds.
fn start(systick: &mut SYST, h: f32) {
    systick.set_clock_source(SystClkSource::Core);
    // 24 bits: 0.67 s at most at 25 MHz.
    systick.set_reload((h * CLOCK) as u32 - 1);
    systick.clear_current();
    systick.enable_counter();
    systick.enable_interrupt();
}

/// Sleeps until the given tick.
fn wait_for(tick: u32) {
    while NOW.load(Ordering::Relaxed) < tick {
        wfi();
    }
}

/// Thousandths as a whole number for printing: the code that prints decimals is larger than the model's.
fn thousandths(x: f32) -> i32 {
    (x * 1e3) as i32
}

#[cold]
fn fail(what: &str, error: &ModelError) {
    hprintln!("{}: {}", what, error);
    debug::exit(debug::EXIT_FAILURE);
}
