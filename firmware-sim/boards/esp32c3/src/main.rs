//! A learned machine on an ESP32-C3: a tick of the system timer, two magnetic encoders, a drive by PWM and direction, a watchdog.
//!
//! The chip has one bus for encoders: an AS5600 on it, and an AS5600L, whose address is another. It has no floating-point unit, with the same bits.
#![no_std]
#![no_main]

use core::panic::PanicInfo;
use esp_hal::Blocking;
use esp_hal::gpio::{Level, Output, OutputConfig};
use esp_hal::i2c::master::{Config as Bus, I2c};
use esp_hal::ledc::channel::{self, ChannelIFace};
use esp_hal::ledc::timer::{self, TimerIFace};
use esp_hal::ledc::{LSGlobalClkSource, Ledc, LowSpeed};
use esp_hal::time::{Duration, Instant, Rate};
use esp_hal::timer::PeriodicTimer;
use esp_hal::timer::timg::{MwdtStage, TimerGroup};
use leastaction_machine::{Counter, control, model, ticks};

esp_bootloader_esp_idf::esp_app_desc!();

/// The watchdog resets the chip, which stops the drive, after this many periods without a tick.
const PATIENCE: u64 = 5;
/// Steps of the PWM's duty, %.
const MOST: f32 = 100.0;

#[esp_hal::main]
fn main() -> ! {
    let chip = esp_hal::init(esp_hal::Config::default());
    // CHANGE 5: the pins of encoders and drive.
    let bus = Bus::default().with_frequency(Rate::from_khz(400));
    let Ok(bus) = I2c::new(chip.I2C0, bus) else { stop() };
    let mut bus = bus.with_sda(chip.GPIO4).with_scl(chip.GPIO5);
    let [mut cart, mut pole] = [Encoder::new(0x40), Encoder::new(0x36)];
    let mut direction = Output::new(chip.GPIO7, Level::Low, OutputConfig::default());
    let mut light = Output::new(chip.GPIO8, Level::Low, OutputConfig::default());
    let mut waves = Ledc::new(chip.LEDC);
    waves.set_global_slow_clock(LSGlobalClkSource::APBClk);
    let mut clock = waves.timer::<LowSpeed>(timer::Number::Timer0);
    let duty = timer::config::Duty::Duty11Bit;
    let frequency = Rate::from_khz(20);
    let clocked = clock.configure(timer::config::Config {
        duty,
        clock_source: timer::LSClockSource::APBClk,
        frequency,
    });
    let mut drive = waves.channel(channel::Number::Channel0, chip.GPIO6);
    let drive_mode = esp_hal::gpio::DriveMode::PushPull;
    let driven = drive.configure(channel::config::Config { timer: &clock, duty_pct: 0, drive_mode });

    // A model or a program that is refused never moves the machine: the light stays off.
    let (Ok(()), Ok(()), Ok(model)) = (clocked, driven, model()) else { rest() };
    let Ok(mut control) = control(&model) else { rest() };

    let period = Duration::from_micros(control.period().into());
    let group = TimerGroup::new(chip.TIMG0);
    let mut watchdog = group.wdt;
    watchdog.set_timeout(MwdtStage::Stage0, Duration::from_micros(PATIENCE * period.as_micros()));
    let (mut alarm, mut last) = (PeriodicTimer::new(group.timer0), Instant::now());
    if alarm.start(period).is_err() {
        rest();
    }
    watchdog.enable();
    loop {
        alarm.wait();
        let now = Instant::now();
        let elapsed = ticks((now - last).as_micros(), control.period());
        last = now;
        let counts = [cart.read(&mut bus), pole.read(&mut bus)];
        let duty = control.tick(elapsed, &counts);
        direction.set_level(if duty < 0.0 { Level::High } else { Level::Low });
        // The duty is at most 100%, so nothing is refused.
        let _ = drive.set_duty((MOST * duty.abs()) as u8);
        light.set_level(if control.is_well() { Level::High } else { Level::Low });
        watchdog.feed();
    }
}

/// A magnetic encoder of 4096 counts a turn, and the turns that it made.
struct Encoder {
    address: u8,
    counter: Counter,
}

impl Encoder {
    /// Register of the angle, 12 bits.
    const ANGLE: u8 = 0x0e;

    const fn new(address: u8) -> Self {
        Self { address, counter: Counter::new(4096) }
    }

    /// All counts; `None` if the encoder does not answer. It turned by less than half a turn since the last reading.
    fn read(&mut self, bus: &mut I2c<'_, Blocking>) -> Option<i32> {
        let mut angle = [0; 2];
        bus.write_read(self.address, &[Self::ANGLE], &mut angle).ok()?;
        Some(self.counter.read(u16::from_be_bytes(angle) & 0xfff))
    }
}

/// Waits forever, with the drive at rest.
fn rest() -> ! {
    loop {
        core::hint::spin_loop();
    }
}

/// Resets the chip, whose pins are then inputs: the drive stops. Exceptions of the processor end here, too, by a panic.
fn stop() -> ! {
    esp_hal::system::software_reset()
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    stop()
}
