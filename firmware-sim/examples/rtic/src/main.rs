//! A learned cart-pole, stepped by a task at the rate that it was trained for; a task of lower priority prints.
#![no_std]
#![no_main]

use cortex_m_semihosting::debug;
use panic_halt as _;

#[path = "../../cartpole.rs"]
#[allow(dead_code, reason = "it also has sizes, and the step as a constant")]
mod model;

/// Clock frequency of the processor after a reset, Hz.
const CLOCK: u32 = 16_000_000;

/// The mechanism and its state.
pub struct Mechanism {
    stepper: model::Stepper,
    /// Number of refused steps.
    refused: u32,
}

impl Mechanism {
    /// Loads the mechanism; `None` if the model is refused.
    fn load() -> Option<Self> {
        let mut stepper = model::stepper().ok()?;
        stepper.start([0.0, 0.1], [0.0, 0.0]).ok()?;
        Some(Self { stepper, refused: 0 })
    }

    /// Takes a step. An error leaves the state unchanged: hold it, count, and command no force.
    fn step(&mut self, u: [f32; 2]) {
        self.refused += u32::from(self.stepper.step(u).is_err());
    }
}

/// The control force of a tick: put yours here. This one pushes the cart alone to and fro, N.
fn control(tick: u32) -> [f32; 2] {
    [if tick / 10 % 2 == 0 { 0.25 } else { -0.25 }, 0.0]
}

/// Ends the example. Replace this on a board by a light, a safe state.
fn stop(status: Result<(), ()>) -> ! {
    debug::exit(status);
    loop {
        cortex_m::asm::wfi();
    }
}

#[rtic::app(device = stm32f4::stm32f405, dispatchers = [EXTI0, EXTI1])]
mod app {
    use super::{CLOCK, Mechanism, control, stop};
    use cortex_m_semihosting::hprintln;
    use rtic_monotonics::systick::prelude::*;

    systick_monotonic!(Mono, 1_000);

    /// Data for the printing task.
    #[shared]
    struct Shared {
        q: [f32; 2],
        /// Numbers of steps that were refused and of steps that began late.
        faults: [u32; 2],
    }

    #[local]
    struct Local {
        mechanism: Mechanism,
    }

    #[init]
    fn init(cx: init::Context) -> (Shared, Local) {
        let Some(mechanism) = Mechanism::load() else { stop(Err(())) };
        Mono::start(cx.core.SYST, CLOCK);
        let spawned = (tick::spawn(), print::spawn());
        if spawned != (Ok(()), Ok(())) {
            stop(Err(()));
        }
        (Shared { q: [0.0; 2], faults: [0; 2] }, Local { mechanism })
    }

    #[task(priority = 2, local = [mechanism], shared = [q, faults])]
    async fn tick(mut cx: tick::Context) {
        let mechanism = cx.local.mechanism;
        let period = ((mechanism.stepper.h() * 1e3) as u32).millis();
        let (mut next, mut late) = (Mono::now() + period, 0);
        for k in 0.. {
            Mono::delay_until(next).await;
            late += u32::from(Mono::now() > next + 1.millis());
            next += period;
            mechanism.step(control(k));
            cx.shared.q.lock(|q| *q = mechanism.stepper.q());
            cx.shared.faults.lock(|faults| *faults = [mechanism.refused, late]);
        }
    }

    #[task(priority = 1, shared = [q, faults])]
    async fn print(mut cx: print::Context) {
        let start = Mono::now();
        for second in 1..=5 {
            // The step of that time comes first: its task has a higher priority.
            Mono::delay_until(start + (second * 1000).millis()).await;
            let [x, angle] = cx.shared.q.lock(|q| q.map(|x| (x * 1e3) as i32));
            hprintln!("{} s: x = {} mm, angle = {} mrad", second, x, angle);
        }
        let faults @ [refused, late] = cx.shared.faults.lock(|faults| *faults);
        hprintln!("{} refused, {} late", refused, late);
        stop(if faults == [0, 0] { Ok(()) } else { Err(()) })
    }
}
