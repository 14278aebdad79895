//! A learned machine on a Nucleo board: a tick of a hardware timer, two incremental encoders, a drive by PWM and direction, a watchdog.
#![no_std]
#![no_main]

mod clock;

use core::panic::PanicInfo;
use cortex_m_rt::{ExceptionFrame, exception};
use embassy_executor::Spawner;
use embassy_stm32::gpio::{Level, Output, OutputType, Speed};
use embassy_stm32::time::khz;
use embassy_stm32::timer::qei::Qei;
use embassy_stm32::timer::simple_pwm::{PwmPin, SimplePwm};
use embassy_stm32::wdg::IndependentWatchdog;
use embassy_time::{Duration, Instant, Ticker};
use leastaction_machine::{Counter, control, model, ticks};

/// The watchdog resets the chip, which stops the drive, after this many periods without a tick.
const PATIENCE: u32 = 5;

#[embassy_executor::main]
async fn main(_spawner: Spawner) {
    let chip = embassy_stm32::init(clock::config());
    // CHANGE 5: the pins of encoders and drive.
    let cart = Qei::new(chip.TIM3, chip.PA6, chip.PA7, Default::default());
    let pole = Qei::new(chip.TIM4, chip.PB6, chip.PB7, Default::default());
    let pin = PwmPin::new(chip.PA8, OutputType::PushPull);
    let mut pwm = SimplePwm::new(chip.TIM1, Some(pin), None, None, None, khz(20), Default::default());
    let mut direction = Output::new(chip.PB5, Level::Low, Speed::Low);
    let mut light = Output::new(chip.PA5, Level::Low, Speed::Low);
    let mut drive = pwm.ch1();
    drive.enable();

    // A model or a program that is refused never moves the machine: the light stays off.
    let Ok(model) = model() else { return };
    let Ok(mut control) = control(&model) else { return };

    let period = Duration::from_micros(control.period().into());
    let mut watchdog = IndependentWatchdog::new(chip.IWDG, PATIENCE * control.period());
    let (mut ticker, mut last) = (Ticker::every(period), Instant::now());
    let mut counters = [Counter::new(1 << 16); 2];
    watchdog.unleash();
    loop {
        ticker.next().await;
        let now = Instant::now();
        let elapsed = ticks((now - last).as_micros(), control.period());
        last = now;
        let [x, angle] = &mut counters;
        let duty = control.tick(elapsed, &[Some(x.read(cart.count())), Some(angle.read(pole.count()))]);
        direction.set_level(if duty < 0.0 { Level::High } else { Level::Low });
        drive.set_duty_cycle((duty.abs() * drive.max_duty_cycle() as f32) as u32);
        light.set_level(if control.is_well() { Level::High } else { Level::Low });
        watchdog.pet();
    }
}

/// Resets the chip, whose pins are then inputs: the drive stops.
fn stop() -> ! {
    cortex_m::peripheral::SCB::sys_reset()
}

#[exception]
unsafe fn HardFault(_: &ExceptionFrame) -> ! {
    stop()
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    stop()
}
