//! A learned machine on a Raspberry Pi Pico 2: a tick of the hardware timer, two magnetic encoders (AS5600) on a bus each, a drive by PWM and
//! direction, a watchdog.
#![no_std]
#![no_main]

use core::panic::PanicInfo;
use cortex_m_rt::{ExceptionFrame, exception};
use embassy_executor::Spawner;
use embassy_futures::join::join;
use embassy_rp::gpio::{Level, Output};
use embassy_rp::i2c::{Async, Config as Bus, I2c, Instance};
use embassy_rp::pwm::{Config as Wave, Pwm, SetDutyCycle};
use embassy_rp::watchdog::Watchdog;
use embassy_rp::{bind_interrupts, i2c, peripherals};
use embassy_time::{Duration, Instant, Ticker, with_timeout};
use leastaction_machine::{Counter, control, model, ticks};

bind_interrupts!(struct Interrupts {
    I2C0_IRQ => i2c::InterruptHandler<peripherals::I2C0>;
    I2C1_IRQ => i2c::InterruptHandler<peripherals::I2C1>;
});

/// The watchdog resets the chip, which stops the drive, after this many periods without a tick.
const PATIENCE: u32 = 5;
/// Top of the PWM's counter: 20 kHz at 150 MHz.
const TOP: u16 = 7499;

#[embassy_executor::main]
async fn main(_spawner: Spawner) {
    let chip = embassy_rp::init(Default::default());
    // CHANGE 5: the pins of encoders and drive.
    let mut bus = Bus::default();
    bus.frequency = 400_000;
    let mut cart = Encoder::new(I2c::new_async(chip.I2C0, chip.PIN_5, chip.PIN_4, Interrupts, bus));
    let mut pole = Encoder::new(I2c::new_async(chip.I2C1, chip.PIN_7, chip.PIN_6, Interrupts, bus));
    let mut wave = Wave::default();
    wave.top = TOP;
    let mut drive = Pwm::new_output_a(chip.PWM_SLICE1, chip.PIN_18, wave);
    let mut direction = Output::new(chip.PIN_19, Level::Low);
    let mut light = Output::new(chip.PIN_25, Level::Low);

    // A model or a program that is refused never moves the machine: the light stays off.
    let Ok(model) = model() else { return };
    let Ok(mut control) = control(&model) else { return };

    let period = Duration::from_micros(control.period().into());
    let mut watchdog = Watchdog::new(chip.WATCHDOG);
    let (mut ticker, mut last) = (Ticker::every(period), Instant::now());
    watchdog.start(period * PATIENCE);
    loop {
        ticker.next().await;
        let now = Instant::now();
        let elapsed = ticks((now - last).as_micros(), control.period());
        last = now;
        let (x, angle) = join(cart.read(period / 4), pole.read(period / 4)).await;
        let duty = control.tick(elapsed, &[x, angle]);
        direction.set_level(if duty < 0.0 { Level::High } else { Level::Low });
        // The duty is at most that of the PWM, so nothing is refused.
        let _ = drive.set_duty_cycle((duty.abs() * f32::from(TOP)) as u16);
        light.set_level(if control.is_well() { Level::High } else { Level::Low });
        watchdog.feed(period * PATIENCE);
    }
}

/// A magnetic encoder AS5600 of 4096 counts a turn, and the turns that it made.
struct Encoder<T: Instance + 'static> {
    bus: I2c<'static, T, Async>,
    counter: Counter,
}

impl<T: Instance> Encoder<T> {
    /// Address on the bus.
    const ADDRESS: u16 = 0x36;
    /// Register of the angle, 12 bits.
    const ANGLE: u8 = 0x0e;

    fn new(bus: I2c<'static, T, Async>) -> Self {
        Self { bus, counter: Counter::new(4096) }
    }

    /// All counts; `None` if the encoder does not answer in time. It turned by less than half a turn since the last reading.
    async fn read(&mut self, patience: Duration) -> Option<i32> {
        let mut angle = [0; 2];
        let read = self.bus.write_read_async(Self::ADDRESS, [Self::ANGLE], &mut angle);
        with_timeout(patience, read).await.ok()?.ok()?;
        Some(self.counter.read(u16::from_be_bytes(angle) & 0xfff))
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
